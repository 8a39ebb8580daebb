// The start: equilibrium before the first step, and the structure held until start.settle.

#include "fem_solver/settle.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "fem_solver/solver.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

/// A column of soil with a block on it, glued or as a rigid body.
Case column(bool rigid, Mesh& mesh) {
    Case c = two_solids(5e6, 1800);
    c.info.gravity = {0, 0, -9.81};
    add_block(mesh, "soil", {{0, 0, 0}, {0.6, 0.6, 1}}, {6, 6, 10});
    if (rigid) {
        add_block(mesh, "block", {{0, 0, 1.005}, {0.6, 0.6, 1.305}}, {3, 3, 1});
    } else {
        mesh = Mesh{};
        add_block(mesh, "all", {{0, 0, 0}, {0.6, 0.6, 1.3}}, {6, 6, 13});
        for (std::int32_t e = 0; e < 6 * 6 * 13; ++e)
            mesh.volume_sets[e < 360 ? "soil" : "block"].push_back(e);
        mesh.volume_sets.erase("all");
        mesh.facet_sets["soil.zmin"] = mesh.facet_sets["all.zmin"];
    }
    c.fem.part = {{"soil", "soil"}, {"block", "steel"}};
    c.fem.support = {{"soil.zmin", {"x", "y", "z"}}};
    if (!rigid) return c;
    c.fem.rigid = {{"block", "block", {"x", "y", "z", "rx", "ry", "rz"}, 0, {}}};
    FemContact contact;
    contact.name = "base";
    contact.nodes = "soil.zmax";
    contact.surface = "block.zmin";
    contact.friction = 0.6;
    contact.gap = 0.005;
    c.fem.contact = {contact};
    return c;
}

TEST_CASE("a rigid block settles on soil as one of stiff steel that is glued to it does") {
    Mesh apart, glued;
    Case a = column(true, apart);
    a.time.max_step = 2e-4;  // leaves room for springs of 10 E A/h
    Case b = column(false, glued);
    b.fem.material[1].young_modulus = 5e9;  // a thousand times the soil: stiff, and a step to match
    Structure rigid(build_model(a, apart), 1), stiff(build_model(b, glued), 1);
    const Settlement s = settle(rigid, {1e-3, 50000});
    const Settlement t = settle(stiff, {1e-3, 200000});
    REQUIRE(s.complete);
    REQUIRE(rigid.pairs()[0].softest() == Approx(10));
    // what the springs of the contact give way: weight over their sum, 1/10 of an element of ten
    const double weight = 7850 * 0.6 * 0.6 * 0.3 * 9.81;
    const double springs = weight / (10 * 5e6 * 0.36 / 0.1);
    const double u = -s.body_displacement[0][2] - springs;
    WARN("settlement: rigid " << u << " m (" << s.steps << " steps, " << s.stops
                              << " stops; springs of contact take " << springs
                              << " m), glued steel " << t.largest_displacement << " m (" << t.steps
                              << " steps)");
    // glued steel holds the soil's top sideways as friction 0.6 does
    CHECK(u == Approx(t.largest_displacement).epsilon(0.02));
    CHECK(s.residual <= 1e-3 * s.reference);
    CHECK(rigid.pairs()[0].totals().normal_force == Approx(weight).epsilon(1e-3));
    // everything counts from here, and stays
    CHECK(rigid.largest_displacement() == 0);
    CHECK(rigid.energies().kinetic == 0);
    march(rigid, rigid.stable_step().dt, 2000);
    CHECK(rigid.largest_displacement() < 1e-3 * u);
    CHECK(std::abs(rigid.bodies()[0].contact().force[2]) < 2e-3 * weight);
}

TEST_CASE("a small bucket in soil finds its equilibrium by itself") {
    // a box-shaped bucket, half of it: skirt of 20 mm, soil 5 mm off both faces
    Case c = two_solids(5e6, 1846);
    c.fem.material[1].weight_density = 2000;
    c.info.gravity = {0, 0, -9.81};
    c.time.max_step = 2e-4;  // leaves room for springs of 10 E A/h
    Mesh mesh;
    // planar slice 0.1 m thick: skirts at x = -0.5 and 0.5 joined by a lid
    // and reaching 0.1 m below the soil, so that nothing but friction carries it
    const double h = 0.01, g = 0.005, d = -0.4, b = -0.3;
    add_block(mesh, "left", {{-0.5 - h, 0, d}, {-0.5 + h, 0.1, 0.1}}, {1, 1, 5});
    add_block(mesh, "right", {{0.5 - h, 0, d}, {0.5 + h, 0.1, 0.1}}, {1, 1, 5});
    add_block(mesh, "plug", {{-0.5 + h + g, 0, b}, {0.5 - h - g, 0.1, 0}}, {10, 1, 3});
    add_block(mesh, "west", {{-1.2, 0, b}, {-0.5 - h - g, 0.1, 0}}, {7, 1, 3});
    add_block(mesh, "east", {{0.5 + h + g, 0, b}, {1.2, 0.1, 0}}, {7, 1, 3});
    for (const char* part : {"left", "right"})
        for (std::int32_t e : mesh.volume_sets[part]) mesh.volume_sets["bucket"].push_back(e);
    for (const char* part : {"plug", "west", "east"})
        for (std::int32_t e : mesh.volume_sets[part]) mesh.volume_sets["soil"].push_back(e);
    const auto gather = [&](const char* set, std::initializer_list<const char*> sides) {
        for (const char* side : sides)
            for (const Quad& q : mesh.facet_sets[side]) mesh.facet_sets[set].push_back(q);
    };
    gather("skin",
           {"left.xmin", "left.xmax", "left.zmin", "right.xmin", "right.xmax", "right.zmin"});
    gather("walls", {"plug.xmin", "plug.xmax", "west.xmax", "east.xmin"});
    gather("bottom", {"plug.zmin", "west.zmin", "east.zmin"});
    c.fem.part = {{"bucket", "steel"}, {"soil", "soil"}};
    c.fem.rigid = {{"bucket", "bucket", {"x", "z", "ry"}, 0, {}}};
    c.fem.support = {
        {"bottom", {"x", "y", "z"}}, {"west.xmin", {"x"}}, {"east.xmax", {"x"}}, {"soil", {"y"}}};
    FemContact contact;
    contact.name = "skirt";
    contact.nodes = "walls";
    contact.surface = "skin";
    contact.friction = 0.6;
    contact.gap = g;
    c.fem.contact = {contact};
    Structure s(build_model(c, mesh), 1);
    const Settlement found = settle(s, {1e-3, 50000});
    REQUIRE(found.complete);
    const double weight = 2000 * 2 * 0.02 * 0.5 * 0.1 * 9.81;
    const ContactTotals& sum = s.pairs()[0].totals();
    WARN("bucket: " << found.steps << " steps, " << found.stops << " stops, settles "
                    << -found.body_displacement[0][2] << " m; " << sum.touching << " nodes touch, "
                    << sum.slipping << " slip; friction " << sum.friction[2] << " N of weight "
                    << weight << " N");
    CHECK(found.body_residual <= 1e-3);
    CHECK(sum.friction[2] == Approx(-weight).epsilon(1e-3));  // it hangs on its friction
    CHECK(std::abs(s.bodies()[0].rotation()[1]) < 1e-9);      // and stands upright: symmetry
    // for good: nothing creeps in 2,000 steps
    march(s, s.stable_step().dt, 2000);
    CHECK(std::abs(s.bodies()[0].displacement()[2]) <
          1e-3 * std::abs(found.body_displacement[0][2]));
}

TEST_CASE("ground that never settles ends in a sentence that says how far it came") {
    Mesh mesh;
    Case c = column(true, mesh);
    c.fem.support.clear();  // it falls
    Structure s(build_model(c, mesh), 1);
    CHECK_THROWS_WITH(settle(s, {1e-3, 50}), Catch::Contains("no equilibrium after 50 steps") &&
                                                 Catch::Contains("fem.settle.max_steps"));
    CHECK_THROWS_AS(settle(s, {1e-3, 50}), PhysicsError);
}

TEST_CASE("until start.settle the structure does not move, then it goes free") {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("undertow-settle-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    BlockCase block{{0.1, 0.1, 0.1}, {2, 2, 2}};
    Case c = block.settings();
    c.info.gravity = {0, 0, -9.81};
    c.start.settle = 0.01;
    c.time.end = 0.03;
    c.output.fields_every = 0.005;
    Structure structure(build_model(c), 1);
    {
        const auto link = run_alone(c);
        Output output(folder.string(), c, structure);
        ProgressLine line(true, "");
        CHECK(Solver(c, structure, *link, output, line).run());
    }
    std::filesystem::remove_all(folder);
    // outputs every 5 ms: a step lands on 10 ms, so it falls for 20 ms exactly
    CHECK(structure.displacement(0)[2] == Approx(-0.5 * 9.81 * 0.02 * 0.02).epsilon(1e-10));
}

}  // namespace
}  // namespace undertow::fem
