// Weight, stress at rest and static water.

#include "fem_solver/setup/ground.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "support.hpp"

namespace undertow::fem {
namespace {

Case clay(const std::array<int, 3>& divisions) {
    BlockCase block{{3, 2, 4}, divisions, 4.77e6, 0.49, 1846};
    Case c = block.settings();
    c.fem.block->box = {{0, 0, -4}, {3, 2, 0}};
    c.info.gravity = {0, 0, -9.81};
    c.fem.material[0].kind = MaterialKind::tresca;
    c.fem.material[0].shear_strength = 9540;
    c.fem.material[0].weight_density = 846;
    return c;
}

TEST_CASE("gravity acts on weight_density, inertia is that of density") {
    Case c = clay({2, 2, 2});
    Structure falling(build_model(c), 1);
    march(falling, 1e-3, 100);
    // leapfrog is exact for constant acceleration
    CHECK(falling.displacement(0)[2] == Approx(-0.5 * 9.81 * 846 / 1846 * 0.01).epsilon(1e-10));
    CHECK(falling.velocity(0)[2] ==
          Approx(-9.81 * 846 / 1846 * (0.1 - 1e-3)).epsilon(1e-10));  // at the last kick
    c.fem.support = {{"zmin", {"z"}}};
    c.fem.geostatic = FemGeostatic{"block", 0, 1};
    Structure held(build_model(c), 1);
    held.internal_forces();
    CHECK(held.reaction(held.model().supports[0])[2] == Approx(846 * 9.81 * 24).epsilon(1e-12));
    double mass = 0;
    for (double m : held.nodes().mass) mass += m;
    CHECK(mass == Approx(1846 * 24).epsilon(1e-12));
}

TEST_CASE("soil between smooth walls stays at rest in its geostatic stress") {
    Case c = clay({3, 2, 7});
    const double K0 = GENERATE(0.5, 1.0);
    c.fem.geostatic = FemGeostatic{"block", 0, K0};
    c.fem.support = {
        {"zmin", {"z"}}, {"xmin", {"x"}}, {"xmax", {"x"}}, {"ymin", {"y"}}, {"ymax", {"y"}}};
    Structure s(build_model(c), 1);
    march(s, s.stable_step().dt, 2000);
    const double settlement = 846 * 9.81 * 16 / (2 * 8.2e7);  // gamma H^2/(2 M) without it
    WARN("K0 " << K0 << ": drift after 2,000 steps " << s.largest_displacement() << " m");
    CHECK(s.largest_displacement() < 1e-11 * settlement);  // round-off of the stresses
    const std::vector<double> stress = s.elements().stress();
    CHECK(stress[2] == Approx(-846 * 9.81 * (4 - 2. / 7)).epsilon(1e-12));
    CHECK(stress[0] == Approx(K0 * stress[2]).epsilon(1e-12));
}

TEST_CASE("a geostatic stress that cannot be is refused") {
    Case c = clay({1, 1, 4});
    c.fem.geostatic = FemGeostatic{"block", -1, 1};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("hexahedron 4") && Catch::Contains("above"));
    c.fem.geostatic = FemGeostatic{"block", 0, 0.2};
    CHECK_THROWS_WITH(build_model(c),
                      Catch::Contains("earth_pressure") && Catch::Contains("shear_strength"));
    // 3.5 m down sigma_v = -29.05 kPa: K0 must leave |sigma_v - sigma_h| <= 2 s_u = 19.08 kPa
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("hexahedron 1 of") &&
                                          Catch::Contains("1.2179") && Catch::Contains("0.343"));
    FemMaterial& m = c.fem.material[0];
    m.kind = MaterialKind::j2;
    m.yield_stress = 15e3;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("1.549") && Catch::Contains("yield stress"));
    m.kind = MaterialKind::mohr_coulomb;
    m.friction_angle = 30;  // K0 from (1 - sin)/(1 + sin) = 1/3 to 3
    for (const double K0 : {0.34, 1.0, 2.99}) {
        c.fem.geostatic->earth_pressure = K0;
        CHECK_NOTHROW(build_model(c));
    }
    c.fem.geostatic->earth_pressure = 0.2;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("1.2 times") && Catch::Contains("0.333") &&
                                          Catch::Contains(" to 3 would do"));
    c.fem.geostatic->earth_pressure = 3.5;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("1.25 times"));
    m.cohesion = 5e3;  // and 2 c cos phi/(1 - sin phi) = 17.3 kPa on top of 3 sigma_v
    CHECK_NOTHROW(build_model(c));
    m.kind = MaterialKind::tresca;
    c.fem.geostatic = FemGeostatic{"block", 0, 1};
    c.info.gravity = {1, 0, -9.81};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("case.gravity"));
}

/// A block whose whole skin is coupled, under water with its surface at `level`.
Case submerged(double level) {
    Case c = clay({3, 3, 3});
    for (const char* set : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
        c.fem.surface.push_back({set, set});
    c.fem.water = FemWater{level, 1000};
    return c;
}

TEST_CASE("the static water on a closed surface weighs what it displaces, however bent") {
    Structure s(build_model(submerged(2.5)), 1);
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int d = 0; d < 3; ++d) nodes.x[n].c[d] += 0.1 * std::sin(7.0 * double(n) + d);
    double volume = 0;  // of the same facets: the work of a unit pressure in x
    for (const char* set : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) {
        PressureLoad unit(s.model().mesh.facet_sets.at(set), -1, 0);
        unit.evaluate(0, nodes.x);
        for (std::size_t i = 0; i < unit.load.node.size(); ++i)
            for (int d = 0; d < 3; ++d)
                volume += unit.load.force[i].c[d] * nodes.x[unit.load.node[i]].c[d] / 3;
    }
    const std::vector<double> none(3 * s.model().surface.node.size(), 0.0);
    s.contact_forces(none);
    double sum[3] = {};
    for (const NodeRow& f : nodes.f)
        for (int d = 0; d < 3; ++d) sum[d] += f.c[d];
    CHECK(std::abs(sum[0]) < 1e-8);  // of forces of 1e5 N: round-off
    CHECK(std::abs(sum[1]) < 1e-8);
    CHECK(sum[2] == Approx(-1000 * 9.81 * volume).epsilon(1e-12));
    CHECK(volume > 20);
}

TEST_CASE("static water takes off what an equal pressure puts on") {
    Case c = clay({4, 3, 1});
    c.fem.surface = {{"mud line", "zmax"}};
    c.fem.water = FemWater{2, 1000};
    c.fem.pressure = {{"zmax", 1000 * 9.81 * 2, 0}};
    Structure s(build_model(c), 1);
    const std::vector<double> none(3 * s.model().surface.node.size(), 0.0);
    s.pressure_forces(0);
    s.contact_forces(none);
    for (const NodeRow& f : s.nodes().f)
        for (int d = 0; d < 3; ++d) CHECK(std::abs(f.c[d]) < 1e-10);  // of 5e3 N
}

TEST_CASE("there is no static water above its level and without contact") {
    const auto largest = [](Structure& s, bool coupled) {
        const std::vector<double> none(3 * s.model().surface.node.size(), 0.0);
        s.contact_forces(coupled ? std::span<const double>(none) : std::span<const double>());
        double f = 0;
        for (const NodeRow& r : s.nodes().f) f = std::max(f, std::abs(r.c[2]));
        return f;
    };
    Structure dry(build_model(submerged(-4)), 1);
    CHECK(largest(dry, true) < 1e-9);
    Structure wet(build_model(submerged(1)), 1);
    CHECK(largest(wet, true) > 1e3);
    Structure alone(build_model(submerged(1)), 1);
    CHECK(largest(alone, false) == 0);
}

TEST_CASE("what still water presses beyond its hydrostatic pressure is balanced when let go") {
    Structure s(build_model(submerged(1)), 1);
    const std::size_t n = s.model().surface.node.size();
    std::vector<double> uneven(3 * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) uneven[3 * i + 2] = i % 2 == 0 ? -900.0 : -300.0;
    const auto clear = [&] { s.hold(); };
    for (int step = 0; step < 3; ++step) {
        clear();
        s.contact_forces(uneven);
        s.observe_still_water(1e-3);
    }
    s.let_go();
    clear();
    s.contact_forces(uneven);
    double largest = 0;
    for (const NodeRow& f : s.nodes().f) largest = std::max(largest, std::abs(f.c[2]));
    CHECK(largest < 1e-9);
    clear();
    uneven[2] -= 50;   // what comes on top is felt
    s.contact_forces(uneven);
    CHECK(s.nodes().f[s.model().surface.node[0]].c[2] == Approx(-50));
    CHECK(s.model().water->difference().nodal > 0);
}

TEST_CASE("the work of static water is in the energy balance") {
    Case c = submerged(2.5);
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    c.fem.geostatic = FemGeostatic{"block", 0, 1};
    Structure s(build_model(c), 1);
    const std::vector<double> none(3 * s.model().surface.node.size(), 0.0);
    const double dt = s.stable_step().dt;
    Energies e;
    for (int n = 0; n < 300; ++n) {
        s.internal_forces();
        s.contact_forces(none);
        s.kick(dt);
        e = s.energies();
        s.drift(dt);
    }
    CHECK(e.external > 10);
    // under a sudden load the kinetic energy starts at minus that of the first half kick
    CHECK(std::abs(e.balance_error()) < 0.02 * e.external);
}

TEST_CASE("one and two threads give the same bits on soil that flows and radiates") {
    Case c = clay({32, 32, 17});  // above 16384 elements: below, threads are not used
    c.fem.geostatic = FemGeostatic{"block", 0, 1};
    c.fem.absorbing = {{"zmin"}, {"xmax"}};
    Structure one(build_model(c), 1), two(build_model(c), 2);
    const double dt = one.stable_step().dt;
    for (Structure* s : {&one, &two}) {
        s->release_far_field();
        for (std::size_t n = 0; n < s->nodes().size(); ++n)
            s->nodes().v[n].c[0] = 2 * std::sin(4 * s->nodes().x[n].c[2]);
        march(*s, 0.8 * dt, 20);
    }
    CHECK(one.yielding_elements() > 1000);
    CHECK(one.yielding_elements() == two.yielding_elements());
    CHECK(std::memcmp(one.nodes().x.data(), two.nodes().x.data(),
                      one.nodes().size() * sizeof(NodeRow)) == 0);
    CHECK(one.energies().plastic == two.energies().plastic);
    CHECK(one.energies().far_field == two.energies().far_field);
}

}  // namespace
}  // namespace undertow::fem
