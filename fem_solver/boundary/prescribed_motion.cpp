#include "fem_solver/boundary/prescribed_motion.hpp"

#include <algorithm>

#include "fem_solver/rigid/rotation.hpp"

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

Vector vector(const Vec3& a) {
    return Vector(a[0], a[1], a[2]);
}

}  // namespace

PrescribedMotion::PrescribedMotion(std::string name, MotionLaw law, std::array<bool, 3> directions,
                                   std::vector<std::int32_t> nodes, int body)
    : name_(std::move(name)),
      law_(std::move(law)),
      directions_(directions),
      node_(std::move(nodes)),
      body_(body),
      now_(law_(0)),
      next_(now_),
      v_before_(node_.size()) {}

void PrescribedMotion::hold(Nodes& nodes) const {
    for (std::int32_t n : node_)
        for (int d = 0; d < 3; ++d)
            if (directions_[d]) nodes.inverse_mass[n].c[d] = 0;
}

void PrescribedMotion::before_kick(Nodes& nodes) {
    for (std::size_t i = 0; i < node_.size(); ++i) {
        NodeRow& v = nodes.v[node_[i]];
        v_before_[i] = v;
        for (int d = 0; d < 3; ++d)
            if (directions_[d]) v.c[d] = 0;
    }
}

/// [m] from n to n + 1 of what is at `at` at t = 0. The turn of the step comes from its own angle:
/// nothing is lost by subtracting places.
Vec3 PrescribedMotion::step_of(const Vec3& at) const {
    Vec3 step;
    for (int d = 0; d < 3; ++d) step[d] = next_.shift[d] - now_.shift[d];
    if (!law_.turns()) return step;
    const Vector axis = vector(law_.axis());
    const Vector arm = vector(at) - vector(law_.center());
    const Vector turned = rotation_matrix(now_.angle * axis) * arm;
    const Vector more = rotation_less_one((next_.angle - now_.angle) * axis) * turned;
    for (int d = 0; d < 3; ++d) step[d] += more[d];
    return step;
}

void PrescribedMotion::after_kick(Nodes& nodes, const Kick& step, double t, KickReport& report) {
    const double dt = step.dt_after, span = 0.5 * (step.dt_before + dt);
    if (!(dt > 0)) return;
    next_ = law_(t + dt);
    Vector force = Vector::Zero(), moment = Vector::Zero();
    double before = 0, after = 0;
    double blow = 0;  // [J] see RigidBody::Driven
    const Vector center = vector(law_.center()) + vector(now_.shift);
    for (std::size_t i = 0; i < node_.size(); ++i) {
        const std::int32_t n = node_[i];
        const NodeRow& start = nodes.x0[n];
        const Vec3 move = step_of({start.c[0], start.c[1], start.c[2]});
        Vector r = Vector::Zero();
        double speed2 = 0;
        for (int d = 0; d < 3; ++d) {
            double& v = nodes.v[n].c[d];
            if (directions_[d]) {
                const double m = nodes.mass[n], v_old = v_before_[i].c[d];
                v = move[d] / dt;
                r[d] = m * ((v - v_old) / span - nodes.weight_share[n] * step.gravity[d]) -
                       nodes.f[n].c[d];
                report.kinetic += 0.5 * m * v * v_old;
                before += r[d] * v_old;
                after += r[d] * v;
                if (step.dt_before == 0) blow += 0.5 * m * v * v;
            }
            speed2 += v * v;
        }
        report.speed2 = std::max(report.speed2, speed2);
        force += r;
        const Vector at(nodes.x[n].c[0], nodes.x[n].c[1], nodes.x[n].c[2]);
        moment += (at - center).cross(r);
    }
    force_ = {{force[0], force[1], force[2]}, {moment[0], moment[1], moment[2]}};
    work_ += ahead_ + 0.5 * step.dt_before * before;
    ahead_ = 0.5 * dt * after - blow;
}

void PrescribedMotion::drive(RigidBody& body, double t, double dt) {
    if (!(dt > 0)) return;
    next_ = law_(t + dt);
    Vec3 v = step_of(body.center_at_start()), w{};
    for (int d = 0; d < 3; ++d) {
        v[d] /= dt;
        w[d] = law_.axis()[d] * (next_.angle - now_.angle) / dt;
    }
    body.drive(v, w);
}

void PrescribedMotion::read_force(const RigidBody& body, const Kick& step) {
    const RigidBody::Driven& driven = body.driven();
    force_ = driven.force;
    work_ += ahead_ + 0.5 * step.dt_before * driven.power_before;
    ahead_ = 0.5 * step.dt_after * driven.power_after;
    if (step.dt_before == 0) ahead_ -= driven.blow;
}

void PrescribedMotion::drift() {
    now_ = next_;
}

}  // namespace undertow::fem
