// Deformable shells in contact inside the mesh: both faces, as surface and as nodes.

#include <catch2/catch.hpp>
#include <cmath>

#include "fem_solver/settle.hpp"
#include "fem_solver/shells/turning_nodes.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

FemPart shell(const std::string& set, double thickness, const std::string& material = "steel") {
    FemPart part{set, material, ElementFormulation::shell};
    part.thickness = thickness;
    return part;
}

FemContact contact_of(const std::string& nodes, const std::string& surface, double gap,
                      double friction) {
    FemContact contact;
    contact.name = "faces";
    contact.nodes = nodes;
    contact.surface = surface;
    contact.friction = friction;
    contact.gap = gap;
    return contact;
}

/// Momentum and moment of momentum about the origin, spins of shell nodes included.
struct Momenta {
    double p[3] = {}, L[3] = {};
    explicit Momenta(Structure& s) {
        const Nodes& nodes = s.nodes();
        for (std::size_t n = 0; n < nodes.size(); ++n)
            for (int d = 0; d < 3; ++d) {
                const int a = (d + 1) % 3, b = (d + 2) % 3;
                p[d] += nodes.mass[n] * nodes.v[n].c[d];
                L[d] += nodes.mass[n] *
                        (nodes.x[n].c[a] * nodes.v[n].c[b] - nodes.x[n].c[b] * nodes.v[n].c[a]);
            }
        if (const TurningNodes* turning = s.elements().turning_nodes())
            for (std::size_t i = 0; i < turning->size(); ++i)
                for (int d = 0; d < 3; ++d) L[d] += turning->inertia[i] * turning->omega[i].c[d];
    }
};

double mean_x_velocity(const Structure& s) {
    double momentum = 0, mass = 0;
    for (std::int32_t n : s.model().mesh.nodes_of("block", "test")) {
        momentum += s.nodes().mass[n] * s.nodes().v[n].c[0];
        mass += s.nodes().mass[n];
    }
    return momentum / mass;
}

/// A block over a plate of shells that deform, the gap between its sole and the upper face.
struct BlockOnPlate {
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    explicit BlockOnPlate(double thickness, double side = 1, int shells = 10, double gap = 0.01) {
        add_block(mesh, "block", {{-0.2, -0.2, 0}, {0.2, 0.2, 0.2}}, {4, 4, 2});
        const double z = -gap - 0.5 * thickness;
        if (side > 0)
            add_sheet(mesh, "plate", {-1, -1, z}, {2, 0, 0}, {0, 2, 0}, shells);
        else
            add_sheet(mesh, "plate", {-1, -1, z}, {0, 2, 0}, {2, 0, 0}, shells);
        c.fem.part = {{"block", "soil"}, shell("plate", thickness)};
        c.fem.contact = {contact_of("block.zmin", "plate", gap, 0.328)};
    }
};

TEST_CASE("a block slides down a clamped plate of shells, on either of its faces") {
    // tan theta = 0.5, mu = 0.328: 1.5092 m/s2
    const double side = GENERATE(1.0, -1.0);
    BlockOnPlate scene(0.04, side);
    scene.c.fem.support = {{"plate", {"clamp"}}};
    scene.c.fem.part[1].material = "soil";  // its own step would be that of steel
    const double theta = std::atan(0.5), g = 9.81;
    scene.c.info.gravity = {0, 0, -g * std::cos(theta)};
    Structure s(build_model(scene.c, scene.mesh), 1);
    CHECK(s.pairs()[0].nodes_near() == 25);
    settle(s, {1e-6, 20000});
    set_gravity(s, {g * std::sin(theta), 0, -g * std::cos(theta)});
    const double dt = 0.9 * s.stable_step().dt;
    double v1 = 0, t1 = 0, v2 = 0, t2 = 0;
    const int steps = int(0.5 / dt);
    march(s, dt, steps, [&](int n) {
        const double when = double(n) / steps;
        if (when > 0.2 && when <= 0.4) v1 += mean_x_velocity(s), t1 += 1;
        if (when > 0.8) v2 += mean_x_velocity(s), t2 += 1;
    });
    const double a = (v2 / t2 - v1 / t1) / (0.6 * steps * dt);
    const double exact = g * (std::sin(theta) - 0.328 * std::cos(theta));
    WARN("block on deformable shells: " << a << " m/s2, exact " << exact);
    CHECK(a == Approx(exact).epsilon(0.005));
}

TEST_CASE("two blocks hit both faces of a free plate of shells: momenta are kept, energies close") {
    // as surface, and as nodes
    const bool shells_are_nodes = GENERATE(false, true);
    const double gap = 2e-3, t = 0.02, half = 0.5 * t + gap;
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "low", {{-0.2, -0.2, -half - 0.2}, {0.2, 0.2, -half}}, {4, 4, 2});
    add_block(mesh, "high", {{-0.25, -0.25, half}, {0.15, 0.15, half + 0.2}}, {3, 3, 2});
    if (shells_are_nodes)  // none may slide over a rim: what its spring holds would be lost
        add_sheet(mesh, "plate", {-0.15, -0.15, 0}, {0.2, 0, 0}, {0, 0.2, 0}, 3);
    else
        add_sheet(mesh, "plate", {-0.3, -0.3, 0}, {0.6, 0, 0}, {0, 0.6, 0}, 5);
    c.fem.part = {{"low", "soil"}, {"high", "soil"}, shell("plate", t, "soil")};
    for (const char* side : {"low.zmax", "high.zmin"})
        for (const Quad& q : mesh.facet_sets[side]) mesh.facet_sets["soles"].push_back(q);
    c.fem.contact = {shells_are_nodes ? contact_of("plate", "soles", gap, 0.4)
                                      : contact_of("soles", "plate", gap, 0.4)};
    c.fem.bulk_viscosity_linear = c.fem.bulk_viscosity_quadratic = 0;
    Structure s(build_model(c, mesh), 1);
    Nodes& nodes = s.nodes();
    for (const char* set : {"low", "high"})
        for (std::int32_t n : s.model().mesh.nodes_of(set, "test")) {
            const double sign = set[0] == 'l' ? 1 : -1;
            nodes.v[n].c[0] = 0.1 * sign;
            nodes.v[n].c[1] = 0.05;
            nodes.v[n].c[2] = 0.2 * sign;
        }
    const double dt = s.stable_step().dt;
    s.internal_forces();
    s.kick(dt);
    s.drift(dt);
    const Momenta before(s);
    double low = 1e300, high = -1e300, most = 0, peak = 0, friction = 0;
    march(s, dt, 4000, [&](int) {
        const Energies e = s.energies();
        peak = std::max(peak, e.kinetic);
        low = std::min(low, e.balance_error());
        high = std::max(high, e.balance_error());
        most = std::max(most, s.pairs()[0].totals().normal_force);
        friction = e.pair_friction;
    });
    const Momenta after(s);
    double scale = 0;  // of the moments that were exchanged
    for (int d = 0; d < 3; ++d) scale = std::max(scale, std::abs(before.L[d]));
    const double moment =
        std::max({std::abs(after.L[0] - before.L[0]), std::abs(after.L[1] - before.L[1]),
                  std::abs(after.L[2] - before.L[2])});
    const double momentum =
        std::max({std::abs(after.p[0] - before.p[0]), std::abs(after.p[1] - before.p[1]),
                  std::abs(after.p[2] - before.p[2])});
    WARN("plate of shells as " << (shells_are_nodes ? "nodes" : "surface") << ": largest force "
                               << most << " N, momentum off by " << momentum << " N s, moment by "
                               << moment << " of " << scale << ", balance error "
                               << (high - low) / peak << " of the peak energy, friction took "
                               << friction / peak << ", springs " << s.pairs()[0].softest());
    CHECK(most > 1000);
    CHECK(friction > 0);
    CHECK(momentum < 1e-12);  // of 12 N s: round-off of 4,000 steps
    CHECK(moment < 1e-13 * scale);
    CHECK((high - low) / peak < 5e-3);  // contact begins and ends between steps
}

TEST_CASE("a plate of shells squeezed between blocks is stable for 1e5 steps, light or heavy") {
    const double weight = GENERATE(1.0, 0.05);
    const bool shells_are_nodes = GENERATE(false, true);
    const double gap = 1e-3, t = 0.02, half = 0.5 * t + gap;
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "low", {{-0.2, -0.2, -half - 0.1}, {0.2, 0.2, -half}}, {3, 3, 1});
    add_block(mesh, "high", {{-0.2, -0.2, half}, {0.2, 0.2, half + 0.1}}, {2, 2, 1});
    add_sheet(mesh, "plate", {-0.25, -0.25, 0}, {0.5, 0, 0}, {0, 0.5, 0}, 3);
    FemMaterial light = c.fem.material[0];
    light.name = "light";
    light.density *= weight;
    light.young_modulus *= weight;  // as fast a wave, so that it has a say in the step
    c.fem.material.push_back(light);
    c.fem.part = {{"low", "soil"}, {"high", "soil"}, shell("plate", t, "light")};
    for (const char* side : {"low.zmax", "high.zmin"})
        for (const Quad& q : mesh.facet_sets[side]) mesh.facet_sets["soles"].push_back(q);
    c.fem.contact = {shells_are_nodes ? contact_of("plate", "soles", gap, 0.3)
                                      : contact_of("soles", "plate", gap, 0.3)};
    c.fem.support = {{"low.zmin", {"x", "y", "z"}}, {"high.zmax", {"x", "y", "z"}}};
    c.fem.bulk_viscosity_linear = c.fem.bulk_viscosity_quadratic = 0;
    Structure s(build_model(c, mesh), 1);
    Nodes& nodes = s.nodes();
    const ContactSet& set = s.pairs()[0].set();
    NodeRows load(nodes.size());
    if (!shells_are_nodes)
        for (std::size_t i = 0; i < set.nodes.size(); ++i)
            load[set.nodes[i]].c[2] =
                (nodes.x[set.nodes[i]].c[2] > 0 ? -1e3 : 1e3) * weight * set.area[i];
    const_cast<ContactPair&>(s.pairs()[0]).balance(load);
    const auto [early, late] = march_shaken(s, 100000);
    WARN("squeezed plate of shells as "
         << (shells_are_nodes ? "nodes" : "surface") << ", density times " << weight << ": springs "
         << s.pairs()[0].softest() << ", energy " << early << " -> " << late << " J");
    CHECK(std::isfinite(late));
    CHECK(late <= early);
}

TEST_CASE("nodes pressed through a wall thinner than their depth come back on their own side") {
    const double thickness = 1e-3, pressure = 1e5;
    const double gap = 1e-4;
    BlockOnPlate scene(thickness, 1, 10, gap);
    scene.c.fem.part[1].material = "soil";
    scene.c.fem.support = {{"plate", {"clamp"}}};
    scene.c.fem.pressure = {{"block.zmax", pressure, 0.02}};
    scene.c.fem.damping_alpha = 300;
    Structure s(build_model(scene.c, scene.mesh), 1);
    const double dt = s.stable_step().dt;
    march(s, dt, int(0.15 / dt));
    double shallowest = 1e9;
    for (std::int32_t n : s.pairs()[0].set().nodes)
        shallowest = std::min(shallowest, -gap - s.nodes().x[n].c[2]);
    const ContactTotals& totals = s.pairs()[0].totals();
    WARN("pressed through a wall of " << thickness << " m: at least " << shallowest
                                      << " m behind its face, force " << totals.force[2] << " of "
                                      << 0.16 * pressure << " N");
    CHECK(shallowest > 1.5 * thickness);  // out on the other side
    CHECK(totals.touching == 25);
    CHECK(totals.force[2] == Approx(0.16 * pressure).epsilon(0.01));
}

TEST_CASE("a block that falls on a roof of shells is thrown back, and the energies close") {
    BlockOnPlate scene(0.02, 1, 8);
    map_nodes(scene.mesh, [](const Vec3& x) {  // 30 mm above where it would touch
        return x[2] < -0.01 ? x : Vec3{x[0], x[1], x[2] + 0.03};
    });
    scene.c.fem.contact[0].near = 0.045;
    for (const std::array<double, 2>& at : {std::array{-1.0, -1.0}, {1.0, 1.0}})
        for (int k = 0; k < 2; ++k)
            for (std::size_t n = 0; n < scene.mesh.x.size(); ++n)
                if (scene.mesh.x[n][2] < -0.01 && std::abs(scene.mesh.x[n][k] - at[k]) < 1e-9)
                    scene.mesh.node_sets["edge"].push_back(std::int32_t(n));
    auto& edge = scene.mesh.node_sets["edge"];
    std::sort(edge.begin(), edge.end());
    edge.erase(std::unique(edge.begin(), edge.end()), edge.end());
    scene.c.fem.support = {{"edge", {"clamp"}}};
    scene.c.info.gravity = {0, 0, -9.81};
    Structure s(build_model(scene.c, scene.mesh), 1);
    const double dt = s.stable_step().dt;
    double down = 0, up = 0, low = 1e300, high = -1e300, peak = 0, sag = 0, most = 0;
    march(s, dt, int(0.2 / dt), [&](int) {
        double momentum = 0, mass = 0;
        for (std::int32_t n : s.model().mesh.nodes_of("block", "test")) {
            momentum += s.nodes().mass[n] * s.nodes().v[n].c[2];
            mass += s.nodes().mass[n];
        }
        down = std::min(down, momentum / mass);
        if (most > 0) up = std::max(up, momentum / mass);
        most = std::max(most, s.pairs()[0].totals().normal_force);
        const Energies e = s.energies();
        peak = std::max(peak, e.kinetic);
        low = std::min(low, e.balance_error());
        high = std::max(high, e.balance_error());
        for (std::int32_t n : s.model().mesh.nodes_of("plate", "test"))
            sag = std::min(sag, s.nodes().x[n].c[2] - s.nodes().x0[n].c[2]);
    });
    WARN("block of 64 kg on a roof of shells: "
         << down << " m/s down, " << up << " m/s up, largest force " << most << " N, sag " << -sag
         << " m, balance error " << (high - low) / peak << " of the peak energy");
    CHECK(down == Approx(-std::sqrt(2 * 9.81 * 0.03)).epsilon(0.03));
    CHECK(most > 10 * 64 * 9.81);
    CHECK(up > 0.1);
    CHECK(up < -down);
    CHECK(sag < -1e-3);
    CHECK((high - low) / peak < 5e-3);
}

TEST_CASE("contact sets of shells that cannot work are refused in words") {
    BlockOnPlate mixed(0.04);
    for (const Quad& q : mixed.mesh.facet_sets["block.zmax"])
        mixed.mesh.facet_sets["plate"].push_back(q);
    CHECK_THROWS_WITH(build_model(mixed.c, mixed.mesh),
                      Catch::Contains("shells that deform and other facets"));
    BlockOnPlate turned(0.04);
    Quad& q = turned.mesh.facet_sets["plate"][0];
    std::swap(q[1], q[3]);
    CHECK_THROWS_WITH(build_model(turned.c, turned.mesh),
                      Catch::Contains("look against each other"));
}

}  // namespace
}  // namespace undertow::fem
