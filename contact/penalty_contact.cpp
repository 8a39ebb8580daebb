#include "contact/penalty_contact.hpp"

#include <algorithm>
#include <bit>

namespace undertow::contact {

PenaltyContact::PenaltyContact(Surface surface, const LawSettings& law, DetectionRules rules,
                               int threads)
    : surface_(std::move(surface)), detector_(rules, threads), law_(law) {}

Points PenaltyContact::active_points() const {
    return {x_, v_, mass_, radius_, stiffness_, id_};
}

/// Where the active points of the previous search are found among the points of this one, and the
/// other way round. A hash table of the former active ones: points arrive in any order, and sorting
/// them all would cost more than the search.
void PenaltyContact::map_rows(const Points& points) {
    const int bits = std::max(4, int(std::bit_width(2 * id_.size())));
    const auto slot_of = [&](std::uint64_t id) {
        return std::size_t((id * 0x9E3779B97F4A7C15ull) >> (64 - bits));
    };
    const std::size_t mask = (std::size_t(1) << bits) - 1;
    slot_.assign(mask + 1, -1);
    for (std::size_t i = 0; i < id_.size(); ++i) {
        std::size_t slot = slot_of(id_[i]);
        while (slot_[slot] >= 0) slot = (slot + 1) & mask;
        slot_[slot] = std::int64_t(i);
    }
    row_now_.assign(id_.size(), -1);
    old_row_.assign(points.size(), -1);
    for (std::size_t row = 0; row < points.size(); ++row)
        for (std::size_t slot = slot_of(points.id[row]); slot_[slot] >= 0; slot = (slot + 1) & mask)
            if (id_[slot_[slot]] == points.id[row]) {
                old_row_[row] = slot_[slot];
                row_now_[slot_[slot]] = std::int64_t(row);
                break;
            }
}

void PenaltyContact::rebuild(const Points& points, double skin, std::span<const double> x,
                             std::span<const double> v, double longest_dt) {
    map_rows(points);
    v_searched_.assign(points.v.begin(), points.v.end());
    rebuilt_ = true;

    surface_.move(x, v);
    cells_.search(points, surface_, skin, candidates_);

    const std::size_t active = candidates_.row.size();
    former_row_.resize(active);
    x_rebuilt_.resize(3 * active);
    v_rebuilt_.resize(3 * active);
    mass_.resize(active);
    radius_.resize(active);
    stiffness_.resize(active);
    id_.resize(active);
    for (std::size_t i = 0; i < active; ++i) {
        const std::uint32_t row = candidates_.row[i];
        former_row_[i] = old_row_[row];
        std::copy_n(&points.x[3 * std::size_t(row)], 3, &x_rebuilt_[3 * i]);
        std::copy_n(&points.v[3 * std::size_t(row)], 3, &v_rebuilt_[3 * i]);
        mass_[i] = points.mass[row];
        radius_[i] = points.radius[row];
        stiffness_[i] = points.stiffness[row];
        id_[i] = points.id[row];
    }
    law_.renumber(former_row_);
    x_ = x_rebuilt_;
    v_ = v_rebuilt_;
    detector_.renew(active_points(), surface_, candidates_, former_row_);
    detect(longest_dt);
}

void PenaltyContact::update(std::span<const double> x_active, std::span<const double> v_active,
                            std::span<const double> x, std::span<const double> v,
                            double longest_dt) {
    surface_.move(x, v);
    x_ = x_active;
    v_ = v_active;
    detect(longest_dt);
}

void PenaltyContact::compute_forces(double dt) {
    law_.compute(active_points(), surface_, dt, contacts_);
    kick_ = 0.5 * (last_dt_ + dt);
    dt_before_ = last_dt_;
    last_dt_ = dt;
}

void PenaltyContact::settle() {
    ledger_.book(former_contacts_, rebuilt_ ? std::span<const double>(v_searched_) : v_,
                 rebuilt_ ? RowChanges{row_now_, former_row_} : RowChanges{}, surface_, contacts_);
    rebuilt_ = false;
    settled_ = true;
    ledger_.keep(active_points(), surface_, law_.on_particles(), law_.on_nodes(),
                 law_.touched_nodes(), {dt_before_, last_dt_});
}

/// The contacts of the last step stay as they are until they are booked.
void PenaltyContact::detect(double longest_dt) {
    if (settled_) former_contacts_.swap(contacts_);
    settled_ = false;
    step_limit_ = detector_.detect(active_points(), surface_, candidates_, longest_dt, contacts_);
}

}  // namespace undertow::contact
