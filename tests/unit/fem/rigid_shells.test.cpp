// Rigid bodies of shells: weight, turning, both faces coupled, and a block that slides on a plate.

#include <catch2/catch.hpp>
#include <cmath>

#include "fem_solver/settle.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

FemPart steel_shell(const std::string& set, double thickness) {
    FemPart part{set, "steel", ElementFormulation::shell};
    part.thickness = thickness;
    return part;
}

/// A closed cube of side 1 about the origin, its shells looking outward.
Mesh cube(int n) {
    Mesh mesh;
    const double h = 0.5;
    add_sheet(mesh, "box", {-h, -h, -h}, {0, 1, 0}, {1, 0, 0}, n);
    add_sheet(mesh, "box", {-h, -h, h}, {1, 0, 0}, {0, 1, 0}, n);
    add_sheet(mesh, "box", {-h, -h, -h}, {1, 0, 0}, {0, 0, 1}, n);
    add_sheet(mesh, "box", {-h, h, -h}, {0, 0, 1}, {1, 0, 0}, n);
    add_sheet(mesh, "box", {-h, -h, -h}, {0, 0, 1}, {0, 1, 0}, n);
    add_sheet(mesh, "box", {h, -h, -h}, {0, 1, 0}, {0, 0, 1}, n);
    return mesh;
}

TEST_CASE("a rigid box of shells falls and turns as its mass and its moment of inertia say") {
    const double t = 0.01, m = 7850 * 6 * t, extra = 200;
    Case c = two_solids(1e7, 2000);
    c.info.gravity = {0, 0, -9.81};
    c.fem.part = {steel_shell("box", t)};
    // mass without weight off the center: gravity pulls at the shells' center, so the box turns
    c.fem.rigid = {{"box", "box", {"x", "y", "z", "rx", "ry", "rz"}, extra, {0.5, 0, 0}}};
    const bool coupled = GENERATE(false, true);
    if (coupled) c.fem.surface = {{"hull", "box"}};
    const int n = 8;
    const Mesh mesh = cube(n);
    check_mesh(mesh);
    Structure s(build_model(c, mesh), 1);
    const RigidBody& body = s.bodies()[0];
    CHECK(body.mass() == Approx(m + extra).epsilon(1e-12));
    const double total = m + extra, off = extra * 0.5 / total;
    CHECK(body.center()[0] == Approx(off).epsilon(1e-12));

    // of a thin cube 5/18 m L^2 about its center; lumped on n x n shells a side, 1/(6 n^2) of the
    // in-plane part more, and t^2/4 of the faces
    const double about_y = 5.0 / 18 * m + m * off * off + extra * std::pow(0.5 - off, 2);
    const double turning = m * 9.81 * off / about_y;
    const double dt = 1e-4;
    const int steps = 1000;
    Energies e;
    double started = 0;
    march(s, dt, steps, [&](int n) {
        e = s.energies();
        if (n == 1) started = e.balance_error();
    });
    const double time = steps * dt;
    CHECK(body.displacement()[2] ==
          Approx(-0.5 * 9.81 * m / total * time * time).epsilon(2e-3));  // half kick at the start
    const double angle = 0.5 * turning * time * time;  // about -y: the light side falls
    CHECK(body.rotation()[1] == Approx(-angle).epsilon(0.01));
    CHECK(std::abs(e.balance_error() - started) < 1e-6 * e.kinetic);
    if (!coupled) return;

    const CoupledSurface& surface = s.model().surface;
    CHECK(surface.quad.size() == 2 * 6 * n * n);
    CHECK(surface.offset.empty());  // faces are nodes of the body
    double mass = 0, farthest = 0, nearest = 1e9;
    for (std::size_t i = 0; i < surface.node.size(); ++i) {
        mass += s.surface_mass(i);
        const std::int32_t k = surface.node[i];
        double reach = 0;
        for (int d = 0; d < 3; ++d) reach = std::max(reach, std::abs(s.model().mesh.x[k][d]));
        farthest = std::max(farthest, reach);
        nearest = std::min(nearest, reach);
    }
    CHECK(mass == Approx(m).epsilon(1e-12));
    CHECK(farthest == Approx(0.5 + t / 2));
    CHECK(nearest == Approx(0.5 - t / 2));
}

TEST_CASE("a force on one face of a rigid plate of shells turns it about its middle") {
    Case c = two_solids(1e7, 2000);
    c.fem.part = {steel_shell("plate", 0.1)};
    c.fem.rigid = {{"plate", "plate", {"x", "y", "z", "rx", "ry", "rz"}, 0, {}}};
    c.fem.surface = {{"plate", "plate"}};
    Mesh mesh;
    add_sheet(mesh, "plate", {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, 2);
    Structure s(build_model(c, mesh), 1);
    // friction along x on all of the upper face: force 1 N, moment t/2 about y
    const CoupledSurface& surface = s.model().surface;
    std::vector<double> f(3 * surface.node.size(), 0.0);
    double pushed = 0;
    for (std::size_t i = 0; i < surface.node.size(); ++i)
        if (s.model().mesh.x[surface.node[i]][2] > 0) ++pushed;
    CHECK(pushed == 9);
    for (std::size_t i = 0; i < surface.node.size(); ++i)
        if (s.model().mesh.x[surface.node[i]][2] > 0) f[3 * i] = 1 / pushed;
    s.internal_forces();
    s.contact_forces(f);
    const Wrench load = s.bodies()[0].load(s.nodes());
    CHECK(load.force[0] == Approx(1));
    CHECK(load.moment[1] == Approx(0.05));
    CHECK(std::abs(load.moment[0]) + std::abs(load.moment[2]) < 1e-15);
}

TEST_CASE("a block slides down a rigid plate of shells, on either of its faces") {
    // tan theta = 0.5, mu = 0.328: 1.5092 m/s2
    const double side = GENERATE(1.0, -1.0);
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "block", {{-0.2, -0.2, 0}, {0.2, 0.2, 0.2}}, {4, 4, 2});
    // 10 mm below the block lies the face of a plate 40 mm thick, its shells looking up or down
    if (side > 0)
        add_sheet(mesh, "plate", {-2, -1, -0.03}, {4, 0, 0}, {0, 2, 0}, 10);
    else
        add_sheet(mesh, "plate", {-2, -1, -0.03}, {0, 2, 0}, {4, 0, 0}, 10);
    c.fem.part = {{"block", "soil"}, steel_shell("plate", 0.04)};
    c.fem.rigid = {{"plate", "plate", {}, 0, {}}};
    FemContact contact;
    contact.name = "sole";
    contact.nodes = "block.zmin";
    contact.surface = "plate";
    contact.friction = 0.328;
    contact.gap = 0.01;
    c.fem.contact = {contact};
    const double theta = std::atan(0.5), g = 9.81;
    c.info.gravity = {0, 0, -g * std::cos(theta)};
    Structure s(build_model(c, mesh), 1);
    REQUIRE(s.pairs().size() == 1);
    CHECK(s.pairs()[0].nodes_near() == 25);
    settle(s, {1e-6, 20000});
    set_gravity(s, {g * std::sin(theta), 0, -g * std::cos(theta)});
    const double dt = 0.9 * s.stable_step().dt;
    const auto mean_speed = [&] {
        double momentum = 0, mass = 0;
        for (std::int32_t n : s.model().mesh.nodes_of("block", "test")) {
            momentum += s.nodes().mass[n] * s.nodes().v[n].c[0];
            mass += s.nodes().mass[n];
        }
        return momentum / mass;
    };
    double v1 = 0, t1 = 0, v2 = 0, t2 = 0;
    const int steps = int(0.5 / dt);
    march(s, dt, steps, [&](int n) {
        const double when = double(n) / steps;
        if (when > 0.2 && when <= 0.4) v1 += mean_speed(), t1 += 1;
        if (when > 0.8) v2 += mean_speed(), t2 += 1;
    });
    const double a = (v2 / t2 - v1 / t1) / (0.6 * steps * dt);
    const double exact = g * (std::sin(theta) - 0.328 * std::cos(theta));
    WARN("block on shells: " << a << " m/s2, exact " << exact);
    CHECK(a == Approx(exact).epsilon(0.005));
}

TEST_CASE("rigid shells that look against each other are refused as one surface") {
    Case c = two_solids(1e7, 2000);
    c.fem.part = {steel_shell("plate", 0.1)};
    c.fem.rigid = {{"plate", "plate", {"x", "y", "z", "rx", "ry", "rz"}, 0, {}}};
    c.fem.surface = {{"plate", "plate"}};
    Mesh mesh;
    add_sheet(mesh, "plate", {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1);
    add_sheet(mesh, "plate", {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, 1);
    CHECK_THROWS_WITH(build_model(c, mesh),
                      Catch::Contains("fem.surface") && Catch::Contains("look against each other"));
}

}  // namespace
}  // namespace undertow::fem
