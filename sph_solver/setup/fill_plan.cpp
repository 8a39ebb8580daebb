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
    for (const Obstacle& o : sph_.obstacle)
        obstacle_.emplace_back(o.shape, flat_, input.folder,
                               fmt::format("{}: sph.obstacle \"{}\"", input.file, o.name));
    for (const Body& b : sph_.body) body_.emplace_back(b, input);
    for (const Fill& fill : sph_.fill) {
        behind_.push_back(ramp_distance(fill));
        const auto named = std::find_if(sph_.fluid.begin(), sph_.fluid.end(),
                                        [&](const Fluid& f) { return f.name == fill.fluid; });
        if (named == sph_.fluid.end())
            throw InputError(fmt::format("{}: sph.fill: there is no sph.fluid \"{}\".", input.file,
                                         fill.fluid));
        fluid_.push_back(static_cast<int>(named - sph_.fluid.begin()));
        spacing_.push_back(named->spacing > 0 ? named->spacing : sph_.spacing);
        within_.push_back(cells_within(fill, input, within_.size()));
    }
}

FillPlan::Cells FillPlan::cells_within(const Fill& fill, const Case& input, std::size_t k) const {
    Cells cells;
    const double dx = spacing_[k];
    if (fill.within.radius == 0 && fill.within.stl.empty()) return cells;
    const Solid solid(fill.within, flat_, input.folder,
                      fmt::format("{}: sph.fill[{}]", input.file, k));
    for (int a = 0; a < 3; ++a)
        cells.n[a] = flat_ && a == 1
                         ? 1
                         : static_cast<int>(
                               std::lround((fill.box.max[a] - fill.box.min[a]) / dx));
    for (int iz = 0; iz < cells.n[2]; ++iz)
        for (int iy = 0; iy < cells.n[1]; ++iy)
            for (int ix = 0; ix < cells.n[0]; ++ix) {
                Vec3 x = fill.box.min;
                x[0] += (ix + 0.5) * dx, x[2] += (iz + 0.5) * dx;
                x[1] = flat_ ? 0 : x[1] + (iy + 0.5) * dx;
                cells.inside.push_back(solid(x).distance < 0);
            }
    return cells;
}

bool FillPlan::in_body(const Vec3& x) const {
    for (const Solid& o : obstacle_)
        if (o(x).distance < 0) return true;
    for (const RigidBody& b : body_)
        if (b.now(x, {}).distance < 0) return true;
    return false;
}

bool FillPlan::contains(int k, const Vec3& at) const {
    const Fill& fill = sph_.fill[k];
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
        x[a] = at[a] + behind_[k][a];
        if (flat_ && a == 1) continue;
        if (x[a] < fill.box.min[a] || x[a] > fill.box.max[a]) return false;
    }
    if (const Cells& cells = within_[k]; !cells.inside.empty()) {
        int cell[3];
        for (int a = 0; a < 3; ++a) {
            const double at_cell = (x[a] - fill.box.min[a]) / spacing_[k];
            cell[a] = flat_ && a == 1 ? 0 : std::clamp(static_cast<int>(at_cell), 0, cells.n[a] - 1);
        }
        if (!cells.inside[(std::size_t(cell[2]) * cells.n[1] + cell[1]) * cells.n[0] + cell[0]])
            return false;
    }
    // cell centers often lie exactly on a 45 degree face: a hair aside, all fall on the same side
    const double hair = 1e-6 * spacing_[k];
    return fill.profile.empty() || in_polygon(fill.profile, x[0] + hair, x[2] + 0.7 * hair);
}

int FillPlan::owner(const Vec3& x) const {
    for (int k = static_cast<int>(sph_.fill.size()) - 1; k >= 0; --k)
        if (contains(k, x)) return k;
    return -1;
}

bool FillPlan::clear_obstacles(Vec3& x, double clearance) const {
    const auto clear = [&](const FromSurface& from) {
        const double d = from.distance;
        if (d < 0) return false;
        if (d < clearance * (1 - 1e-9))
            for (int a = 0; a < 3; ++a) x[a] += (clearance - d) * from.away[a];
        return true;
    };
    for (const Solid& o : obstacle_)
        if (!clear(o(x))) return false;
    for (const RigidBody& b : body_)
        if (!clear(b.now(x, {}))) return false;
    return true;
}

double FillPlan::pressure_at(const Vec3& x, const std::vector<double>& density, double g) const {
    double pressure = 0, bottom = x[2];   // of the present layer
    Vec3 at = x;
    int above = owner(x), layer = above;
    while (above >= 0) {
        const double dx = spacing_[layer];
        at[2] += dx;
        above = owner(at);
        if (above == layer) continue;
        const Fill& fill = sph_.fill[layer];
        const double box_top = fill.box.max[2] - behind_[layer][2];
        // the face between two layers lies between two cell centers; the uppermost one is known
        const double top = above >= 0 ? at[2] - 0.5 * dx : fill.surface_level.value_or(box_top);
        pressure += density[fluid_[layer]] * g * std::max(0.0, top - bottom);
        bottom = top;
        // on in the middle of the cells of the layer above
        if (above >= 0 && spacing_[above] != dx) at[2] = top + 0.5 * spacing_[above];
        layer = above;
    }
    return pressure;
}

}  // namespace undertow::sph
