#include "sph_solver/boundary/bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sph_solver/boundary/body_dummies.hpp"
#include "sph_solver/shapes/vectors.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

RigidBody::RigidBody(const Body& body, const Case& input)
    : body_(body),
      solid_(body.shape, input.info.dimension == 2, input.folder,
             fmt::format("{}: sph.body \"{}\"", input.file, body.name)),
      motion_(body, input),
      pose_(motion_(0)) {}

FromSurface RigidBody::at_rest(const Vec3& x) const {
    const FromSurface from = solid_(x);
    if (!body_.inside) return from;
    return {-from.distance, {-from.away[0], -from.away[1], -from.away[2]}};
}

FromSurface RigidBody::now(const Vec3& x, const Periodic& periodic) const {
    Vec3 rest = pose_.to_rest(x);
    periodic.wrap(rest.data());
    const FromSurface from = at_rest(rest);
    return {from.distance, pose_.direction(from.away)};
}

void Bodies::move_to(double t) {
    if (t == moved_to_) return;
    const bool first = moved_to_ < 0;
    moved_to_ = t;
    for (RigidBody& b : body)
        if (b.moves()) b.move_to(t);
    for (int d = 0; d < size(); ++d) {
        const RigidBody& b = body[owner[d]];
        if (!b.moves() && !first) continue;
        Vec3 at = b.pose().to_space(at_rest[d]);
        if (!periods.empty()) at = at + periods[d];
        x[d] = at[0], y[d] = at[1], z[d] = at[2];
    }
    find_fastest();
}

void Bodies::wrap(const Periodic& periodic) {
    if (periodic.axes().empty()) return;
    periods.resize(size(), Vec3{});
    for (int d = 0; d < size(); ++d) {
        Vec3 at{x[d], y[d], z[d]};
        periodic.wrap(at.data());
        periods[d] = periods[d] + (at - Vec3{x[d], y[d], z[d]});
        x[d] = at[0], y[d] = at[1], z[d] = at[2];
    }
}

void Bodies::find_fastest() {
    fastest_ = 0;
    for (const RigidBody& b : body)
        fastest_ = std::max(
            fastest_, std::hypot(b.body().velocity[0], b.body().velocity[1], b.body().velocity[2]));
    for (int d = 0; d < size(); ++d) {
        const RigidBody& b = body[owner[d]];
        if (b.moves())
            fastest_ = std::max(fastest_, length(b.pose().velocity_at({x[d], y[d], z[d]})));
    }
}

namespace {

/// Of a body that reaches beyond a periodic domain, what lies outside is an image of what lies
/// inside.
bool repeats_itself(const Vec3& x, const Case& input) {
    for (const std::string& axis : input.sph.periodic) {
        const int a = axis[0] - 'x';
        if (input.sph.domain &&
            (x[a] < input.sph.domain->min[a] || x[a] >= input.sph.domain->max[a]))
            return true;
    }
    return false;
}

}  // namespace

Bodies make_bodies(const Case& input) {
    Bodies bodies;
    for (const Body& b : input.sph.body) bodies.body.emplace_back(b, input);
    for (int k = 0; k < bodies.count(); ++k) {
        const std::vector<Dummy> dummies = place_dummies(bodies.body[k], input);
        if (dummies.empty())
            throw InputError(fmt::format(
                "{}: sph.body \"{}\": no dummy particle fits into it at sph.spacing = {:.4g} m: it "
                "is "
                "too small, or its scale is wrong (it spans {:.4g} m in x and {:.4g} m in z).",
                input.file, input.sph.body[k].name, input.sph.spacing,
                bodies.body[k].bounds().max[0] - bodies.body[k].bounds().min[0],
                bodies.body[k].bounds().max[2] - bodies.body[k].bounds().min[2]));
        for (const Dummy& d : dummies) {
            if (repeats_itself(d.x, input)) continue;
            bodies.at_rest.push_back(d.x);
            bodies.share.push_back(d.share);
            bodies.owner.push_back(k);
        }
    }
    const std::size_t n = bodies.at_rest.size();
    for (auto* a : {&bodies.x, &bodies.y, &bodies.z, &bodies.vx, &bodies.vy, &bodies.vz, &bodies.p})
        a->resize(n, 0.0);
    bodies.viscosity.resize(n, 0.0);
    bodies.fluid.resize(n, 0);
    bodies.move_to(0);
    return bodies;
}

}  // namespace undertow::sph
