#include "contact/penalty_contact.hpp"

#include <algorithm>
#include <numeric>

namespace undertow::contact {

PenaltyContact::PenaltyContact(Surface surface, const LawSettings& law, DetectionRules rules,
                               int threads)
    : surface_(std::move(surface)), detector_(rules, threads), law_(law) {}

Points PenaltyContact::active_points() const {
    return {x_, v_, mass_, radius_, stiffness_, id_};
}

/// Where the active points of the previous search are found among the points of
/// this one.
void PenaltyContact::map_rows(const Points& points) {
    by_id_.resize(points.size());
    std::iota(by_id_.begin(), by_id_.end(), 0u);
    std::sort(by_id_.begin(), by_id_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return points.id[a] < points.id[b]; });
    row_now_.resize(id_.size());
    for (std::size_t i = 0; i < id_.size(); ++i) {
        const auto found = std::lower_bound(
            by_id_.begin(), by_id_.end(), id_[i],
            [&](std::uint32_t row, std::uint64_t id) { return points.id[row] < id; });
        row_now_[i] =
            found != by_id_.end() && points.id[*found] == id_[i] ? std::int64_t(*found) : -1;
    }
}

void PenaltyContact::rebuild(const Points& points, double skin, std::span<const double> x,
                             std::span<const double> v) {
    map_rows(points);
    v_searched_.assign(points.v.begin(), points.v.end());
    rebuilt_ = true;

    surface_.move(x, v);
    cells_.search(points, surface_, skin, candidates_);

    // Former active row of each new one, through the rows of the search's points.
    std::vector<std::int64_t> old_row_of_point(points.size(), -1);
    for (std::size_t i = 0; i < row_now_.size(); ++i)
        if (row_now_[i] >= 0) old_row_of_point[row_now_[i]] = std::int64_t(i);

    const std::size_t active = candidates_.row.size();
    std::vector<std::int64_t> old_row(active);
    x_rebuilt_.resize(3 * active);
    v_rebuilt_.resize(3 * active);
    mass_.resize(active);
    radius_.resize(active);
    stiffness_.resize(active);
    id_.resize(active);
    for (std::size_t i = 0; i < active; ++i) {
        const std::uint32_t row = candidates_.row[i];
        old_row[i] = old_row_of_point[row];
        std::copy_n(&points.x[3 * std::size_t(row)], 3, &x_rebuilt_[3 * i]);
        std::copy_n(&points.v[3 * std::size_t(row)], 3, &v_rebuilt_[3 * i]);
        mass_[i] = points.mass[row];
        radius_[i] = points.radius[row];
        stiffness_[i] = points.stiffness[row];
        id_[i] = points.id[row];
    }
    law_.renumber(old_row);
    x_ = x_rebuilt_;
    v_ = v_rebuilt_;
    step_limit_ = detector_.detect(active_points(), surface_, candidates_, contacts_);
}

void PenaltyContact::update(std::span<const double> x_active, std::span<const double> v_active,
                            std::span<const double> x, std::span<const double> v) {
    surface_.move(x, v);
    x_ = x_active;
    v_ = v_active;
    step_limit_ = detector_.detect(active_points(), surface_, candidates_, contacts_);
}

void PenaltyContact::compute_forces(double dt) {
    law_.compute(active_points(), surface_, dt, contacts_);
    kick_ = 0.5 * (last_dt_ + dt);
    last_dt_ = dt;
}

void PenaltyContact::settle() {
    if (rebuilt_)
        ledger_.book(v_searched_, row_now_, surface_.v());
    else
        ledger_.book(v_, {}, surface_.v());
    rebuilt_ = false;
    ledger_.keep(active_points(), surface_, contacts_, law_.on_particles(), law_.on_nodes(),
                 {last_dt_, kick_, law_.relaxation()});
}

}  // namespace undertow::contact
