// Kick and drift in one pass over the nodes: what comes out is that of the two passes, to the bit.

#include <catch2/catch.hpp>
#include <cstring>

#include "support.hpp"
#include "two_solids.hpp"

namespace undertow::fem {
namespace {

/// A block with more nodes than one block of the nodal loop, damped, loaded, held below.
Case loaded_block(std::array<int, 3> divisions) {
    BlockCase block{{1, 1, 1}, divisions, 1e7, 0.3, 1800};
    Case c = block.settings();
    c.info.gravity = {0.3, 0, -9.81};
    c.fem.damping_alpha = 5;
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 2e3, 0}};
    return c;
}

/// Its top is told to move sideways.
FemMotion shaken() {
    FemMotion motion;
    motion.name = "drive";
    motion.set = "zmax";
    motion.directions = {"x"};
    for (const char* formula : {"1e-3*sin(300*t)", "0", "0"})
        motion.displacement.emplace_back(formula, "t", "test");
    return motion;
}

enum class Others { none, motion, far_field, stiffness_damping };

Case scene(Others others) {
    Case c = loaded_block({16, 16, 16});
    if (others == Others::motion) c.fem.motion = {shaken()};
    if (others == Others::far_field) {
        c.fem.support = {{"xmin", {"x", "y", "z"}}};
        c.fem.absorbing = {{"zmin", {}}};
    }
    if (others == Others::stiffness_damping) c.fem.damping_beta = 1e-5;
    return c;
}

/// `move(structure, dt)` ends each of the steps, which vary.
template <class Move>
void march_by(Structure& s, int steps, Move&& move) {
    s.release_far_field();
    const double dt = 0.8 * s.stable_step().dt;
    double t = 0;
    for (int n = 0; n < steps; ++n) {
        const double step = n % 3 == 0 ? 0.7 * dt : dt;
        s.stable_step();
        s.internal_forces();
        s.pressure_forces(t);
        move(s, step);
        t += step;
    }
}

bool same(const NodeRows& a, const NodeRows& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(NodeRow)) == 0;
}

void check_same(const Model& model, int threads, int steps) {
    Structure two(model, 1), one(model, threads);
    march_by(two, steps, [](Structure& s, double dt) {
        s.kick(dt);
        s.drift(dt);
    });
    march_by(one, steps, [](Structure& s, double dt) { s.advance(dt); });
    REQUIRE(two.nodes().size() > 4096);
    CHECK(same(one.nodes().x, two.nodes().x));
    CHECK(same(one.nodes().v, two.nodes().v));
    CHECK(same(one.nodes().f, two.nodes().f));
    const Energies a = one.energies(), b = two.energies();
    CHECK(std::memcmp(&a, &b, sizeof a) == 0);
    CHECK(a.kinetic > 0);
    CHECK(one.largest_displacement() > 0);
}

TEST_CASE("one pass over the nodes moves them as two do, whatever else moves them") {
    const Others others =
        GENERATE(Others::none, Others::motion, Others::far_field, Others::stiffness_damping);
    check_same(build_model(scene(others)), 1, 12);
}

TEST_CASE("one pass over the nodes leaves a rigid body its forces") {
    Case c = two_solids(1e7, 1800);
    c.info.gravity = {0.5, 0, -9.81};
    c.fem.part = {{"soil", "soil"}, {"body", "steel"}};
    c.fem.rigid = {{"body", "body", {"x", "y", "z", "rx", "ry", "rz"}, 0, {}}};
    c.fem.support = {{"soil.zmin", {"x", "y", "z"}}};
    c.fem.contact = {{.name = "rest",
                      .nodes = "soil.zmax",
                      .surface = "body.zmin",
                      .friction = 0.3,
                      .gap = 0.002}};
    c.fem.pressure = {{"body.zmax", 2e3, 0}};
    Mesh mesh;  // the body in the middle of the soil's top, a gap above it
    add_block(mesh, "soil", {{0, 0, 0}, {1, 1, 0.5}}, {20, 20, 9});
    add_block(mesh, "body", {{0.3, 0.3, 0.502}, {0.7, 0.7, 0.7}}, {6, 6, 3});
    check_same(build_model(c, mesh), 1, 12);
}

TEST_CASE("one pass over the nodes gives the same bits with one and two threads") {
    Case c = loaded_block({26, 26, 26});  // above 16384 elements: below, threads are not used
    c.fem.motion = {shaken()};
    check_same(build_model(c), 2, 4);
}

}  // namespace
}  // namespace undertow::fem
