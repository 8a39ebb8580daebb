// Contact inside the mesh: a skirt in the ground, blocks that slide, stick and part.

#include "fem_solver/contact_pairs/contact_pair.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "fem_solver/contact_pairs/springs.hpp"
#include "fem_solver/settle.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);

/// A rigid floor (held, if `free` is empty) with an elastic block on it, 10 mm apart in the mesh.
struct BlockOnFloor {
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    BlockOnFloor(double friction, std::vector<std::string> floor_moves = {}) {
        add_block(mesh, "floor", {{-2, -1, -0.2}, {2, 1, -0.01}}, {10, 5, 1});
        add_block(mesh, "block", {{-0.2, -0.2, 0}, {0.2, 0.2, 0.2}}, {4, 4, 2});
        c.fem.part = {{"floor", "steel"}, {"block", "soil"}};
        c.fem.rigid = {{"floor", "floor", floor_moves, 0, {}}};
        FemContact contact;
        contact.name = "sole";
        contact.nodes = "block.zmin";
        contact.surface = "floor.zmax";
        contact.friction = friction;
        contact.gap = 0.01;
        c.fem.contact = {contact};
    }
};

/// Smallest to largest of what it was shown.
struct Range {
    double low = 1e300, high = -1e300;
    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double width() const { return high - low; }
};

double mean_x_velocity(const Structure& s) {
    const std::vector<std::int32_t> nodes = s.model().mesh.nodes_of("block", "test");
    double momentum = 0, mass = 0;
    for (std::int32_t n : nodes) {
        momentum += s.nodes().mass[n] * s.nodes().v[n].c[0];
        mass += s.nodes().mass[n];
    }
    return momentum / mass;
}
double mean_x(const Structure& s) {
    const std::vector<std::int32_t> nodes = s.model().mesh.nodes_of("block", "test");
    double moment = 0, mass = 0;
    for (std::int32_t n : nodes) {
        moment += s.nodes().mass[n] * (s.nodes().x[n].c[0] - s.nodes().x0[n].c[0]);
        mass += s.nodes().mass[n];
    }
    return moment / mass;
}

TEST_CASE("a block slides down a plane of slope 0.5 with g (sin - mu cos)") {
    // tan theta = 0.5, mu = 0.328: 9.81 (0.44721 - 0.328 * 0.89443) = 1.5092 m/s2
    BlockOnFloor scene(0.328);
    const double theta = std::atan(0.5), g = 9.81;
    scene.c.info.gravity = {0, 0, -g * std::cos(theta)};
    Structure s(build_model(scene.c, scene.mesh), 1);
    settle(s, {1e-6, 20000});
    set_gravity(s, {g * std::sin(theta), 0, -g * std::cos(theta)});
    const double dt = 0.9 * s.stable_step().dt;
    double v1 = 0, t1 = 0, v2 = 0, t2 = 0;
    const int steps = int(0.5 / dt);
    Range balance;
    double peak = 0;
    march(s, dt, steps, [&](int n) {
        // the elastic block starts ringing when the plane tilts: means over its many periods
        const double weight = double(n) / steps;
        if (weight > 0.2 && weight <= 0.4) v1 += mean_x_velocity(s), t1 += 1;
        if (weight > 0.8) v2 += mean_x_velocity(s), t2 += 1;
        const Energies e = s.energies();
        peak = std::max(peak, e.kinetic);
        balance.add(e.balance_error());
    });
    const double a = (v2 / t2 - v1 / t1) / (0.6 * steps * dt);
    const double exact = g * (std::sin(theta) - 0.328 * std::cos(theta));
    WARN("sliding block: " << a << " m/s2, exact " << exact << "; balance error over peak energy "
                           << balance.width() / peak);
    CHECK(a == Approx(exact).epsilon(0.005));
    CHECK(balance.width() / peak <
          1e-3);  // kinks of slip are integrated to second order in the step
    CHECK(s.energies().pair_friction > 0);
}

TEST_CASE("an implicit block slides as well, at twenty of its own steps in one") {
    BlockOnFloor scene(0.328);
    scene.c.fem.material[0].young_modulus = 1e10;
    scene.c.fem.part[1].implicit = true;
    scene.c.time.max_step = 6e-4;
    const double theta = std::atan(0.5), g = 9.81;
    scene.c.info.gravity = {0, 0, -g * std::cos(theta)};
    Structure s(build_model(scene.c, scene.mesh), 1);
    REQUIRE(s.stable_step().dt == 6e-4);
    REQUIRE(s.stable_step().dt > 18 * s.implicit()->explicit_step());
    settle(s, {1e-6, 20000});
    set_gravity(s, {g * std::sin(theta), 0, -g * std::cos(theta)});
    const double dt = s.stable_step().dt;
    const int steps = int(0.5 / dt);
    double v1 = 0, t1 = 0, v2 = 0, t2 = 0, peak = 0;
    Range balance;
    march(s, dt, steps, [&](int n) {
        const double weight = double(n) / steps;
        if (weight > 0.2 && weight <= 0.4) v1 += mean_x_velocity(s), t1 += 1;
        if (weight > 0.8) v2 += mean_x_velocity(s), t2 += 1;
        const Energies e = s.energies();
        peak = std::max(peak, e.kinetic);
        balance.add(e.balance_error());
    });
    const double a = (v2 / t2 - v1 / t1) / (0.6 * steps * dt);
    const double exact = g * (std::sin(theta) - 0.328 * std::cos(theta));
    WARN("sliding implicit block: " << a << " m/s2, exact " << exact
                                    << "; balance error over peak energy "
                                    << balance.width() / peak);
    CHECK(a == Approx(exact).epsilon(0.005));
    CHECK(balance.width() / peak < 1e-3);
}

TEST_CASE("a block sticks on the plane when friction suffices, and does not creep") {
    BlockOnFloor scene(0.6);
    scene.c.fem.damping_alpha = 50;  // quiets the ringing of the tilt, moves nothing at rest
    const double theta = std::atan(0.5), g = 9.81;
    scene.c.info.gravity = {0, 0, -g * std::cos(theta)};
    Structure s(build_model(scene.c, scene.mesh), 1);
    settle(s, {1e-6, 20000});
    const double dt = 0.9 * s.stable_step().dt;
    // tilted over 0.2 s, then 0.3 s to come to rest
    const auto tilt = [&](double share) {
        const double angle = share * theta;
        set_gravity(s, {g * std::sin(angle), 0, -g * std::cos(angle)});
    };
    const int ramp = int(0.2 / dt);
    march(s, dt, ramp, [&](int n) { tilt(double(n + 1) / ramp); });
    tilt(1);
    march(s, dt, int(0.3 / dt));
    const double before = mean_x(s), dissipated = s.energies().pair_friction;
    march(s, dt, int(1.0 / dt));
    WARN("sticking block: creep in 1 s " << mean_x(s) - before << " m, stretch " << before
                                         << " m, slipping nodes "
                                         << s.pairs()[0].totals().slipping);
    CHECK(std::abs(mean_x(s) - before) < 1e-6);
    CHECK(s.energies().pair_friction == Approx(dissipated).margin(1e-9));
    CHECK(s.pairs()[0].totals().friction[0] ==
          Approx(-2000 * 0.4 * 0.4 * 0.2 * g * std::sin(theta)).epsilon(1e-3));
}

TEST_CASE("a block that is thrown up leaves its floor without a pull, and forces are in balance") {
    BlockOnFloor scene(0.3, {"x", "y", "z", "rx", "ry", "rz"});
    Structure s(build_model(scene.c, scene.mesh), 1);
    Nodes& nodes = s.nodes();
    for (std::int32_t n : s.model().mesh.nodes_of("block", "test")) {
        nodes.v[n].c[2] = -0.1;
        nodes.v[n].c[0] = 0.05;
    }
    const double dt = 0.9 * s.stable_step().dt;
    double p0[3] = {}, p[3] = {}, L0[3] = {}, L[3] = {};
    const auto momenta = [&](double(&momentum)[3], double(&moment)[3]) {
        const RigidBody& floor = s.bodies()[0];
        const Vec3 vf = floor.velocity(), cf = floor.center(), Lf = floor.moment_of_momentum();
        for (int d = 0; d < 3; ++d) {
            const int a = (d + 1) % 3, b = (d + 2) % 3;
            momentum[d] = floor.mass() * vf[d];
            moment[d] = Lf[d] + floor.mass() * (cf[a] * vf[b] - cf[b] * vf[a]);
            for (std::int32_t n : s.model().mesh.nodes_of("block", "test")) {
                momentum[d] += nodes.mass[n] * nodes.v[n].c[d];
                moment[d] += nodes.mass[n] * (nodes.x[n].c[a] * nodes.v[n].c[b] -
                                              nodes.x[n].c[b] * nodes.v[n].c[a]);
            }
        }
    };
    s.internal_forces();
    s.kick(dt);
    s.drift(dt);
    momenta(p0, L0);
    Range balance;
    double most = 0;
    march(s, dt, 4000, [&](int) {
        most = std::max(most, s.pairs()[0].totals().normal_force);
        balance.add(s.energies().balance_error());
    });
    momenta(p, L);
    const double mass = 64 + s.bodies()[0].mass();
    CHECK(most > 1000);                              // they did meet
    CHECK(s.pairs()[0].totals().normal_force == 0);  // and part
    for (int d = 0; d < 3; ++d) {
        CHECK(std::abs(p[d] - p0[d]) / mass < 1e-15);  // round-off of 4000 steps
        CHECK(std::abs(L[d] - L0[d]) / mass < 1e-15);
    }
    const double up = -p0[2];
    WARN("thrown block: momentum " << p[2] - p0[2] << " of " << up << ", moment " << L[1] - L0[1]
                                   << ", balance error " << balance.width() << " of "
                                   << 0.5 * 64 * (0.1 * 0.1 + 0.05 * 0.05) << " J");
    // contact begins and ends between steps: the trapezoid cuts those corners
    CHECK(balance.width() < 5e-3 * 0.5 * 64 * 0.0125);
}

/// Half of a round skirt, in elastic ground that lies against both faces; the tip reaches below it.
/// Cylindrical: x is the radius, y the angle, z up.
struct RoundSkirt {
    Case c = two_solids(5e6, 1800);
    Mesh mesh;
    static constexpr double radius = 1, half = 0.01, gap = 0.005, depth = 0.5;
    RoundSkirt(double friction, int around = 12) {
        const double in = radius - half - gap, out = radius + half + gap, bottom = -0.4;
        add_block(mesh, "skirt", {{radius - half, 0, -depth}, {radius + half, pi, 0.1}},
                  {1, around, 6});
        add_block(mesh, "inside", {{0.6, 0, bottom}, {in, pi, 0}}, {4, around, 4});
        add_block(mesh, "outside", {{out, 0, bottom}, {1.4, pi, 0}}, {4, around, 4});
        map_nodes(mesh, [](const Vec3& x) {
            return Vec3{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), x[2]};
        });
        check_mesh(mesh);
        c.fem.part = {{"skirt", "steel"}, {"inside", "soil"}, {"outside", "soil"}};
        c.fem.rigid = {{"bucket", "skirt", {"x", "z", "ry"}, 0, {}}};
        auto& surface = mesh.facet_sets["skin"];
        for (const char* side : {"skirt.xmin", "skirt.xmax", "skirt.zmin"})
            surface.insert(surface.end(), mesh.facet_sets[side].begin(),
                           mesh.facet_sets[side].end());
        auto& nodes = mesh.facet_sets["walls"];
        for (const char* side : {"inside.xmax", "outside.xmin"})
            nodes.insert(nodes.end(), mesh.facet_sets[side].begin(), mesh.facet_sets[side].end());
        FemContact contact;
        contact.name = "skirt";
        contact.nodes = "walls";
        contact.surface = "skin";
        contact.friction = friction;
        contact.gap = gap;
        c.fem.contact = {contact};
        c.fem.support = {{"inside.xmin", {"x", "y", "z"}}, {"outside.xmax", {"x", "y", "z"}}};
    }
};

/// Radial forces p A of a pressure [Pa] on the soil's walls, as stresses of the soil would make
/// them.
NodeRows pressed(const Structure& s, double pressure) {
    NodeRows load(s.nodes().size());
    const ContactSet& set = s.pairs()[0].set();
    for (std::size_t i = 0; i < set.nodes.size(); ++i) {
        const double* x = s.nodes().x[set.nodes[i]].c;
        const double r = std::hypot(x[0], x[1]);
        const double sign = r > 1 ? -1 : 1;  // both sides push the soil into the skirt
        for (int d = 0; d < 2; ++d)
            load[set.nodes[i]].c[d] = sign * pressure * set.area[i] * x[d] / r;
    }
    return load;
}

TEST_CASE("a skirt pressed from both sides stays in equilibrium at the start, node by node") {
    RoundSkirt scene(0.328);
    Structure s(build_model(scene.c, scene.mesh), 1);
    ContactPair& pair = const_cast<ContactPair&>(s.pairs()[0]);
    CHECK(pair.nodes_near() == int(pair.set().nodes.size()));
    const NodeRows load = pressed(s, 5e3);
    pair.balance(load);
    s.internal_forces();
    double left = 0, largest = 0, total = 0;
    for (std::int32_t n : pair.set().nodes) {
        const double fx = load[n].c[0], fy = load[n].c[1];
        const double f = std::hypot(fx, fy);
        left = std::max(left, std::hypot(fx + s.nodes().f[n].c[0], fy + s.nodes().f[n].c[1]));
        largest = std::max(largest, f);
        total += f;
    }
    WARN("pressed skirt: force left on a node " << left << " N of " << largest << " N, normal sum "
                                                << pair.totals().normal_force << " of " << total
                                                << " N");
    // Normals are radial although facets are not, but for what one correction of the foot leaves:
    // (distance/radius)^2 times the angle of a facet, 0.005^2 * 0.26 = 7e-6.
    CHECK(left < 7e-6 * largest);
    CHECK(pair.totals().friction == Vec3{0, 0, 0});
    CHECK(pair.totals().normal_force == Approx(total).epsilon(1e-9));  // the cosine of it
}

TEST_CASE("a plate in geostatic ground on both sides feels no jump in the first step") {
    Case c = two_solids(5e6, 1846);
    c.info.gravity = {0, 0, -9.81};
    c.fem.material[0].weight_density = 846;
    c.fem.material[1].weight_density = 0;  // the plate weighs nothing: nothing has to move
    Mesh mesh;
    add_block(mesh, "plate", {{-0.01, 0, -0.9}, {0.01, 0.4, 0.1}}, {1, 2, 5});
    add_block(mesh, "west", {{-1, 0, -0.8}, {-0.015, 0.4, 0}}, {5, 2, 8});
    add_block(mesh, "east", {{0.015, 0, -0.8}, {1, 0.4, 0}}, {4, 3, 6});  // another mesh
    for (const char* side : {"west", "east"})
        for (std::int32_t e : mesh.volume_sets[side]) mesh.volume_sets["soil"].push_back(e);
    const auto gather = [&](const char* set, std::initializer_list<const char*> sides) {
        for (const char* side : sides)
            for (const Quad& q : mesh.facet_sets[side]) mesh.facet_sets[set].push_back(q);
    };
    gather("walls", {"west.xmax", "east.xmin"});
    gather("faces", {"plate.xmin", "plate.xmax"});
    c.fem.part = {{"plate", "steel"}, {"soil", "soil"}};
    c.fem.rigid = {{"plate", "plate", {"x", "z", "ry"}, 0, {}}};
    c.fem.support = {{"west.zmin", {"z"}},
                     {"east.zmin", {"z"}},
                     {"west.xmin", {"x"}},
                     {"east.xmax", {"x"}},
                     {"soil", {"y"}}};
    c.fem.geostatic = FemGeostatic{"soil", 0, 0.8};
    FemContact contact;
    contact.name = "faces";
    contact.nodes = "walls";
    contact.surface = "faces";
    contact.friction = 0.328;
    contact.gap = 0.005;
    c.fem.contact = {contact};
    Structure s(build_model(c, mesh), 1);
    s.internal_forces();
    const Residual left = s.residual();
    const Wrench pull = s.bodies()[0].unbalanced(s.nodes(), c.info.gravity);
    const double sum = s.pairs()[0].totals().normal_force;
    // both walls: K0 gamma z^2/2 per width, times two
    CHECK(sum == Approx(2 * 0.8 * 846 * 9.81 * 0.4 * 0.8 * 0.8 / 2).epsilon(1e-9));
    WARN("plate in geostatic ground: left on a node " << left.node << " N of " << left.reference
                                                      << " N mean weight, on the plate "
                                                      << pull.force[0] << " N of " << sum << " N");
    CHECK(left.node < 1e-9 * left.reference);  // round-off of k times positions
    CHECK(std::abs(pull.force[0]) < 1e-9 * sum);
    CHECK(s.pairs()[0].totals().friction == Vec3{0, 0, 0});
}

TEST_CASE("a skirt is pulled out by mu sigma_n A, and max_shear caps it") {
    const double mu = 0.328, sigma = 5e3;
    const double cap = GENERATE(0.0, 1000.0);
    RoundSkirt scene(mu);
    scene.c.fem.contact[0].max_shear = cap;
    Structure s(build_model(scene.c, scene.mesh), 1);
    ContactPair& pair = const_cast<ContactPair&>(s.pairs()[0]);
    pair.balance(pressed(s, sigma));
    double area = 0;
    for (double a : pair.set().area) area += a;
    // The ground is held everywhere, the body is moved up: only friction acts.
    Nodes nodes = s.nodes();
    std::vector<RigidBody> bodies;
    bodies.emplace_back(s.model().rigid[0], nodes);
    const double dt = 1e-4, speed = 0.01;
    const std::vector<std::int32_t>& of_body = bodies[0].set().nodes;
    double force = 0, peak = 0;
    for (int n = 0; n < 1000; ++n) {  // 1 mm
        for (std::int32_t i : of_body) {
            nodes.v[i].c[2] = speed;
            if (n > 0) nodes.x[i].c[2] += dt * speed;
        }
        bodies[0].clear_contact();
        pair.evaluate(nodes, bodies, n > 0 ? dt : 0);
        force = -bodies[0].contact().force[2];
        peak = std::max(peak, force);
    }
    const double stress = cap > 0 ? std::min(cap, mu * sigma) : mu * sigma;
    WARN("pull-out: " << force << " N, stress times area " << stress * area << " N; stress "
                      << stress);
    // vertical sliding leaves distances as they are
    CHECK(force == Approx(stress * area).epsilon(1e-9));
    CHECK(peak == Approx(force).epsilon(1e-6));
    CHECK(pair.totals().slipping == pair.totals().touching);
    CHECK(pair.friction_work() > 0);
}

TEST_CASE("adhesion is a share of the soil's own strength at the depth of each facet") {
    constexpr double alpha = 0.4, su = 2e3, gradient = 5e3;
    RoundSkirt scene(0.328);
    scene.c.fem.contact[0].adhesion_factor = alpha;
    CHECK_THROWS_WITH(build_model(scene.c, scene.mesh),
                      Catch::Contains("adhesion_factor") && Catch::Contains("not of kind"));
    const FemPart& ground = *std::find_if(
        scene.c.fem.part.begin(), scene.c.fem.part.end(),
        [&](const FemPart& part) { return part.set != scene.c.fem.rigid[0].set; });
    FemMaterial& clay = *std::find_if(scene.c.fem.material.begin(), scene.c.fem.material.end(),
                                      [&](const auto& m) { return m.name == ground.material; });
    clay.kind = MaterialKind::tresca;
    clay.shear_strength = su;
    clay.strength_gradient = gradient;
    const Model model = build_model(scene.c, scene.mesh);
    const ContactSet& set = model.contacts[0];
    double sum = 0, exact = 0;
    for (double f : set.max_friction) sum += f;
    for (const Quad& q : model.mesh.facets_of(scene.c.fem.contact[0].nodes, "test")) {
        // flat facets, so their centers say the integral of a linear strength
        double z = 0, a[3], b[3];
        for (std::int32_t n : q) z += 0.25 * model.mesh.x[n][2];
        for (int d = 0; d < 3; ++d) {
            a[d] = model.mesh.x[q[2]][d] - model.mesh.x[q[0]][d];
            b[d] = model.mesh.x[q[3]][d] - model.mesh.x[q[1]][d];
        }
        const double area = 0.5 * std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                             a[0] * b[1] - a[1] * b[0]);
        exact += alpha * (su + gradient * std::max(0.0, -z)) * area;
    }
    CHECK(sum == Approx(exact).epsilon(1e-12));
    CHECK(set.max_friction.size() == set.nodes.size());
    // the deeper, the more of it per area
    std::size_t top = 0, bottom = 0;
    for (std::size_t i = 0; i < set.nodes.size(); ++i) {
        if (model.mesh.x[set.nodes[i]][2] > model.mesh.x[set.nodes[top]][2]) top = i;
        if (model.mesh.x[set.nodes[i]][2] < model.mesh.x[set.nodes[bottom]][2]) bottom = i;
    }
    CHECK(set.max_friction[bottom] / set.area[bottom] > set.max_friction[top] / set.area[top]);
}

TEST_CASE("contact forces have the same bits for one and two threads") {
    RoundSkirt scene(0.328);
    scene.c.info.gravity = {0, 0, -9.81};
    Structure one(build_model(scene.c, scene.mesh), 1);
    ContactBudget budget{one.pairs()[0].largest_step(), {}};
    budget.share.assign(one.pairs()[0].set().nodes.size(), 0.3);
    budget.surface_share = 0.3;
    budget.body_load = load_on_body(one.pairs()[0].set(), one.nodes(), one.bodies()[0]);
    const auto forces = [&](int threads) {
        Nodes nodes = one.nodes();
        std::vector<RigidBody> bodies;
        bodies.emplace_back(one.model().rigid[0], nodes);
        ContactPair pair(one.model().contacts[0], nodes, budget, threads);
        pair.balance(pressed(one, 5e3));
        for (std::size_t n = 0; n < nodes.size(); ++n)
            for (int d = 0; d < 3; ++d) nodes.v[n].c[d] = 0.1 * std::sin(3.0 * n + d);
        pair.evaluate(nodes, bodies, 1e-4);
        return nodes.f;
    };
    const NodeRows a = forces(1), b = forces(2);
    CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(NodeRow)) == 0);
}

TEST_CASE("springs of contact are stable at the step they were made for, on a light body too") {
    // Springs as stiff as the budget allows (the soil's own step, no case limit), all nodes shaken:
    // the energy of what is stored and moves must fall, by damping and friction, never grow.
    const double weight = GENERATE(1.0, 0.02);  // of steel: the body is lighter than the soil at it
    RoundSkirt scene(0.3);
    scene.c.fem.material[1].density *= weight;
    scene.c.fem.bulk_viscosity_linear = scene.c.fem.bulk_viscosity_quadratic = 0;
    Structure s(build_model(scene.c, scene.mesh), 1);
    CHECK(s.pairs()[0].softest() < 10);  // the budget does limit
    const_cast<ContactPair&>(s.pairs()[0]).balance(pressed(s, 5e4));
    const auto [early, late] = march_shaken(s, 10000);
    WARN("shaken skirt, body of " << s.bodies()[0].mass() << " kg: springs "
                                  << s.pairs()[0].softest() << " E A/h, energy " << early << " -> "
                                  << late << " J");
    CHECK(late <= early);
    CHECK(std::isfinite(late));
}

TEST_CASE("two deformable blocks press on each other with equal and opposite forces") {
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "low", {{0, 0, 0}, {0.6, 0.6, 0.3}}, {3, 3, 2});
    add_block(mesh, "high", {{0.1, 0.1, 0.31}, {0.5, 0.5, 0.6}}, {4, 4, 2});
    c.fem.part = {{"low", "soil"}, {"high", "soil"}};
    FemContact contact;
    contact.name = "joint";
    contact.nodes = "high.zmin";
    contact.surface = "low.zmax";
    contact.friction = 0.4;
    contact.gap = 0.01;
    c.fem.contact = {contact};
    Structure s(build_model(c, mesh), 1);
    Nodes& nodes = s.nodes();
    for (std::int32_t n : s.model().mesh.nodes_of("high", "test")) {
        nodes.v[n].c[2] = -0.2;
        nodes.v[n].c[1] = 0.1;
    }
    const double dt = s.stable_step().dt;
    Range balance;
    double most = 0;
    march(s, dt, 3000, [&](int) {
        most = std::max(most, s.pairs()[0].totals().normal_force);
        balance.add(s.energies().balance_error());
    });
    double p[3] = {}, mass = 0, high = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        mass += nodes.mass[n];
        for (int d = 0; d < 3; ++d) p[d] += nodes.mass[n] * nodes.v[n].c[d];
    }
    for (std::int32_t n : s.model().mesh.nodes_of("high", "test")) high += nodes.mass[n];
    CHECK(most > 0);
    CHECK(std::abs(p[2] + 0.2 * high) / mass < 1e-14);  // round-off
    CHECK(std::abs(p[1] - 0.1 * high) / mass < 1e-14);
    WARN("two blocks: balance error " << balance.width() << " of " << 0.5 * high * 0.05 << " J");
    CHECK(balance.width() < 5e-3 * 0.5 * high * 0.05);
}

TEST_CASE("contact sets that cannot work are refused in words") {
    BlockOnFloor turned(0.3);
    std::swap(turned.c.fem.contact[0].nodes, turned.c.fem.contact[0].surface);
    CHECK_THROWS_WITH(build_model(turned.c, turned.mesh), Catch::Contains("no deformable element"));
    BlockOnFloor far(0.3);
    far.c.fem.contact[0].gap = 0.001;
    CHECK_THROWS_WITH(Structure(build_model(far.c, far.mesh), 1),
                      Catch::Contains("no node of \"nodes\" is within 1.5 gaps"));
    BlockOnFloor eager(0.3);
    eager.c.fem.cfl = 0.999;
    CHECK_THROWS_WITH(Structure(build_model(eager.c, eager.mesh), 1),
                      Catch::Contains("fem.cfl = 0.999"));
    BlockOnFloor behind(0.3);
    map_nodes(behind.mesh, [](const Vec3& x) {
        return x[2] == 0 && std::abs(x[0]) < 0.3 && std::abs(x[1]) < 0.3 ? Vec3{x[0], x[1], -0.015}
                                                                         : x;
    });
    CHECK_THROWS_WITH(Structure(build_model(behind.c, behind.mesh), 1),
                      Catch::Contains("lies on or behind the surface"));
}

}  // namespace
}  // namespace undertow::fem
