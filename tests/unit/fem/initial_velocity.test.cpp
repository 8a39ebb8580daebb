// Velocities at the start: free flight, a swinging bar, what is held, rigid bodies.

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);

void fly(Structure& s, double dt, int steps) {
    s.launch();
    march(s, dt, steps);
}

TEST_CASE("a block thrown with a spin flies on as it was thrown") {
    Case c = BlockCase{{0.4, 0.3, 0.2}, {4, 3, 2}, 1e9, 0.3, 2000}.settings();
    const Vec3 spin{0.5, -1, 2}, velocity{3, 1, -2}, center{0.2, 0.15, 0.1};  // about its center
    FemInitialVelocity thrown;
    thrown.set = "block";
    thrown.velocity = velocity;
    thrown.spin = spin;
    thrown.center = center;
    c.fem.initial_velocity = {thrown};
    Structure s(build_model(c), 1);
    const double dt = 0.5 * s.stable_step().dt;
    const int steps = 2000;
    fly(s, dt, steps);
    const Nodes& nodes = s.nodes();
    double mass = 0, momentum[3] = {}, turning[3] = {}, place[3] = {};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        mass += nodes.mass[i];
        for (int d = 0; d < 3; ++d) {
            const int d1 = (d + 1) % 3, d2 = (d + 2) % 3;
            momentum[d] += nodes.mass[i] * nodes.v[i].c[d];
            place[d] += nodes.mass[i] * nodes.x[i].c[d];
            turning[d] +=
                nodes.mass[i] *
                ((nodes.x[i].c[d1] - center[d1] - velocity[d1] * dt * steps) * nodes.v[i].c[d2] -
                 (nodes.x[i].c[d2] - center[d2] - velocity[d2] * dt * steps) * nodes.v[i].c[d1]);
        }
    }
    // of the lumped masses: eighths at the corners of cells of 0.1 m, sum m y^2
    const auto second = [](double length) { return length * length / 12 + 0.01 / 6; };
    const double of[3] = {second(0.4), second(0.3), second(0.2)};
    for (int d = 0; d < 3; ++d) {
        CHECK(momentum[d] / mass == Approx(velocity[d]).epsilon(1e-12));
        CHECK(place[d] / mass == Approx(center[d] + velocity[d] * dt * steps).epsilon(1e-11));
        const double inertia = mass * (of[(d + 1) % 3] + of[(d + 2) % 3]);
        CHECK(turning[d] == Approx(inertia * spin[d]).epsilon(1e-9));
    }
    const Energies e = s.energies();
    double start = 0;
    for (int d = 0; d < 3; ++d)
        start +=
            0.5 * mass *
            (velocity[d] * velocity[d] + (of[(d + 1) % 3] + of[(d + 2) % 3]) * spin[d] * spin[d]);
    CHECK(e.start == Approx(start).epsilon(1e-12));
    CHECK(std::abs(e.balance_error()) < 1e-8 * start);
}

TEST_CASE("a bar given the velocities of its first mode swings in it") {
    const double L = 1, E = 1e9, rho = 1000, v0 = 1e-3;
    Case c = BlockCase{{L, 0.02, 0.02}, {50, 1, 1}, E, 0, rho}.settings();
    c.fem.support = {{"xmin", {"x"}}};
    FemInitialVelocity given;
    given.set = "block";
    for (const char* formula : {"1e-3*sin(pi*x/2)", "0", "0"})
        given.formulas.emplace_back(formula, "xyz", "test");
    c.fem.initial_velocity = {given};
    Structure s(build_model(c), 1);
    const double omega = 0.5 * pi * std::sqrt(E / rho) / L, quarter = 0.5 * pi / omega;
    const int steps = int(std::ceil(quarter / (0.3 * s.stable_step().dt)));
    fly(s, quarter / steps, steps);
    const std::int32_t tip = nearest_node(s.model().mesh, {L, 0, 0});
    CHECK(s.displacement(tip)[0] == Approx(v0 / omega).epsilon(1e-3));
    CHECK(std::abs(s.energies().kinetic) < 1e-4 * s.energies().start);
    CHECK(s.nodes().v[0].c[0] == 0);  // the support
    CHECK(std::abs(s.energies().balance_error()) < 1e-6 * s.energies().start);
}

TEST_CASE("a rigid body is thrown where it is free") {
    Case c = BlockCase{{0.4, 0.3, 0.2}, {2, 2, 2}, 1e9, 0.3, 2000}.settings();
    c.fem.rigid = {{"stone", "block", {"x", "z", "ry"}, 5, {0.2, 0.15, 0.1}}};
    FemInitialVelocity thrown;
    thrown.rigid = "stone";
    thrown.velocity = {2, 1, -3};
    thrown.spin = {1, 4, 1};
    c.fem.initial_velocity = {thrown};
    Structure s(build_model(c), 1);
    const double dt = 1e-4;
    fly(s, dt, 1000);
    const RigidBody& stone = s.bodies()[0];
    CHECK(stone.displacement()[0] == Approx(0.2).epsilon(1e-12));
    CHECK(stone.displacement()[1] == 0);
    CHECK(stone.displacement()[2] == Approx(-0.3).epsilon(1e-12));
    CHECK(stone.rotation()[1] == Approx(0.4).epsilon(1e-9));
    CHECK(stone.rotation()[0] == 0);
    CHECK(s.energies().kinetic == Approx(s.energies().start).epsilon(1e-9));
    CHECK(s.energies().start > 0.5 * stone.mass() * 13);
    // about another point: the center moves as well
    c.fem.initial_velocity[0].has_center = true;
    c.fem.initial_velocity[0].center = {0.2, 0, 0};  // 0.1 m below its center
    CHECK(build_model(c).initial_velocities.bodies[0].velocity[0] == Approx(2 + 4 * 0.1 - 0.15));
}

TEST_CASE("shells that spin keep turning") {
    Case c = BlockCase{{0.4, 0.2, 0}, {4, 2, 0}, 1e9, 0.3, 2000}.settings();
    c.fem.block->cells = BlockCells::shells;
    c.fem.part[0].element = ElementFormulation::shell;
    c.fem.part[0].thickness = 0.02;
    FemInitialVelocity thrown;
    thrown.set = "block";
    thrown.spin = {0, 3, 0};
    thrown.center = {0.2, 0.1, 0};
    c.fem.initial_velocity = {thrown};
    Structure s(build_model(c), 1);
    fly(s, 0.5 * s.stable_step().dt, 1000);
    const Energies e = s.energies();
    // centrifugal strains swing, rotations of nodes go along: without theirs a third of the
    // bending would be left to find
    CHECK(e.internal < 1e-4 * e.start);
    CHECK(std::abs(e.balance_error()) < 1e-6 * e.start);
}

TEST_CASE("velocities that cannot be are refused by name") {
    Case c = BlockCase{{0.4, 0.3, 0.2}, {2, 2, 2}, 1e9, 0.3, 2000}.settings();
    FemInitialVelocity given, other;
    given.set = "block";
    given.velocity = {1, 0, 0};
    other.set = "xmin";
    other.velocity = {2, 0, 0};
    c.fem.initial_velocity = {given, other};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("another velocity"));
    c.fem.initial_velocity[1].velocity = {1, 0, 0};
    CHECK_NOTHROW(build_model(c));
    c.start.settle = 0.1;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("start.settle = 0.1 s"));
    c.start.settle = 0;
    c.fem.rigid = {{"stone", "block", {"x"}, 0, {}}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("rigid body; name the body"));
}

}  // namespace
}  // namespace undertow::fem
