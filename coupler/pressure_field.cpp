#include "coupler/pressure_field.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "checkpoint/archive.hpp"

namespace undertow::coupler {

namespace {

using contact::Vec;

MeshCells cells_of(const JointSurface& surface) {
    MeshCells cells;
    cells.quads = surface.quad;  // a triangle repeats its third node
    return cells;
}

/// [m2] of a facet: half the cross product of its diagonals, exact for a flat one.
double area_of(std::span<const double> x, const std::int32_t* quad) {
    const auto at = [&](int a) { return Vec(Vec::Map(&x[3 * std::size_t(quad[a])])); };
    return 0.5 * (at(2) - at(0)).cross(at(3) - at(1)).norm();
}

}  // namespace

PressureField::PressureField(const std::string& folder, const JointSurface& surface, double every,
                             FileStart start)
    : every_(every),
      quad_(surface.quad),
      impulse_(quad_.size() / 4, 0),
      largest_(impulse_),
      force_(impulse_),
      mean_(impulse_),
      peak_(impulse_),
      file_(folder + "/contact", surface.mass.size(), cells_of(surface), start) {}

void PressureField::count(const contact::PenaltyContact& contact) {
    const contact::ContactList& contacts = contact.contacts();
    time_ += contact.kick();
    hit_.clear();
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        const contact::ContactPack& pack = contacts.pack(p);
        for (int lane = 0; lane < contacts.lanes(p); ++lane) {
            const std::size_t facet = std::size_t(pack.facet[lane]);
            if (force_[facet] == 0) hit_.push_back(std::uint32_t(facet));
            force_[facet] += pack.normal_force[lane];
        }
    }
    for (const std::uint32_t facet : hit_) {
        impulse_[facet] += contact.kick() * force_[facet];
        largest_[facet] = std::max(largest_[facet], force_[facet]);
        force_[facet] = 0;  // one that is listed twice adds nothing the second time
    }
}

bool PressureField::due(double t, bool common) const {
    if (every_ == 0) return common;
    constexpr double round_off = 1e-12;  // of t, a sum of steps
    const double next = written_ < 0 ? 0 : std::floor(written_ / every_ * (1 + round_off)) + 1;
    return t >= next * every_ * (1 - round_off);
}

void PressureField::write(double t, std::span<const double> x) {
    if (t == written_) return;
    written_ = t;
    for (std::size_t f = 0; f < mean_.size(); ++f) {
        const double area = area_of(x, &quad_[4 * f]);
        mean_[f] = time_ > 0 ? impulse_[f] / (time_ * area) : 0;
        peak_[f] = largest_[f] / area;
    }
    file_.append(t, x, {},
                 {{"contact_pressure", "Pa", 1, mean_}, {"contact_pressure_peak", "Pa", 1, peak_}});
    std::fill(impulse_.begin(), impulse_.end(), 0);
    std::fill(largest_.begin(), largest_.end(), 0);
    time_ = 0;
}

void PressureField::archive(Archive& a) {
    a("impulse", impulse_);
    a("largest", largest_);
    a("time", time_);
    a("written", written_);
    a.object("file", file_);
}

}  // namespace undertow::coupler
