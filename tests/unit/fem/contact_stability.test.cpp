// Contact inside the mesh over many steps: bodies that bounce, nodes pressed far behind the
// surface, and rigid bodies light and heavy, whose springs must neither pump energy nor be softer
// than need be.

#include <catch2/catch.hpp>
#include <cmath>

#include "fem_solver/contact_pairs/springs.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

FemContact contact_between(const std::string& nodes, const std::string& surface, double gap) {
    FemContact contact;
    contact.name = "contact";
    contact.nodes = nodes;
    contact.surface = surface;
    contact.gap = gap;
    return contact;
}

/// An elastic block that falls on a held floor from `height` above where it would touch.
struct FallingBlock {
    static constexpr double gap = 0.002, g = 10;
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    explicit FallingBlock(double height) {
        add_block(mesh, "floor", {{-0.5, -0.5, -0.2}, {0.5, 0.5, 0}}, {2, 2, 1});
        add_block(mesh, "block", {{-0.1, -0.1, gap + height}, {0.1, 0.1, 0.2 + gap + height}},
                  {2, 2, 2});
        c.info.gravity = {0, 0, -g};
        c.fem.part = {{"floor", "steel"}, {"block", "soil"}};
        c.fem.rigid = {{"floor", "floor", {}, 0, {}}};
        c.fem.contact = {contact_between("block.zmin", "floor.zmax", gap)};
        c.fem.bulk_viscosity_linear = c.fem.bulk_viscosity_quadratic = 0;
    }
};

/// [m/s] mean of a set.
double mean_velocity(const Structure& s, const std::string& set, int d) {
    double momentum = 0, mass = 0;
    for (std::int32_t n : s.model().mesh.nodes_of(set, "test")) {
        momentum += s.nodes().mass[n] * s.nodes().v[n].c[d];
        mass += s.nodes().mass[n];
    }
    return momentum / mass;
}

TEST_CASE("a block that starts above its floor needs near, and bounces without gaining energy") {
    FallingBlock alone(0.02);
    CHECK_THROWS_WITH(Structure(build_model(alone.c, alone.mesh), 1),
                      Catch::Contains("Bodies that start apart") && Catch::Contains("need near"));
    const double cfl = GENERATE(0.4, 0.9);
    double worst = 0, balance = 0, least = 1e9, most_searches = 0;
    for (int i = 0; i < 12; ++i) {  // the impact begins at another place within its step
        FallingBlock scene(0.02 + 1e-5 * i);
        scene.c.fem.contact[0].near = 0.03;
        scene.c.fem.cfl = cfl;
        Structure s(build_model(scene.c, scene.mesh), 1);
        CHECK(s.pairs()[0].nodes_near() == 0);
        const double dt = s.stable_step().dt;
        double up = 0, low = 1e300, high = -1e300, fallen = 0;
        march(s, dt, int(0.12 / dt), [&](int) {
            const double v = mean_velocity(s, "block", 2);
            fallen = std::min(fallen, v);
            up = std::max(up, v);
            const double off = s.energies().balance_error();
            low = std::min(low, off);
            high = std::max(high, off);
        });
        const double restitution = up / -fallen, impact = 0.5 * 16 * fallen * fallen;
        CHECK(-fallen == Approx(std::sqrt(2 * 10 * 0.02)).epsilon(0.02));
        worst = std::max(worst, restitution);
        least = std::min(least, restitution);
        balance = std::max(balance, (high - low) / impact);
        most_searches = std::max(most_searches, double(s.pairs()[0].searches()));
    }
    WARN("bouncing block at cfl " << cfl << ": restitution " << least << " to " << worst
                                  << ", balance error over the impact's energy " << balance
                                  << ", searches " << most_searches);
    CHECK(least > 0.3);  // it does come back
    CHECK(worst < 1);
    // A spring that closes between two steps, or opens, leaves k d (v dt - d)/2 at most, which is
    // (omega dt)^2/4 = 0.11 of the node's own energy; the sole has a quarter of the block's mass.
    CHECK(balance < 2 * 0.11 / 4);
    CHECK(most_searches < 10);  // near is 27 mm of room, the way down 20 mm
}

TEST_CASE("a cap that falls on a drum of coarse facets is met where the drum is round") {
    // 9 facets on a half turn: chord and arc are 15 mm apart, thirty gaps. Nodes over the middle of
    // a facet are as near to the drum as those over its edges, and as near when they fly off.
    const double pi = std::acos(-1.0), gap = 5e-4, speed = 2;
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "drum", {{0.5, 0, -0.1}, {1, pi, 0.3}}, {1, 9, 1});
    add_block(mesh, "cap", {{1 + gap, pi / 3, 0}, {1.2, 2 * pi / 3, 0.2}}, {2, 9, 1});
    map_nodes(mesh, [](const Vec3& x) {
        return Vec3{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), x[2]};
    });
    c.fem.part = {{"drum", "steel"}, {"cap", "soil"}};
    c.fem.rigid = {{"drum", "drum", {}, 0, {}}};
    c.fem.contact = {contact_between("cap.xmin", "drum.xmax", gap)};
    c.fem.bulk_viscosity_linear = c.fem.bulk_viscosity_quadratic = 0;
    Structure s(build_model(c, mesh), 1);
    // the parabola of the sagitta is off the circle by up to 2e-5 m here
    CHECK(s.pairs()[0].nodes_near() == 20);

    for (std::int32_t n : s.model().mesh.nodes_of("cap", "test")) s.nodes().v[n].c[1] = -speed;
    const double dt = s.stable_step().dt;
    double up = 0, low = 1e300, high = -1e300, energy = 0;
    march(s, dt, int(0.06 / dt), [&](int n) {
        if (n == 0) energy = s.energies().kinetic;
        up = std::max(up, mean_velocity(s, "cap", 1));
        low = std::min(low, s.energies().balance_error());
        high = std::max(high, s.energies().balance_error());
    });
    const ContactPair& pair = s.pairs()[0];
    WARN("cap on a drum: restitution " << up / speed << ", taken by rims "
                                       << pair.friction_work() / energy << ", balance error "
                                       << (high - low) / energy << " of the energy, touching "
                                       << pair.totals().touching << " at the end");
    CHECK(up > 0.3 * speed);
    CHECK(pair.totals().touching == 0);
    CHECK(pair.friction_work() == 0);
    // as of the block above: (omega dt)^2/4 of the sole's share, a quarter
    CHECK((high - low) / energy < 2 * 0.11 / 4);
}

TEST_CASE("nodes pressed hundreds of gaps behind the surface are held there while they slide") {
    const double gap = 1e-5, pressure = 1e5;
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "floor", {{-1, -0.5, -0.2}, {1, 0.5, 0}}, {8, 4, 1});
    add_block(mesh, "block", {{-0.2, -0.2, gap}, {0.2, 0.2, 0.2 + gap}}, {4, 4, 2});
    c.fem.part = {{"floor", "steel"}, {"block", "soil"}};
    c.fem.rigid = {{"floor", "floor", {}, 0, {}}};
    c.fem.contact = {contact_between("block.zmin", "floor.zmax", gap)};
    c.fem.pressure = {{"block.zmax", pressure, 0.02}};
    c.fem.damping_alpha = 300;
    Structure s(build_model(c, mesh), 1);
    const double dt = s.stable_step().dt;
    for (std::int32_t n : s.model().mesh.nodes_of("block", "test")) s.nodes().v[n].c[0] = 20;
    march(s, dt, int(0.1 / dt));
    double deepest = 0, shallowest = 1e9, way = 0;
    for (std::int32_t n : s.pairs()[0].set().nodes) {
        deepest = std::max(deepest, -s.nodes().x[n].c[2]);
        shallowest = std::min(shallowest, -s.nodes().x[n].c[2]);
        way = std::max(way, s.nodes().x[n].c[0] - s.nodes().x0[n].c[0]);
    }
    const ContactTotals& totals = s.pairs()[0].totals();
    WARN("pressed block: " << shallowest / gap << " to " << deepest / gap
                           << " gaps deep after a way of " << way << " m, force "
                           << totals.normal_force << " of " << 0.16 * pressure << " N, searches "
                           << s.pairs()[0].searches());
    CHECK(shallowest > 100 * gap);
    CHECK(way > 0.05);
    CHECK(totals.touching == 25);
    CHECK(totals.normal_force == Approx(0.16 * pressure).epsilon(0.02));
}

/// A rigid plate between two elastic blocks, free in all six degrees of freedom.
struct Sandwich {
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    static constexpr double gap = 1e-3;
    explicit Sandwich(double weight,
                      std::vector<std::string> free = {"x", "y", "z", "rx", "ry", "rz"}) {
        add_block(mesh, "plate", {{-0.2, -0.1, -0.01}, {0.2, 0.1, 0.01}}, {2, 1, 1});
        add_block(mesh, "low", {{-0.2, -0.2, -0.111}, {0.2, 0.2, -0.011}}, {4, 4, 1});
        add_block(mesh, "high", {{-0.2, -0.2, 0.011}, {0.2, 0.2, 0.111}}, {4, 4, 1});
        c.fem.part = {{"plate", "steel"}, {"low", "soil"}, {"high", "soil"}};
        c.fem.rigid = {{"plate", "plate", std::move(free), 0, {}}};
        for (const char* side : {"plate.zmin", "plate.zmax"})
            for (const Quad& q : mesh.facet_sets[side]) mesh.facet_sets["faces"].push_back(q);
        for (const char* side : {"low.zmax", "high.zmin"})
            for (const Quad& q : mesh.facet_sets[side]) mesh.facet_sets["soil"].push_back(q);
        c.fem.contact = {contact_between("soil", "faces", gap)};
        c.fem.contact[0].friction = 0.3;
        c.fem.support = {{"low.zmin", {"x", "y", "z"}}, {"high.zmax", {"x", "y", "z"}}};
        c.fem.material[1].density *= weight;
        c.fem.bulk_viscosity_linear = c.fem.bulk_viscosity_quadratic = 0;
    }
};

TEST_CASE(
    "what a rigid body yields to a force at a corner is 1/M and the turning about its center") {
    Sandwich scene(1);
    const Structure s(build_model(scene.c, scene.mesh), 1);
    const RigidBody& body = s.bodies()[0];
    // nodes of 2 x 1 x 1 elements: lumped inertia
    double mass = 0, i[3] = {};
    for (std::int32_t n : body.set().nodes) {
        const double m = s.nodes().mass[n], *x = s.nodes().x[n].c;
        mass += m;
        for (int d = 0; d < 3; ++d)
            i[d] += m * (x[(d + 1) % 3] * x[(d + 1) % 3] + x[(d + 2) % 3] * x[(d + 2) % 3]);
    }
    // z at (0.2, 0.1): turns about x and y; the flat plate has no easier direction to 1 %
    const double exact = 1 / mass + 0.1 * 0.1 / i[0] + 0.2 * 0.2 / i[1];
    CHECK(body.yield_to({{0.2, 0.1, 0.0}}, {1.0}) == Approx(exact).epsilon(1e-12));
    // all of its surface: the heaviest mode is one of those six
    const ContactSet& set = s.model().contacts[0];
    const double load = load_on_body(set, s.nodes(), body);
    CHECK(load >= 2 * 0.4 * 0.2 / mass);                   // both faces, moving as one
    CHECK(load <= 2 * (0.4 + 0.1) * (0.2 + 0.1) * exact);  // never more than all at a corner
    Sandwich held(1, {});
    const Structure h(build_model(held.c, held.mesh), 1);
    CHECK(load_on_body(set, h.nodes(), h.bodies()[0]) == 0);
}

TEST_CASE("contact with a heavy rigid body is as stiff as with one that is held") {
    const auto softest = [](double weight, std::vector<std::string> free) {
        Sandwich scene(weight, std::move(free));
        return Structure(build_model(scene.c, scene.mesh), 1).pairs()[0].softest();
    };
    const double held = softest(1, {});
    const double heavy = softest(100, {"x", "y", "z", "rx", "ry", "rz"});
    const double steel = softest(1, {"x", "y", "z", "rx", "ry", "rz"});
    WARN("springs on a plate that is held " << held << " E A/h, of 100 times steel " << heavy
                                            << ", of steel " << steel);
    CHECK(held > 0.3);  // soil at nu = 0.3 on its own largest step
    CHECK(heavy > 0.97 * held);
    CHECK(heavy <= held);
}

TEST_CASE(
    "springs of a rigid body are stable for 1e5 steps, a hundredth as heavy as steel or more") {
    const double weight = GENERATE(0.01, 0.1, 1.0, 100.0);
    Sandwich scene(weight);
    Structure s(build_model(scene.c, scene.mesh), 1);
    CHECK(s.pairs()[0].softest() < 10);  // the budget does limit
    // squeezed between the blocks
    NodeRows load(s.nodes().size());
    for (std::size_t i = 0; i < s.pairs()[0].set().nodes.size(); ++i) {
        const std::int32_t n = s.pairs()[0].set().nodes[i];
        load[n].c[2] = (s.nodes().x[n].c[2] > 0 ? -5e4 : 5e4) * std::min(1.0, weight) *
                       s.pairs()[0].set().area[i];
    }
    const_cast<ContactPair&>(s.pairs()[0]).balance(load);
    const auto [early, late] = march_shaken(s, 100000);
    WARN("squeezed plate of " << s.bodies()[0].mass() << " kg: springs " << s.pairs()[0].softest()
                              << " E A/h, energy " << early << " -> " << late << " J");
    CHECK(std::isfinite(late));
    CHECK(late <= early);
}

}  // namespace
}  // namespace undertow::fem
