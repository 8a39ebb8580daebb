#include "contact/detection.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "scene.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;

namespace {
constexpr double l0 = 0.3;
}

TEST_CASE("on a flat wall of quads the contact does not depend on where the particle sits") {
    const Nodes plate = flat_plate(4, 4, 0.25, 1);
    // Over facets, on edges, on nodes, and smaller or larger than a facet: one contact, d = l0 -
    // z.
    for (double x : {0.5, 0.375, 0.4999999, 0.43, 0.62})
        for (double y : {0.5, 0.375, 0.5000001, 0.58, 0.26})
            for (double radius : {0.05, 0.3}) {
                const auto contacts = contacts_at(plate, Vec(x, y, 0.8 * radius), radius);
                REQUIRE(contacts.size() == 1);
                CHECK(contacts[0].depth == Approx(0.2 * radius).epsilon(1e-12));
                CHECK((contacts[0].normal - Vec(0, 0, 1)).norm() < 1e-12);
                CHECK((contacts[0].point - Vec(x, y, 0)).norm() < 1e-12);
            }
}

TEST_CASE("a slightly curved surface of facets counts once at its seams") {
    // A valley of 2 degrees between two facets, the particle centered over the seam.
    const double s = std::tan(1 * M_PI / 180);
    const Nodes valley =
        mesh_of({{-1, 0, s}, {0, 0, 0}, {1, 0, s}, {-1, 1, s}, {0, 1, 0}, {1, 1, s}},
                {0, 1, 4, 3, 1, 2, 5, 4}, 1);
    for (double x : {-0.01, -0.001, 0.0, 0.001, 0.01}) {
        const auto contacts = contacts_at(valley, Vec(x, 0.5, 0.9 * l0), l0);
        CHECK(contacts.size() == 1);
    }
}

TEST_CASE("a concave corner counts both walls, a corner of three counts three") {
    const Nodes corner =
        mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}},
                {0, 1, 2, 3, 0, 3, 5, 4, 0, 4, 6, 1}, 1);  // floor, wall x, wall y
    REQUIRE(find_defect(corner.x, corner.quad).empty());
    const auto two = contacts_at(corner, Vec(0.8 * l0, 0.5, 0.9 * l0), l0);
    REQUIRE(two.size() == 2);
    CHECK(two[0].depth == Approx(0.2 * l0));  // deepest first
    CHECK((two[0].normal - Vec(1, 0, 0)).norm() < 1e-12);
    CHECK(two[1].depth == Approx(0.1 * l0));
    CHECK((two[1].normal - Vec(0, 0, 1)).norm() < 1e-12);
    CHECK(contacts_at(corner, Vec(0.8 * l0, 0.7 * l0, 0.9 * l0), l0).size() == 3);
}

TEST_CASE("a convex edge counts once, with the normal from the edge to the particle") {
    // Top (normal +z) and side (normal +x) of a block whose edge runs along y at x = z = 0.
    const Nodes edge =
        mesh_of({{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {0, 0, -1}, {0, 1, -1}},
                {0, 1, 2, 3, 1, 4, 5, 2}, 1);
    REQUIRE(find_defect(edge.x, edge.quad).empty());
    const Vec out(0.6, 0, 0.8);
    const auto contacts = contacts_at(edge, Vec(0, 0.5, 0) + 0.7 * l0 * out, l0);
    REQUIRE(contacts.size() == 1);
    CHECK((contacts[0].normal - out).norm() < 1e-12);
    CHECK(contacts[0].depth == Approx(0.3 * l0));
    // Over the top, near the edge: the side does not act.
    const auto over = contacts_at(edge, Vec(-0.05 * l0, 0.5, 0.4 * l0), l0);
    REQUIRE(over.size() == 1);
    CHECK((over[0].normal - Vec(0, 0, 1)).norm() < 1e-12);
    // Just inside the block, nearer to the side: pushed out through the side.
    const auto inside = contacts_at(edge, Vec(-0.1 * l0, 0.5, -0.3 * l0), l0);
    REQUIRE(inside.size() == 1);
    CHECK((inside[0].normal - Vec(1, 0, 0)).norm() < 1e-12);
    CHECK(inside[0].depth == Approx(1.1 * l0));
}

TEST_CASE("a knife edge, sharper than 90 degrees, is still one contact") {
    const Nodes knife =
        mesh_of({{0, 0, 0}, {0, 1, 0}, {-1, 0, -0.1}, {-1, 1, -0.1}, {-1, 0, 0.1}, {-1, 1, 0.1}},
                {0, 1, 5, 4, 0, 2, 3, 1}, 1);  // upper face, lower face
    REQUIRE(find_defect(knife.x, knife.quad).empty());
    for (double angle : {-80.0, -40.0, 0.0, 40.0, 80.0}) {
        const Vec out(std::cos(angle * M_PI / 180), 0, std::sin(angle * M_PI / 180));
        const auto contacts = contacts_at(knife, Vec(0, 0.5, 0) + 0.5 * l0 * out, l0);
        REQUIRE(contacts.size() == 1);
        CHECK((contacts[0].normal - out).norm() < 1e-12);
    }
}

TEST_CASE("a particle whose center has passed the surface is pushed back out, to a stated depth") {
    const Nodes plate = flat_plate(4, 4, 0.25, 1);
    const auto behind = contacts_at(plate, Vec(0.4, 0.6, -0.2 * l0), l0);
    REQUIRE(behind.size() == 1);
    CHECK(behind[0].depth == Approx(1.2 * l0));
    CHECK((behind[0].normal - Vec(0, 0, 1)).norm() < 1e-12);
    CHECK(contacts_at(plate, Vec(0.4, 0.6, 0), l0).size() == 1);  // center in the surface
    CHECK(contacts_at(plate, Vec(0.4, 0.6, -1.01 * l0), l0).empty());
}

TEST_CASE("beside the free edge of an open plate the edge is round, below as above") {
    const Nodes plate = flat_plate(2, 2, 0.5, 1);
    const auto below = contacts_at(plate, Vec(1 + 0.6 * 0.9 * l0, 0.5, -0.8 * 0.9 * l0), l0);
    REQUIRE(below.size() == 1);
    CHECK(below[0].depth == Approx(0.1 * l0));
    CHECK((below[0].normal - Vec(0.6, 0, -0.8)).norm() < 1e-12);
}

TEST_CASE("a thin plate wet on both sides does not pull a particle through") {
    // Two faces 0.5 l0 apart, wet sides outward: only the near one acts.
    const double t = 0.5 * l0;
    const Nodes plate = mesh_of({{0, 0, 0},
                                 {1, 0, 0},
                                 {1, 1, 0},
                                 {0, 1, 0},
                                 {0, 0, -t},
                                 {1, 0, -t},
                                 {1, 1, -t},
                                 {0, 1, -t}},
                                {0, 1, 2, 3, 4, 7, 6, 5}, 1);
    const auto above = contacts_at(plate, Vec(0.5, 0.5, 0.4 * l0), l0);
    REQUIRE(above.size() == 1);
    CHECK(above[0].normal[2] == Approx(1));
    CHECK(above[0].depth == Approx(0.6 * l0));
    const auto below = contacts_at(plate, Vec(0.5, 0.5, -t - 0.4 * l0), l0);
    REQUIRE(below.size() == 1);
    CHECK(below[0].normal[2] == Approx(-1));
}

TEST_CASE("a particle between two closing walls is pushed by both") {
    const Nodes gap = mesh_of({{0, 0, 0},
                               {1, 0, 0},
                               {1, 1, 0},
                               {0, 1, 0},
                               {0, 0, 1.6 * l0},
                               {1, 0, 1.6 * l0},
                               {1, 1, 1.6 * l0},
                               {0, 1, 1.6 * l0}},
                              {0, 1, 2, 3, 4, 7, 6, 5}, 1);
    const auto contacts = contacts_at(gap, Vec(0.5, 0.5, 0.8 * l0), l0);
    REQUIRE(contacts.size() == 2);
    CHECK(contacts[0].normal.dot(contacts[1].normal) == Approx(-1));
}

TEST_CASE("a particle four times as large as the facets still has one contact") {
    const Nodes plate = flat_plate(20, 20, 0.5 * l0, 1);
    const auto contacts = contacts_at(plate, Vec(1.51, 1.49, 0.05 * l0), l0);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].depth == Approx(0.95 * l0));
}

TEST_CASE("the step limit lets a particle approach a quarter of l0 per step") {
    const Nodes plate = flat_plate(4, 4, 0.25, 1);
    Particles particles;
    particles.add({0.5, 0.5, 1.1 * l0}, {30, 0, -50}, 1, l0,
                  1);  // sliding does not count
    PenaltyContact contact(plate.surface(), {});
    contact.rebuild(particles.points(), 0.3 * l0, plate.x, plate.v);
    CHECK(contact.step_limit() == Approx(0.25 * l0 / 50));
}

TEST_CASE("contacts are the same for any number of threads") {
    const Nodes plate = flat_plate(10, 10, 0.1, 1);
    Particles particles;
    for (int i = 0; i < 500; ++i)
        particles.add({0.05 + 0.9 * (i % 25) / 25, 0.03 + 0.9 * (i / 25) / 20, 0.01 * (i % 7)},
                      {0, 0, -1}, 1, 0.05, 1);
    PenaltyContact one(plate.surface(), {}, {}, 1), three(plate.surface(), {}, {}, 3);
    for (PenaltyContact* contact : {&one, &three}) {
        contact->rebuild(particles.points(), 0.01, plate.x, plate.v);
        contact->compute_forces(1e-3);
    }
    REQUIRE(one.contacts().size() == three.contacts().size());
    for (std::size_t i = 0; i < one.on_nodes().size(); ++i)
        REQUIRE(one.on_nodes()[i] == three.on_nodes()[i]);
    for (std::size_t i = 0; i < one.on_particles().size(); ++i)
        REQUIRE(one.on_particles()[i] == three.on_particles()[i]);
}

TEST_CASE("tests that are skipped change no bit of contacts and step limit") {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> any(0, 1);
    for (double size : {0.04, 0.15}) {  // facets smaller and larger than the particles
        Nodes plate = flat_plate(int(1 / size), int(1 / size), size, 1);
        Particles particles;
        const double radius = 0.04, skin = 0.03;
        for (int i = 0; i < 300; ++i)
            particles.add({any(random), any(random), 0.1 * any(random)},
                          {any(random) - 0.5, any(random) - 0.5, 0.4 * (any(random) - 0.5)}, 1,
                          radius, 1);
        PenaltyContact cached(plate.surface(), {});
        std::vector<std::uint32_t> rows;
        double dt = 2e-3, limits = 0;
        std::size_t found = 0;
        for (int n = 0; n < 120; ++n) {
            // A search every 15 steps: what moves meanwhile stays within the skin.
            if (n % 15 == 0) {
                cached.rebuild(particles.points(), skin, plate.x, plate.v);
                rows.assign(cached.active_rows().begin(), cached.active_rows().end());
            }
            Particles active;
            for (std::uint32_t row : rows)
                active.add(Vec::Map(&particles.x[3 * row]), Vec::Map(&particles.v[3 * row]), 1,
                           radius, 1);
            const double longest = n % 2 ? 0.3 : PenaltyContact::any_dt;
            if (n % 15 != 0) cached.update(active.x, active.v, plate.x, plate.v, longest);
            PenaltyContact fresh(plate.surface(), {});
            fresh.rebuild(active.points(), 1.0, plate.x, plate.v);
            REQUIRE(fresh.active_rows().size() == rows.size());

            const auto &a = cached.contacts(), &b = fresh.contacts();
            REQUIRE(a.size() == b.size());
            found += a.size();
            for (std::size_t c = 0; c < a.size(); ++c) {
                REQUIRE(a[c].particle == b[c].particle);
                REQUIRE(a[c].facet == b[c].facet);
                REQUIRE(a[c].depth == b[c].depth);
                REQUIRE(a[c].closing == b[c].closing);
                REQUIRE(a[c].normal == b[c].normal);
                REQUIRE(a[c].weight == b[c].weight);
            }
            // Asked about its own candidates only, and no further than the longest step.
            if (cached.step_limit() < longest) {
                REQUIRE(cached.step_limit() >= fresh.step_limit());
                ++limits;
            }
            for (std::size_t i = 0; i < particles.x.size(); ++i)
                particles.x[i] += dt * particles.v[i];
            for (std::size_t i = 2; i < plate.x.size(); i += 3) {
                plate.v[i] = 0.5 * std::sin(9 * plate.x[i - 2] + 0.2 * n);
                plate.x[i] += dt * plate.v[i];
            }
        }
        CHECK(found > 2000);
        CHECK(limits > 20);
    }
}

TEST_CASE("a step limit below the longest step is the same whether a longest step is given or not") {
    const Nodes plate = flat_plate(4, 4, 0.25, 1);
    Particles particles;
    particles.add({0.5, 0.5, 1.1 * l0}, {30, 0, -50}, 1, l0, 1);
    particles.add({0.3, 0.5, 1.1 * l0}, {1, 0, -1}, 1, l0, 1);  // too slow to be asked
    PenaltyContact contact(plate.surface(), {});
    contact.rebuild(particles.points(), 0.3 * l0, plate.x, plate.v, 0.01);
    CHECK(contact.step_limit() == Approx(0.25 * l0 / 50));
    contact.rebuild(particles.points(), 0.3 * l0, plate.x, plate.v, 1e-4);  // nobody is that fast
    CHECK(contact.step_limit() > 1e-4);
}
