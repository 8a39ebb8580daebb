#include "fem_solver/rigid/rigid_body.hpp"

#include <algorithm>
#include <cmath>

#include "checkpoint/archive.hpp"
#include "fem_solver/rigid/largest_eigenvalue.hpp"
#include "fem_solver/rigid/rotation.hpp"

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Vector vector(const Vec3& a) {
    return Vector(a[0], a[1], a[2]);
}
Vector vector(const NodeRow& row) {
    return Vector(row.c[0], row.c[1], row.c[2]);
}
Vec3 array(const Vector& a) {
    return {a[0], a[1], a[2]};
}
void put(NodeRow& row, const Vector& a) {
    for (int d = 0; d < 3; ++d) row.c[d] = a[d];
}

Matrix inertia_of_point(double mass, const Vector& r) {
    return mass * (r.squaredNorm() * Matrix::Identity() - r * r.transpose());
}

}  // namespace

struct RigidBody::State {
    RigidSet set;
    double mass = 0;              // [kg]
    std::vector<Vector> frame;    // [m] nodes in the body's frame
    Vector weight_arm;            // [m] center of weight in the body's frame
    Matrix inertia;               // [kg m2] in the body's frame
    Vector free_move, free_turn;  // 1 or 0 per axis

    Vector center, v = Vector::Zero();  // [m], [m/s]
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
    Vector L = Vector::Zero(), w = Vector::Zero();  // [kg m2/s], [rad/s]
    Matrix step_turn = Matrix::Zero();  // (exp(dt w) - I)/dt [1/s]: velocities by chords
    Vector contact_force = Vector::Zero(), contact_moment = Vector::Zero();
    Vector driven_v = Vector::Zero(), driven_w = Vector::Zero();  // [m/s], [rad/s] as told
    Driven driven;

    Vector center_from, contact_force_from = Vector::Zero(), contact_moment_from = Vector::Zero();
    Eigen::Quaterniond turned_from = Eigen::Quaterniond::Identity();
    Vector weight_point_from;  // [m]

    /// w with I w = L among the free axes.
    Vector solve_among_free(const Matrix& I, const Vector& l) const {
        Matrix A = Matrix::Identity();
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (free_turn[i] != 0 && free_turn[j] != 0) A(i, j) = I(i, j);
        return A.ldlt().solve(l);
    }
    Matrix inertia_at(const Matrix& R) const { return R * inertia * R.transpose(); }

    /// w of the step dt that carries L.
    Vector turning_speed(double dt) const {
        const Matrix R = turned.toRotationMatrix();
        Vector speed = w;
        // The angle of a step is small, so each round gains as many digits as the angle is small.
        for (int round = 0; round < 100; ++round) {
            const Matrix middle = rotation_matrix(0.5 * dt * speed) * R;
            const Vector next = solve_among_free(inertia_at(middle), L);
            const double change = (next - speed).norm();
            speed = next;
            if (change <= 1e-15 * speed.norm()) break;
        }
        return speed;
    }
    Vector weight_point() const { return center + turned * weight_arm; }
    bool is_driven() const {
        return set.driven[0] || set.driven[1] || set.driven[2] || set.turn_driven;
    }
    void follow_drive(double dt);
    void find_drive(const Wrench& pull, const Vector& v_old, const Vector& L_old,
                    const Vector& w_old, double span);
};

/// Velocities in the directions that are told, instead of those of the forces.
void RigidBody::State::follow_drive(double dt) {
    for (int d = 0; d < 3; ++d)
        if (set.driven[d]) v[d] = driven_v[d];
    if (!set.turn_driven) return;
    w = driven_w;
    L = inertia_at(rotation_matrix(0.5 * dt * w) * turned.toRotationMatrix()) * w;
}

/// m dv/s - F, and the same of the turning, in the directions that are told: these are not damped.
void RigidBody::State::find_drive(const Wrench& pull, const Vector& v_old, const Vector& L_old,
                                  const Vector& w_old, double span) {
    driven = {};
    for (int d = 0; d < 3; ++d) {
        if (set.driven[d]) {
            const double f = mass * (v[d] - v_old[d]) / span - pull.force[d];
            driven.force.force[d] = f;
            driven.power_before += f * v_old[d];
            driven.power_after += f * v[d];
            driven.blow += 0.5 * mass * v[d] * v[d];
        }
        if (set.turn_driven) {
            const double m = (L[d] - L_old[d]) / span - pull.moment[d];
            driven.force.moment[d] = m;
            driven.power_before += m * w_old[d];
            driven.power_after += m * w[d];
            driven.blow += 0.5 * L[d] * w[d];
        }
    }
}

RigidBody::RigidBody(RigidSet set, Nodes& nodes) : s_(std::make_unique<State>()) {
    State& s = *s_;
    s.set = std::move(set);
    Vector moment = Vector::Zero();
    for (std::size_t i = 0; i < s.set.nodes.size(); ++i) {
        s.mass += s.set.mass[i];
        moment += s.set.mass[i] * vector(nodes.x[s.set.nodes[i]]);
    }
    s.mass += s.set.added_mass;
    moment += s.set.added_mass * vector(s.set.added_at);
    s.center = s.center_from = moment / s.mass;

    s.inertia = inertia_of_point(s.set.added_mass, vector(s.set.added_at) - s.center);
    for (std::size_t i = 0; i < s.set.nodes.size(); ++i) {
        const std::int32_t n = s.set.nodes[i];
        s.frame.push_back(vector(nodes.x[n]) - s.center);
        s.inertia += inertia_of_point(s.set.mass[i], s.frame.back());
        for (int d = 0; d < 3; ++d) nodes.inverse_mass[n].c[d] = 0;
    }
    s.weight_arm = vector(s.set.weight_center) - s.center;
    s.weight_point_from = s.weight_point();
    for (int d = 0; d < 3; ++d) {
        s.free_move[d] = s.set.free[d] ? 1 : 0;
        s.free_turn[d] = s.set.free[3 + d] ? 1 : 0;
    }
}
RigidBody::~RigidBody() = default;
RigidBody::RigidBody(RigidBody&&) noexcept = default;

void RigidBody::add_contact(const Vec3& x, const Vec3& force) {
    s_->contact_force += vector(force);
    s_->contact_moment += (vector(x) - s_->center).cross(vector(force));
}

void RigidBody::clear_contact() {
    s_->contact_force = s_->contact_moment = Vector::Zero();
}

Wrench RigidBody::load(const Nodes& nodes) const {
    Vector force = Vector::Zero(), moment = Vector::Zero();
    for (std::int32_t n : s_->set.nodes) {
        const Vector f = vector(nodes.f[n]);
        force += f;
        moment += (vector(nodes.x[n]) - s_->center).cross(f);
    }
    return {array(force), array(moment)};
}

Wrench RigidBody::pull(const Nodes& nodes, const Vec3& gravity) const {
    const State& s = *s_;
    const Wrench nodal = load(nodes);
    const Vector weight = s.set.weight_mass * vector(gravity);
    const Vector force = vector(nodal.force) + s.contact_force + weight;
    const Vector moment =
        vector(nodal.moment) + s.contact_moment + (s.weight_point() - s.center).cross(weight);
    return {array(force), array(moment)};
}

Wrench RigidBody::unbalanced(const Nodes& nodes, const Vec3& gravity) const {
    const Wrench all = pull(nodes, gravity);
    return {array(s_->free_move.cwiseProduct(vector(all.force))),
            array(s_->free_turn.cwiseProduct(vector(all.moment)))};
}

double RigidBody::launch(Nodes& nodes, const Vec3& v, const Vec3& w) {
    State& s = *s_;
    for (int d = 0; d < 3; ++d) {
        s.v[d] = s.set.driven[d] ? 0 : s.free_move[d] * v[d];
        s.w[d] = s.set.turn_driven ? 0 : s.free_turn[d] * w[d];
    }
    s.L = s.free_turn.cwiseProduct(s.inertia_at(s.turned.toRotationMatrix()) * s.w);
    for (std::size_t i = 0; i < s.set.nodes.size(); ++i)
        put(nodes.v[s.set.nodes[i]], s.v + s.w.cross(s.turned * s.frame[i]));
    return 0.5 * (s.mass * s.v.squaredNorm() + s.L.dot(s.w));
}

void RigidBody::rest_nodes(Nodes& nodes) const {
    for (std::int32_t n : s_->set.nodes) nodes.v[n] = NodeRow{};
}

KickReport RigidBody::kick(Nodes& nodes, const Kick& step) {
    State& s = *s_;
    const double span = 0.5 * (step.dt_before + step.dt_after);
    const double keep = 1 - 0.5 * step.damping * span, divide = 1 / (1 + 0.5 * step.damping * span);
    const Wrench all = pull(nodes, step.gravity);
    const Vector force = s.free_move.cwiseProduct(vector(all.force));
    const Vector moment = s.free_turn.cwiseProduct(vector(all.moment));
    const Vector v_old = s.v, L_old = s.L, w_old = s.w;
    s.v = (keep * v_old + span / s.mass * force) * divide;
    s.L = (keep * L_old + span * moment) * divide;
    s.w = s.turning_speed(step.dt_after);
    if (s.is_driven()) {
        s.follow_drive(step.dt_after);
        s.find_drive(all, v_old, L_old, w_old, span);
    }
    // chords: (R^{n+1} - R^n) X / dt, without the cancellation
    s.step_turn = step.dt_after > 0 ? Matrix(rotation_less_one(step.dt_after * s.w) / step.dt_after)
                                    : cross_matrix(s.w);
    for (std::size_t i = 0; i < s.set.nodes.size(); ++i) {
        const std::int32_t n = s.set.nodes[i];
        put(nodes.v[n], s.v + s.step_turn * (s.turned * s.frame[i]));
    }
    Vector v_mean = v_old + s.v, L_mean = L_old + s.L;
    for (int d = 0; d < 3; ++d)
        if (s.set.driven[d]) v_mean[d] = 0;
    if (s.set.turn_driven) L_mean.setZero();
    const double quarter = 0.25 * step.damping;
    KickReport report;
    report.kinetic = 0.5 * s.mass * v_old.dot(s.v) + 0.25 * (w_old.dot(s.L) + s.w.dot(L_old));
    report.damping_before =
        quarter * step.dt_before * (s.mass * v_mean.dot(v_old) + L_mean.dot(w_old));
    report.damping_after = quarter * step.dt_after * (s.mass * v_mean.dot(s.v) + L_mean.dot(s.w));
    return report;
}

void RigidBody::drift(Nodes& nodes, double dt) {
    State& s = *s_;
    s.center += dt * s.v;
    s.turned = (rotation_quaternion(dt * s.w) * s.turned).normalized();
    const Matrix R = s.turned.toRotationMatrix();
    for (std::size_t i = 0; i < s.set.nodes.size(); ++i)
        put(nodes.x[s.set.nodes[i]], s.center + R * s.frame[i]);
}

void RigidBody::drive(const Vec3& v, const Vec3& w) {
    s_->driven_v = vector(v);
    s_->driven_w = vector(w);
}

const RigidBody::Driven& RigidBody::driven() const {
    return s_->driven;
}

void RigidBody::stop(Nodes& nodes) {
    s_->driven_v = s_->driven_w = Vector::Zero();
    s_->v = s_->L = s_->w = Vector::Zero();
    s_->step_turn = Matrix::Zero();
    rest_nodes(nodes);
}

void RigidBody::count_from_here() {
    State& s = *s_;
    s.center_from = s.center;
    s.turned_from = s.turned;
    s.contact_force_from = s.contact_force;
    s.contact_moment_from = s.contact_moment;
    s.weight_point_from = s.weight_point();
}

double RigidBody::weight_work(const Vec3& gravity) const {
    return s_->set.weight_mass * vector(gravity).dot(s_->weight_point() - s_->weight_point_from);
}

Wrench RigidBody::contact() const {
    return {array(s_->contact_force - s_->contact_force_from),
            array(s_->contact_moment - s_->contact_moment_from)};
}

double RigidBody::reach() const {
    double squared = 0;
    for (const Vector& X : s_->frame) squared = std::max(squared, X.squaredNorm());
    return std::sqrt(squared);
}

double RigidBody::yield_to(const std::vector<Vec3>& x, const std::vector<double>& k) const {
    const State& s = *s_;
    double K[6][6] = {}, M[6][6] = {};
    for (std::size_t i = 0; i < x.size(); ++i) {
        double moves[3][6] = {};  // of the point by the six degrees of freedom
        const Matrix turns = -cross_matrix(vector(x[i]) - s.center);
        for (int a = 0; a < 3; ++a) {
            moves[a][a] = 1;
            for (int b = 0; b < 3; ++b) moves[a][3 + b] = turns(a, b);
        }
        for (int p = 0; p < 6; ++p)
            for (int q = 0; q < 6; ++q)
                for (int a = 0; a < 3; ++a) K[p][q] += k[i] * moves[a][p] * moves[a][q];
    }
    const Matrix inertia = s.inertia_at(s.turned.toRotationMatrix());
    for (int a = 0; a < 3; ++a) {
        M[a][a] = s.mass;
        for (int b = 0; b < 3; ++b) M[3 + a][3 + b] = inertia(a, b);
    }
    for (int d = 0; d < 6; ++d)
        if (!s.set.free[d]) {
            for (int e = 0; e < 6; ++e) K[d][e] = K[e][d] = M[d][e] = M[e][d] = 0;
            M[d][d] = 1;
        }
    return largest_eigenvalue(K, M);
}

void RigidBody::archive(Archive& a) {
    State& s = *s_;
    for (const auto& [name, v] : {std::pair("center", &s.center), {"v", &s.v}, {"L", &s.L},
                                  {"w", &s.w}, {"driven_v", &s.driven_v},
                                  {"driven_w", &s.driven_w},
                                  {"contact_force", &s.contact_force},
                                  {"contact_moment", &s.contact_moment},
                                  {"center_from", &s.center_from},
                                  {"contact_force_from", &s.contact_force_from},
                                  {"contact_moment_from", &s.contact_moment_from},
                                  {"weight_point_from", &s.weight_point_from}})
        a.fixed(name, v->data(), 3);
    a("drive_force", s.driven.force.force);
    a("drive_moment", s.driven.force.moment);
    a("drive_power_before", s.driven.power_before);
    a("drive_power_after", s.driven.power_after);
    a.fixed("turned", s.turned.coeffs().data(), 4);
    a.fixed("turned_from", s.turned_from.coeffs().data(), 4);
    a.fixed("step_turn", s.step_turn.data(), 9);
}

const RigidSet& RigidBody::set() const {
    return s_->set;
}
double RigidBody::mass() const {
    return s_->mass;
}
Vec3 RigidBody::center() const {
    return array(s_->center);
}
Vec3 RigidBody::center_at_start() const {
    return array(s_->center_from);
}
Vec3 RigidBody::displacement() const {
    return array(s_->center - s_->center_from);
}
Vec3 RigidBody::rotation() const {
    return array(rotation_vector(s_->turned * s_->turned_from.conjugate()));
}
Vec3 RigidBody::velocity() const {
    return array(s_->v);
}
Vec3 RigidBody::angular_velocity() const {
    return array(s_->w);
}
Vec3 RigidBody::moment_of_momentum() const {
    return array(s_->L);
}

}  // namespace undertow::fem
