#include "sph_solver/boundary/rigid_motion.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

Vec3 times(const double m[3][3], const Vec3& v) {
    return {m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
            m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
            m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2]};
}

/// Rotation by `angle` [rad] about a unit vector: Rodrigues' formula.
void set_turn(Pose& pose, const Vec3& axis, double angle) {
    pose.turned = true;
    const double c = std::cos(angle), s = std::sin(angle);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            pose.turn[a][b] = (a == b ? c : 0) + (1 - c) * axis[a] * axis[b];
    pose.turn[0][1] -= s * axis[2], pose.turn[0][2] += s * axis[1];
    pose.turn[1][0] += s * axis[2], pose.turn[1][2] -= s * axis[0];
    pose.turn[2][0] -= s * axis[1], pose.turn[2][1] += s * axis[0];
}

/// Rates of a formula by central differences; near t = 0 they stay on its side.
MotionTable::Value rates_of(const Expression& formula, double t, double step) {
    const double at = std::max(t, step);
    const double before = formula(0, 0, 0, at - step), now = formula(0, 0, 0, at),
                 after = formula(0, 0, 0, at + step);
    return {at == t ? now : formula(0, 0, 0, t), (after - before) / (2 * step),
            ((after - now) - (now - before)) / (step * step)};
}

}  // namespace

Vec3 Pose::to_space(const Vec3& x) const {
    if (!turned) return x + shift;
    return center + shift + times(turn, x - center);
}

Vec3 Pose::to_rest(const Vec3& x) const {
    if (!turned) return x - shift;
    return center + direction_at_rest(x - center - shift);
}

Vec3 Pose::direction(const Vec3& n) const {
    return turned ? times(turn, n) : n;
}

Vec3 Pose::direction_at_rest(const Vec3& n) const {
    if (!turned) return n;
    return {turn[0][0] * n[0] + turn[1][0] * n[1] + turn[2][0] * n[2],
            turn[0][1] * n[0] + turn[1][1] * n[1] + turn[2][1] * n[2],
            turn[0][2] * n[0] + turn[1][2] * n[1] + turn[2][2] * n[2]};
}

Vec3 Pose::velocity_at(const Vec3& x) const {
    return turned ? velocity + cross(spin, x - center - shift) : velocity;
}

Vec3 Pose::acceleration_at(const Vec3& x) const {
    if (!turned) return acceleration;
    const Vec3 r = x - center - shift;
    return acceleration + cross(spin_rate, r) + cross(spin, cross(spin, r));
}

RigidMotion::RigidMotion(const Body& body, const Case& input)
    : law_(body), step_(1e-5 * input.time.end) {
    if (!body.motion.empty()) {
        const bool absolute = body.motion[0] == '/' || input.folder.empty();
        table_.emplace(absolute ? body.motion : input.folder + "/" + body.motion, input.time.end,
                       input.file + ": sph.body \"" + body.name + "\"");
    }
    moves_ = table_ || !body.displacement.empty() || body.angle || body.velocity != Vec3{};
}

Pose RigidMotion::operator()(double t) const {
    Pose pose;
    pose.center = law_.center;
    if (!moves_) return pose;
    if (table_ || !law_.displacement.empty()) {
        for (int a = 0; a < 3; ++a) {
            const auto now = table_ ? (*table_)(a, t) : rates_of(law_.displacement[a], t, step_);
            pose.shift[a] = now.x;
            pose.velocity[a] = now.rate;
            pose.acceleration[a] = now.second_rate;
        }
    } else {
        const double moving = std::clamp(t, law_.start, law_.stop) - law_.start;
        pose.shift = moving * law_.velocity;
        if (t >= law_.start && t < law_.stop) pose.velocity = law_.velocity;
    }
    if (table_ || law_.angle) {
        const auto angle = table_ ? (*table_)(3, t) : rates_of(*law_.angle, t, step_);
        if (law_.angle || angle.x != 0 || angle.rate != 0) set_turn(pose, law_.axis, angle.x);
        pose.spin = angle.rate * law_.axis;
        pose.spin_rate = angle.second_rate * law_.axis;
    }
    return pose;
}

}  // namespace undertow::sph
