#include "sph_solver/boundary/mirror_planes.hpp"

#include <cmath>

#include <fmt/format.h>

#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

constexpr int most_planes = 10;   // the table of reflections has 2^planes entries, and
constexpr int most_bits = 12;     // two bits more per periodic axis

Reflection identity() {
    Reflection r{};
    for (int a = 0; a < 3; ++a) r.m[a][a] = 1;
    return r;
}

/// First r, then the mirror of w.
Reflection then_mirror(const Reflection& r, const PlaneWall& w) {
    const Vec3& n = w.normal;
    const double offset = w.point[0] * n[0] + w.point[1] * n[1] + w.point[2] * n[2];
    Reflection s{};
    for (int a = 0; a < 3; ++a) {
        s.t[a] = r.t[a] + 2 * offset * n[a];
        for (int b = 0; b < 3; ++b) s.t[a] -= 2 * n[a] * n[b] * r.t[b];
        for (int c = 0; c < 3; ++c) {
            s.m[a][c] = r.m[a][c];
            for (int b = 0; b < 3; ++b) s.m[a][c] -= 2 * n[a] * n[b] * r.m[b][c];
        }
    }
    return s;
}

}  // namespace

MirrorPlanes::MirrorPlanes(const std::vector<PlaneWall>& planes, const Periodic& periodic)
    : planes_(planes), periodic_(periodic) {
    if (planes_.size() > most_planes)
        throw InputError(fmt::format("sph.plane: {} planes, at most {} are allowed.",
                                     planes_.size(), most_planes));
    for (PlaneWall& w : planes_) {
        const double length = std::hypot(w.normal[0], w.normal[1], w.normal[2]);
        if (!(length > 0))
            throw InputError(fmt::format("sph.plane \"{}\": normal must not be zero.", w.name));
        for (double& component : w.normal) component /= length;
    }
    for (std::size_t a = 0; a < planes_.size(); ++a)
        for (std::size_t b = a + 1; b < planes_.size(); ++b) {
            double cosine = 0;
            for (int k = 0; k < 3; ++k) cosine += planes_[a].normal[k] * planes_[b].normal[k];
            const double off = std::min(std::abs(cosine), 1 - std::abs(cosine));
            if (off > 1e-9)
                throw InputError(fmt::format(
                    "sph.plane \"{}\" and \"{}\" meet at {:.2f} degrees: mirror planes must be "
                    "perpendicular or parallel; model the slanted one as an [[sph.body]].",
                    planes_[a].name, planes_[b].name,
                    std::acos(std::min(1.0, std::abs(cosine))) * 180 / 3.14159265358979));
        }
    for (const Periodic::Axis& a : periodic_.axes())
        for (const PlaneWall& w : planes_)
            if (std::abs(w.normal[a.axis]) > 1e-9)
                throw InputError(fmt::format(
                    "sph.plane \"{0}\": its normal has the component {1:.4g} along {2}, which "
                    "sph.periodic repeats without an end: remove the plane or take \"{2}\" out of "
                    "sph.periodic.",
                    w.name, w.normal[a.axis], std::string(1, "xyz"[a.axis])));
    const int bits = size() + 2 * static_cast<int>(periodic_.axes().size());
    if (bits > most_bits)
        throw InputError(fmt::format(
            "sph.plane: {} planes, at most {} are allowed beside {} periodic axes.", size(),
            most_bits - 2 * periodic_.axes().size(), periodic_.axes().size()));
    table_.resize(std::size_t(1) << bits);
    table_[0] = identity();
    for (PlaneMask mask = 1; mask < table_.size(); ++mask) {
        int highest = bits - 1;
        while (!(mask >> highest & 1)) --highest;
        const Reflection& rest = table_[mask & ~(PlaneMask(1) << highest)];
        if (highest < size()) {
            table_[mask] = then_mirror(rest, planes_[highest]);
            continue;
        }
        const Periodic::Axis& a = periodic_.axes()[(highest - size()) / 2];
        table_[mask] = rest;
        table_[mask].t[a.axis] += (highest - size()) % 2 ? -a.length : a.length;
    }
}

void MirrorPlanes::images_of(double x, double y, double z, double range,
                             std::vector<PlaneMask>& masks) const {
    // Mirroring at one plane leaves the distance from a perpendicular one unchanged, so a corner's
    // images are all unions of the single ones; parallel planes are never combined.
    const std::size_t first = masks.size();
    for (int k = 0; k < size(); ++k) {
        if (std::abs(distance(k, x, y, z)) >= range) continue;
        const std::size_t before = masks.size();
        masks.push_back(PlaneMask(1) << k);
        for (std::size_t m = first; m < before; ++m) {
            bool perpendicular = true;
            for (int b = 0; b < k; ++b)
                if (masks[m] >> b & 1) {
                    double cosine = 0;
                    for (int a = 0; a < 3; ++a)
                        cosine += planes_[k].normal[a] * planes_[b].normal[a];
                    perpendicular = perpendicular && std::abs(cosine) < 0.5;
                }
            if (perpendicular) masks.push_back(masks[m] | PlaneMask(1) << k);
        }
    }
    // Neither kind changes the distances that the other asks for: again all unions.
    const double at[3] = {x, y, z};
    int bit = size();
    for (const Periodic::Axis& a : periodic_.axes()) {
        const std::size_t before = masks.size();
        const double above = at[a.axis] - a.low;
        for (const double depth : {above, a.length - above}) {
            const PlaneMask moved = PlaneMask(1) << bit++;
            if (depth >= range) continue;
            masks.push_back(moved);
            for (std::size_t m = first; m < before; ++m) masks.push_back(masks[m] | moved);
        }
    }
}

void MirrorPlanes::to_fixed(const double origin[3], double unit,
                            std::vector<FixedReflection>& table) const {
    table.assign(table_.size(), {});
    for (std::size_t mask = 0; mask < table_.size(); ++mask) {
        const Reflection& r = table_[mask];
        FixedReflection& f = table[mask];
        f.diagonal = true;
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b)
                f.diagonal = f.diagonal && (a == b ? std::abs(r.m[a][b]) == 1 : r.m[a][b] == 0);
            // x = origin + unit X on both sides of x' = m x + t; rounding moves the wall by 1e-9 m
            // (without the origin where there is none: a period up and one down must be opposite)
            const double shift =
                r.m[a][a] == 1 ? r.t[a] : r.m[a][a] * origin[a] + r.t[a] - origin[a];
            const double offset = shift / unit;
            f.diagonal = f.diagonal && std::abs(offset) < 2e9;   // a plane far out of the scene
            if (!f.diagonal) break;
            f.sign[a] = r.m[a][a] > 0 ? 1 : -1;
            f.offset[a] = static_cast<std::int32_t>(std::lrint(offset));
        }
    }
}

bool MirrorPlanes::put_back(double& x, double& y, double& z, double& vx, double& vy,
                            double& vz) const {
    bool behind = false;
    for (int k = 0; k < size(); ++k) {
        const double d = distance(k, x, y, z);
        if (!(d < 0)) continue;
        behind = true;
        const Vec3& n = planes_[k].normal;
        const double vn = vx * n[0] + vy * n[1] + vz * n[2];
        x -= 2 * d * n[0], y -= 2 * d * n[1], z -= 2 * d * n[2];
        if (vn < 0) vx -= 2 * vn * n[0], vy -= 2 * vn * n[1], vz -= 2 * vn * n[2];
    }
    return behind;
}

}  // namespace undertow::sph
