// Plates thinner than a particle, wet on both sides; walls that close; a start inside the surface.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "scene.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;

namespace {

/// Two faces t apart, wet outward: the upper at z = 0, the lower at z = -t. n x n quads each.
Nodes two_faces(int n, double size, double t, double m) {
    Nodes plate = flat_plate(n, n, size, m);
    const std::size_t nodes = plate.mass.size(), quads = plate.quad.size();
    for (std::size_t a = 0; a < nodes; ++a) {
        plate.x.insert(plate.x.end(), {plate.x[3 * a], plate.x[3 * a + 1], -t});
        plate.v.insert(plate.v.end(), {0, 0, 0});
        plate.mass.push_back(m);
    }
    for (std::size_t q = 0; q < quads; q += 4)
        for (int k : {0, 3, 2, 1}) plate.quad.push_back(plate.quad[q + k] + std::int32_t(nodes));
    return plate;
}

/// Facing walls, wet sides inward, `gap` apart: z = 0 and z = gap.
Nodes facing_walls(int n, double size, double gap) {
    return two_faces(n, size, -gap, 1e9);
}

/// Both faces are one rigid sheet: the nodes of a pair get their common velocity.
void tie(Nodes& plate, double t) {
    const std::size_t half = plate.x.size() / 2;
    for (std::size_t i = 0; i < half; ++i) {
        const double v = 0.5 * (plate.v[i] + plate.v[half + i]),
                     x = 0.5 * (plate.x[i] + plate.x[half + i]);
        plate.v[i] = plate.v[half + i] = v;
        const double off = i % 3 == 2 ? 0.5 * t : 0;
        plate.x[i] = x + off, plate.x[half + i] = x - off;
    }
}

void move_to(PenaltyContact& contact, const Nodes& nodes, const std::vector<double>& x) {
    const std::vector<double> v{0, 0, 0};
    contact.update(x, v, nodes.x, nodes.v);
    contact.compute_forces(1e-4);
    contact.settle();
}

}  // namespace

TEST_CASE("a particle remembers from which side it came through a thin plate") {
    const double l0 = 0.1, t = 0.04;
    const Nodes plate = two_faces(4, 0.25, t, 1);
    Particles particles;
    particles.add({0.4, 0.6, 0.5 * l0}, {0, 0, 0}, 1, l0, 1);
    PenaltyContact contact(plate.surface(), {});
    contact.rebuild(particles.points(), 1, plate.x, plate.v);
    contact.compute_forces(1e-4);
    contact.settle();
    // Past the middle of the plate, and out on the other side.
    for (double z : {0.1 * l0, -0.1 * l0, -0.3 * l0, -0.5 * l0, -0.9 * l0}) {
        move_to(contact, plate, {0.4, 0.6, z});
        CAPTURE(z);
        REQUIRE(contact.contacts().size() == 1);
        CHECK(contact.contacts()[0].normal[2] == Approx(1));
        CHECK(contact.contacts()[0].depth == Approx(l0 - z));
    }
    // A search in between forgets nothing.
    particles.x = {0.4, 0.6, -0.9 * l0};
    contact.rebuild(particles.points(), 1, plate.x, plate.v);
    REQUIRE(contact.contacts().size() == 1);
    CHECK(contact.contacts()[0].normal[2] == Approx(1));
    // Whoever was free has no side: what is found below now came from below.
    contact.compute_forces(1e-4);
    contact.settle();
    move_to(contact, plate, {0.4, 0.6, -3 * l0});
    CHECK(contact.contacts().empty());
    move_to(contact, plate, {0.4, 0.6, -t - 0.5 * l0});
    REQUIRE(contact.contacts().size() == 1);
    CHECK(contact.contacts()[0].normal[2] == Approx(-1));
}

TEST_CASE("between a floor and a thin plate above it a particle is pushed by both") {
    // The upper face of the plate looks the same way as the floor and sees the particle from
    // behind: it was not passed.
    const double l0 = 0.1, t = 0.01, gap = 0.17;
    Nodes scene = two_faces(4, 0.25, t, 1);
    const Nodes floor = flat_plate(4, 4, 0.25, 1);
    const std::int32_t first = std::int32_t(scene.mass.size());
    for (std::size_t i = 0; i < floor.x.size(); ++i)
        scene.x.push_back(floor.x[i] - (i % 3 == 2 ? gap + t : 0));
    scene.v.resize(scene.x.size(), 0);
    scene.mass.resize(scene.x.size() / 3, 1);
    for (std::int32_t node : floor.quad) scene.quad.push_back(first + node);
    Particles particles;
    particles.add({0.4, 0.6, -t - gap + 0.08}, {0, 0, 0}, 1, l0, 1);
    PenaltyContact contact(scene.surface(), {});
    contact.rebuild(particles.points(), 1, scene.x, scene.v);
    for (double height :
         {0.08, 0.085, 0.09, 0.095}) {  // the upper face is within reach: 0.1 - 0.085
        move_to(contact, scene, {0.4, 0.6, -t - gap + height});
        CAPTURE(height);
        REQUIRE(contact.contacts().size() == 2);
        CHECK(contact.contacts()[0].normal.dot(contact.contacts()[1].normal) == Approx(-1));
    }
}

TEST_CASE("at 50 m/s nothing tunnels through a plate of 1 mm, wet on both sides") {
    // Particles of 10 mm from above and from below, oblique, on the largest steps that contact
    // grants; a fluid that is soft enough (c0 = 2 v) sinks in by a quarter of a spacing and more.
    const double dx = 0.01, l0 = dx / 2, t = 1e-3, rho = 1000, m = rho * dx * dx * dx, v = 50;
    std::mt19937 random(41);
    std::uniform_real_distribution<double> any(-1, 1);
    double deepest = 0;
    int crossed = 0;
    for (const StiffnessKind kind : {StiffnessKind::fluid, StiffnessKind::eq11})
        for (double node_mass : {0.2 * m, 2 * m, 1e3 * m})
            for (int run = 0; run < 20; ++run) {
                LawSettings law;
                law.stiffness = kind;
                const double c0 = 2 * v, tilt = 0.5 * any(random);
                Particles particles;
                for (const double side : {1.0, -1.0})
                    particles.add({0.05 + 0.01 * any(random), 0.05 + 0.01 * any(random),
                                   -0.5 * t + side * (0.5 * t + l0 * (1.5 + 0.5 * any(random)))},
                                  {v * std::sin(tilt), 0, -side * v * std::cos(tilt)}, m, l0,
                                  rho * c0 * c0 * dx);
                World world(two_faces(10, 0.01, t, node_mass), particles, law);
                double dt = 0.25 * l0 / v;
                // The impact takes ten steps; later the nodes of the light sheet, which nothing
                // holds together in its plane, have torn it.
                for (int n = 0; n < 30; ++n) {
                    if (n > 0) dt = std::min(1.05 * dt, world.contact.step_limit());
                    world.step(dt);
                    tie(world.nodes, t);
                    for (const Contact& c : world.contact.contacts())
                        deepest = std::max(deepest, c.depth / l0);
                    // Swept: each stays on the wet side of its own face.
                    Surface surface = world.nodes.surface();
                    surface.move(world.nodes.x, world.nodes.v);
                    const std::uint32_t half = std::uint32_t(surface.facets() / 2);
                    for (std::uint32_t i = 0; i < 2; ++i) {
                        const Vec x = Vec::Map(&world.particles.x[3 * i]);
                        double distance = 1e300, height = 0;
                        for (std::uint32_t f = i * half; f < (i + 1) * half; ++f) {
                            const Foot foot = closest_point(x, surface.shape(f));
                            const double h = foot.offset.dot(foot.normal);
                            // On a shared edge the facet that is faced most squarely tells.
                            const bool tied = std::abs(foot.distance - distance) < 1e-9 * l0;
                            if (tied ? std::abs(h) > std::abs(height) : foot.distance < distance)
                                distance = foot.distance, height = h;
                        }
                        // Farther off, a torn sheet may show its back: nobody touches it there.
                        if (distance < l0 && !(height > 0)) ++crossed;
                    }
                }
            }
    CAPTURE(deepest);
    CHECK(crossed == 0);
    CHECK(deepest < 1);  // no center reached its face
}

TEST_CASE("walls that close on a particle hold it between them") {
    // Rigid walls come together at 2 x 5 m/s down to a gap of 1.2 l0, and part again.
    const double l0 = 0.005, m = 1e-3, wall = 5;
    for (const StiffnessKind kind : {StiffnessKind::fluid, StiffnessKind::eq11}) {
        LawSettings law;
        law.stiffness = kind;
        Particles particles;
        particles.add({0.05, 0.05, 1.3 * l0}, {1, 0, 3}, m, l0, 1000 * 50 * 50 * 0.01);
        World world(facing_walls(10, 0.01, 2.8 * l0), particles, law);
        world.nodes_fixed = true;
        const std::size_t half = world.nodes.x.size() / 2;
        double gap = 2.8 * l0, fastest = 0;
        for (int n = 0; n < 400; ++n) {
            const double dt = n == 0 ? 1e-5 : std::min(1e-5, world.contact.step_limit());
            const double closing = n < 200 && gap > 1.2 * l0 ? wall : (n < 200 ? 0 : -wall);
            for (std::size_t i = 2; i < world.nodes.x.size(); i += 3)
                world.nodes.v[i] = i < half ? closing : -closing;
            world.step(dt);
            for (std::size_t i = 2; i < world.nodes.x.size(); i += 3)
                world.nodes.x[i] += dt * world.nodes.v[i];
            gap = world.nodes.x[half + 2] - world.nodes.x[2];
            REQUIRE(world.particles.x[2] > world.nodes.x[2]);
            REQUIRE(world.particles.x[2] < world.nodes.x[half + 2]);
            fastest = std::max(fastest, std::abs(world.particles.v[2]));
        }
        CAPTURE(int(kind));
        CHECK(gap > 2 * l0);
        CHECK(fastest < 4 * wall);  // twice the walls' speed of approach
    }
}

TEST_CASE("particles that start inside are counted and come out without an explosion") {
    const double l0 = 0.05, m = 1, k = 1e5, dt = 1e-4, g = 10;
    const double damping = GENERATE(0.0, 0.1);
    LawSettings law;
    law.eta = damping;
    law.ease_start = true;
    Particles particles;
    particles.add({0.52, 0.53, 1.02 * l0}, {0, 0, 0}, m, l0, k);  // free
    particles.add({0.32, 0.53, 0.95 * l0}, {0, 0, 0}, m, l0, k);  // touches: no overlap
    particles.add({0.72, 0.53, 0.4 * l0}, {0, 0, 0}, m, l0, k);   // deep
    particles.add({0.52, 0.73, -0.6 * l0}, {0, 0, 0}, m, l0, k);  // its center is behind
    World world(flat_plate(10, 10, 0.1, 1e3), particles, law);
    world.nodes_fixed = true;
    world.particle_load = [&](std::size_t) { return Vec(0, 0, -m * g); };
    double fastest = 0;
    for (int n = 0; n < 12000; ++n) {
        world.step(dt);
        for (int i = 2; i < 4; ++i)
            fastest = std::max(fastest, std::abs(world.particles.v[3 * i + 2]));
    }
    const ForceLaw::StartInside inside = world.contact.start_inside();
    CHECK(inside.particles == 2);
    CHECK(inside.deepest == Approx(1.6));
    CHECK(inside.id == world.particles.id[3]);
    // Shot out by k d^2/2 it would leave at 1.6 l0 sqrt(k/m) = 25 m/s. Given back at 0.02 l0
    // sqrt(k/m) = 0.3 m/s it swings with that, twice in the worst phase, and what it falls into its
    // weight.
    CHECK(fastest < 2 * 0.02 * l0 * std::sqrt(k / m) + 2 * g * std::sqrt(m / k));
    for (int i = 2; i < 4; ++i) CHECK(world.particles.x[3 * i + 2] > 0.94 * l0);  // out
    CHECK(world.contact.energy().relative_residual() < 1e-12);
}
