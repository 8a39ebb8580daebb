// One rigid body: free flight, spin, weight, locked directions, forces on its nodes.

#include "fem_solver/rigid/rigid_body.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "fem_solver/rigid/largest_eigenvalue.hpp"
#include "fem_solver/rigid/rotation.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

const double pi = std::acos(-1.0);

/// One steel block as a rigid body.
Case one_body(std::vector<std::string> free = {"x", "y", "z", "rx", "ry", "rz"}) {
    Case c = two_solids(1e7, 1800);
    c.fem.part = {{"body", "steel"}};
    c.fem.rigid = {{"body", "body", free, 0, {}}};
    return c;
}

Mesh brick(const Vec3& size, std::array<int, 3> divisions = {3, 2, 2}) {
    Mesh mesh;
    add_block(mesh, "body", {{0, 0, 0}, size}, divisions);
    return mesh;
}

/// Sets the body spinning by one step under forces that make the moment of momentum L.
void spin_up(Structure& s, const Vector& L, double dt) {
    const RigidBody& body = s.bodies()[0];
    Nodes& nodes = s.nodes();
    // f_i = m_i (a x r_i): moment I a, no force
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    const Vec3 c = body.center();
    const Vector center(c[0], c[1], c[2]);
    const auto arm = [&](std::size_t n) {
        return Vector(Vector(nodes.x[n].c[0], nodes.x[n].c[1], nodes.x[n].c[2]) - center);
    };
    for (std::size_t n = 0; n < nodes.size(); ++n)
        inertia += nodes.mass[n] * (arm(n).squaredNorm() * Eigen::Matrix3d::Identity() -
                                    arm(n) * arm(n).transpose());
    const Vector a = inertia.ldlt().solve(L) / (0.5 * dt);
    s.internal_forces();
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Vector f = nodes.mass[n] * a.cross(arm(n));
        for (int d = 0; d < 3; ++d) nodes.f[n].c[d] = f[d];
    }
    s.kick(dt);
    s.drift(dt);
}

TEST_CASE("the largest eigenvalue of K u = lambda M u, M positive definite") {
    // B^T D B u = lambda B^T B u has the eigenvalues D
    const double B[3][3] = {{2, 1, -0.5}, {0, 3, 0.25}, {1, 0, 1.5}}, D[3] = {4, -7, 5};
    double K[3][3] = {}, M[3][3] = {};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                K[i][j] += B[k][i] * D[k] * B[k][j], M[i][j] += B[k][i] * B[k][j];
    CHECK(largest_eigenvalue(K, M) == Approx(5).epsilon(1e-13));
    const double none[2][2] = {}, one[2][2] = {{1, 0}, {0, 1}};
    CHECK(largest_eigenvalue(none, one) == 0);
}

TEST_CASE("a body's mass, center and weight are those of its elements and of what is added") {
    Case c = one_body();
    c.fem.material[1].weight_density = 6850;
    c.fem.rigid[0].added_mass = 1000;
    c.fem.rigid[0].added_at = {1, 0, 3};
    Structure s(build_model(c, brick({1, 0.5, 0.2})), 1);
    const RigidBody& body = s.bodies()[0];
    CHECK(body.mass() == Approx(785 + 1000));
    CHECK(body.center()[0] == Approx((785 * 0.5 + 1000 * 1) / 1785));
    CHECK(body.center()[2] == Approx((785 * 0.1 + 1000 * 3) / 1785));
    CHECK(body.set().weight_mass == Approx(685));
    CHECK(body.set().weight_center[0] == Approx(0.5));
    double lumped = 0;
    for (double m : s.nodes().mass) lumped += m;
    CHECK(lumped == Approx(785));  // what the coupler sees has no added mass
}

TEST_CASE("a free body keeps its moment of momentum to the last bit, its energy and its shape") {
    // an unequal brick that tumbles about its unstable middle axis
    Structure s(build_model(one_body(), brick({1, 0.5, 0.2})), 1);
    const double dt = 1e-3;
    spin_up(s, {80, 2800, 40}, dt);
    const RigidBody& body = s.bodies()[0];
    const Vec3 L0 = body.moment_of_momentum();
    const Nodes& nodes = s.nodes();
    const auto size = [&] {  // [m] of the space diagonal
        double squared = 0;
        for (int d = 0; d < 3; ++d)
            squared += std::pow(nodes.x.back().c[d] - nodes.x.front().c[d], 2);
        return std::sqrt(squared);
    };
    const double size0 = size();
    double low = 1e300, high = 0, early = 0, late = 0, turned = 0;
    int up = 0;
    double before = 0;
    const int steps = 20000;
    march(s, dt, steps, [&](int n) {
        if (n == 0) return;
        const double e = s.energies().kinetic;
        low = std::min(low, e);
        high = std::max(high, e);
        (n < steps / 2 ? early : late) += e / (n < steps / 2 ? steps / 2 - 1 : steps / 2);
        const Vec3 w = body.angular_velocity();
        turned += dt * std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        if (before < 0 && w[0] >= 0) ++up;
        before = w[0];
    });
    const Vec3 L = body.moment_of_momentum();
    for (int d = 0; d < 3; ++d) CHECK(L[d] == L0[d]);
    WARN("tumbling brick, " << turned / (2 * pi) << " turns in " << steps
                            << " steps: energy ripples by " << (high - low) / high << ", drifts by "
                            << (late - early) / early << ", shape " << size() / size0 - 1);
    CHECK(turned > 100);                           // turns of 1/200 rev per step: many revolutions
    CHECK(up > 2);                                 // it does tumble
    CHECK((high - low) / high < 1e-2);             // (w dt)^2 = 1e-3, times a factor of order 1
    CHECK(std::abs(late - early) / early < 1e-4);  // no drift, but the tumbling is not periodic
    CHECK(std::abs(size() / size0 - 1) < 1e-13);   // round-off of one placement
}

TEST_CASE("a symmetric top precesses about L at L/I") {
    // axes of a square prism: I1 = I2 = I, I3; L makes an angle with the axis of symmetry, which
    // runs round L at L/I  [Landau and Lifshitz, Mechanics, par. 33]
    Structure s(build_model(one_body(), brick({0.4, 0.4, 1}, {2, 2, 4})), 1);
    const double dt = 2e-4;
    spin_up(s, {0, 1000, 4000}, dt);
    const RigidBody& body = s.bodies()[0];
    const Nodes& nodes = s.nodes();
    // inertia of the lumped nodes about x through the center
    double I = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        I += nodes.mass[n] *
             (std::pow(nodes.x0[n].c[1] - 0.2, 2) + std::pow(nodes.x0[n].c[2] - 0.5, 2));
    const Vec3 L = body.moment_of_momentum();
    const double size = std::sqrt(L[0] * L[0] + L[1] * L[1] + L[2] * L[2]);
    // component of the axis across L: its angle about L
    const auto angle = [&] {
        Vector axis = Vector::Zero();
        for (int d = 0; d < 3; ++d) axis[d] = nodes.x.back().c[d] - nodes.x.front().c[d];
        const Vector l = Vector(L[0], L[1], L[2]) / size;
        const Vector e1 = Vector::UnitX(), e2 = l.cross(e1);
        const Vec3 w = body.angular_velocity();
        const Vector across = Vector(w[0], w[1], w[2]);  // w precesses with the axis
        return std::atan2(across.dot(e2), across.dot(e1));
    };
    double last = 0, sum = 0;
    const int steps = 20000;
    march(s, dt, steps, [&](int n) {
        const double now = angle();
        if (n > 0) sum += std::remainder(now - last, 2 * pi);
        last = now;
    });
    const double rate = sum / ((steps - 1) * dt);
    WARN("top: precession " << rate << " 1/s, L/I = " << size / I << " over " << sum / (2 * pi)
                            << " rounds");
    CHECK(rate == Approx(size / I).epsilon(1e-3));
}

TEST_CASE("a rigid body falls as everything does, and an added mass without weight slows it") {
    const double added = GENERATE(0.0, 500.0);
    Case c = one_body();
    c.info.gravity = {0, 0, -9.81};
    c.fem.rigid[0].added_mass = added;
    c.fem.rigid[0].added_at = {0.5, 0.25, 0.1};  // its center, so that it does not turn
    Structure s(build_model(c, brick({1, 0.5, 0.2})), 1);
    const double dt = 1e-3;
    Energies last;
    march(s, dt, 500, [&](int) { last = s.energies(); });
    const double a = 9.81 * 785 / (785 + added);
    CHECK(s.bodies()[0].displacement()[2] == Approx(-0.5 * a * 0.25).epsilon(1e-10));
    CHECK(s.displacement(3)[2] == Approx(-0.5 * a * 0.25).epsilon(1e-10));
    CHECK(std::abs(s.displacement(3)[0]) < 1e-12);
    // 1/2 m v- v+ begins at -m (a dt)^2/8: a constant offset of second order in dt
    const double m = 785 + added;
    CHECK(std::abs(last.balance_error()) < 1.01 / 8 * m * std::pow(a * dt, 2));
}

TEST_CASE("a body held in y swings about y as a pendulum pushed off its center") {
    // a force at a corner of half a body: x, z and ry move, y, rx and rz stay, and the energy of
    // the motion is the work of the force
    Structure s(build_model(one_body({"x", "z", "ry"}), brick({1, 0.5, 0.2})), 1);
    Nodes& nodes = s.nodes();
    const double dt = 1e-4;
    const std::int32_t corner = 0;
    double work = 0;
    const double f[3] = {30, 70, 200};
    for (int n = 0; n < 3000; ++n) {
        s.internal_forces();
        for (int d = 0; d < 3; ++d) nodes.f[corner].c[d] += f[d];
        for (int d = 0; d < 3; ++d) work += 0.5 * (n > 0 ? dt : 0) * f[d] * nodes.v[corner].c[d];
        s.kick(dt);
        if (n == 2999) break;
        for (int d = 0; d < 3; ++d) work += 0.5 * dt * f[d] * nodes.v[corner].c[d];
        s.drift(dt);
    }
    const RigidBody& body = s.bodies()[0];
    CHECK(body.displacement()[1] == 0);
    CHECK(body.rotation()[0] == 0);
    CHECK(body.rotation()[2] == 0);
    CHECK(std::abs(body.rotation()[1]) > 0.05);
    CHECK(body.velocity()[0] == Approx(30.0 / 785 * (2999.5) * dt).epsilon(1e-12));
    // midpoint rotation against the moment at n: second order in the angle of a step (3e-5)
    CHECK(s.energies().kinetic == Approx(work).epsilon(1e-6));
    for (std::size_t n = 0; n < nodes.size(); ++n)
        CHECK(nodes.x[n].c[1] == Approx(nodes.x0[n].c[1]).margin(1e-15));
}

TEST_CASE("damping slows a rigid body as it slows nodes") {
    Case c = one_body();
    c.fem.damping_alpha = 5;
    Structure s(build_model(c, brick({1, 0.5, 0.2})), 1);
    const double dt = 1e-4;
    spin_up(s, {3, 5, 2}, dt);
    const double L0 = s.bodies()[0].moment_of_momentum()[1];
    march(s, dt, 2000);
    CHECK(s.bodies()[0].moment_of_momentum()[1] == Approx(L0 * std::exp(-5 * 0.2)).epsilon(1e-6));
}

TEST_CASE("a body that is not meshed apart, or that a support would hold, is refused in words") {
    Case c = two_solids(1e7, 1800);
    c.fem.block = FemBlock{{{0, 0, 0}, {1, 1, 1}}, {2, 2, 2}};
    Mesh mesh;
    add_block(mesh, "a", {{0, 0, 0}, {1, 1, 1}}, {2, 2, 2});
    mesh.volume_sets["half"] = {0, 1, 2, 3};
    c.fem.part = {{"a", "soil"}};
    c.fem.rigid = {{"lump", "half", {"z"}, 0, {}}};
    CHECK_THROWS_WITH(build_model(c, mesh), Catch::Contains("lump") &&
                                                Catch::Contains("also belongs to the deformable") &&
                                                Catch::Contains("0.5) m"));
    Case held = one_body({"x", "z", "ry"});
    held.fem.support = {{"body.ymin", {"y"}}};  // a plane of symmetry: the body keeps to it anyway
    const Model model = build_model(held, brick({1, 1, 1}));
    CHECK(model.supports[0].nodes.empty());
    held.fem.support = {{"body.zmin", {"z"}}};
    CHECK_THROWS_WITH(build_model(held, brick({1, 1, 1})),
                      Catch::Contains("fixes z of nodes of the rigid body"));
    Case flat = one_body();
    flat.info.dimension = 2;
    CHECK_THROWS_WITH(build_model(flat, brick({1, 1, 1})), Catch::Contains("x-z plane"));
}

}  // namespace
}  // namespace undertow::fem
