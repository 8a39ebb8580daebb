#include "sph_solver/setup/fill_plan.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

/// Even-odd rule, in the x-z plane.
bool in_polygon(const std::vector<std::array<double, 2>>& corner, double x, double z) {
    bool inside = false;
    for (std::size_t a = 0, b = corner.size() - 1; a < corner.size(); b = a++) {
        const auto& [xa, za] = corner[a];
        const auto& [xb, zb] = corner[b];
        if ((za > z) != (zb > z) && x < (xb - xa) * (z - za) / (zb - za) + xa) inside = !inside;
    }
    return inside;
}

/// Signed distance of x to an obstacle, negative inside, and the direction away from it.   [m]
double distance_to_box(const Box& box, const Vec3& x, bool flat, Vec3& away) {
    Vec3 beyond{};   // of the box, per axis; 0 between its faces
    double outside2 = 0, nearest_face = -1e300;
    int nearest_axis = 0, side = 1;
    for (int a = 0; a < 3; ++a) {
        if (flat && a == 1) continue;
        const double low = box.min[a] - x[a], high = x[a] - box.max[a];
        beyond[a] = high > 0 ? high : low > 0 ? -low : 0;
        outside2 += beyond[a] * beyond[a];
        if (std::max(low, high) > nearest_face)
            nearest_face = std::max(low, high), nearest_axis = a, side = high > low ? 1 : -1;
    }
    if (outside2 == 0) {
        away = {};
        away[nearest_axis] = side;
        return nearest_face;
    }
    const double d = std::sqrt(outside2);
    for (int a = 0; a < 3; ++a) away[a] = beyond[a] / d;
    return d;
}

double distance_to_cylinder(const Obstacle& o, const Vec3& x, Vec3& away) {
    Vec3 axis, from_middle;
    for (int a = 0; a < 3; ++a) {
        axis[a] = o.to[a] - o.from[a];
        from_middle[a] = x[a] - 0.5 * (o.from[a] + o.to[a]);
    }
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    double along = 0;
    for (int a = 0; a < 3; ++a) axis[a] /= length, along += axis[a] * from_middle[a];
    Vec3 radial;
    for (int a = 0; a < 3; ++a) radial[a] = from_middle[a] - along * axis[a];
    const double r = std::hypot(radial[0], radial[1], radial[2]);
    if (r > 0)
        for (double& c : radial) c /= r;
    const double over_end = std::abs(along) - 0.5 * length, over_side = r - o.radius;
    const double sign = along < 0 ? -1 : 1;
    if (over_end > 0 && over_side > 0) {   // off the rim
        const double d = std::hypot(over_end, over_side);
        for (int a = 0; a < 3; ++a)
            away[a] = (over_end * sign * axis[a] + over_side * radial[a]) / d;
        return d;
    }
    for (int a = 0; a < 3; ++a) away[a] = over_end > over_side ? sign * axis[a] : radial[a];
    return std::max(over_end, over_side);
}

}  // namespace

Vec3 ramp_distance(const Fill& fill) {
    Vec3 d;
    for (int a = 0; a < 3; ++a) d[a] = 0.5 * fill.ramp * fill.velocity[a];
    return d;
}

Vec3 start_velocity(const Fill& fill, const Vec3& x) {
    if (fill.ramp > 0) return {};
    if (fill.velocity_field.empty()) return fill.velocity;
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = fill.velocity_field[a](x[0], x[1], x[2]);
    return v;
}

FillPlan::FillPlan(const Case& input) : sph_(input.sph), flat_(input.info.dimension == 2) {
    for (const Fill& fill : sph_.fill) {
        behind_.push_back(ramp_distance(fill));
        const auto named = std::find_if(sph_.fluid.begin(), sph_.fluid.end(),
                                        [&](const Fluid& f) { return f.name == fill.fluid; });
        if (named == sph_.fluid.end())
            throw InputError(fmt::format("{}: sph.fill: there is no sph.fluid \"{}\".", input.file,
                                         fill.fluid));
        fluid_.push_back(static_cast<int>(named - sph_.fluid.begin()));
    }
}

bool FillPlan::contains(int k, const Vec3& at) const {
    const Fill& fill = sph_.fill[k];
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
        x[a] = at[a] + behind_[k][a];
        if (flat_ && a == 1) continue;
        if (x[a] < fill.box.min[a] || x[a] > fill.box.max[a]) return false;
    }
    // cell centers often lie exactly on a 45 degree face: a hair aside, all fall on the same side
    const double hair = 1e-6 * sph_.spacing;
    return fill.profile.empty() || in_polygon(fill.profile, x[0] + hair, x[2] + 0.7 * hair);
}

int FillPlan::owner(const Vec3& x) const {
    for (int k = static_cast<int>(sph_.fill.size()) - 1; k >= 0; --k)
        if (contains(k, x)) return k;
    return -1;
}

bool FillPlan::clear_obstacles(Vec3& x) const {
    const double clearance = 0.5 * sph_.spacing;
    for (const Obstacle& o : sph_.obstacle) {
        Vec3 away;
        const double d = o.box ? distance_to_box(*o.box, x, flat_, away)
                               : distance_to_cylinder(o, x, away);
        if (d < 0) return false;
        if (d >= clearance * (1 - 1e-9)) continue;
        for (int a = 0; a < 3; ++a) x[a] += (clearance - d) * away[a];
    }
    return true;
}

double FillPlan::pressure_at(const Vec3& x, const std::vector<double>& density, double g) const {
    const double dx = sph_.spacing;
    double pressure = 0, bottom = x[2];   // of the present layer
    Vec3 at = x;
    int above = owner(x), layer = above;
    while (above >= 0) {
        at[2] += dx;
        above = owner(at);
        if (above == layer) continue;
        const Fill& fill = sph_.fill[layer];
        const double box_top = fill.box.max[2] - behind_[layer][2];
        // the face between two layers lies between two cell centers; the uppermost one is known
        const double top = above >= 0 ? at[2] - 0.5 * dx : fill.surface_level.value_or(box_top);
        pressure += density[fluid_[layer]] * g * std::max(0.0, top - bottom);
        bottom = top;
        layer = above;
    }
    return pressure;
}

}  // namespace undertow::sph
