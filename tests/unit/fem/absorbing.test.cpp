// The far field: what leaves does not come back, and what was at rest stays there.

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"

namespace undertow::fem {
namespace {

enum class Wave { pressure, shear };

struct Outcome {
    double reflection;  // largest velocity left over that of a pulse on its way
    double balance;     // change of the energy balance over the energy of the start
    double absorbed;    // share of it that the far field has taken
};

/// A Gaussian velocity (sigma in elements) in the middle of a bar with a far field at both ends
/// parts into two pulses, which leave.
Outcome pulse_in_bar(Wave wave, double sigma, double cfl) {
    const int n_elements = 240, along = wave == Wave::pressure ? 0 : 1;
    const double h = 0.01;
    BlockCase block{{n_elements * h, h, h}, {n_elements, 1, 1}};
    Case c = block.settings();
    c.fem.cfl = cfl;
    if (wave == Wave::pressure)
        c.fem.support = {{"block", {"y", "z"}}};
    else
        c.fem.support = {{"block", {"x", "z"}}};
    c.fem.absorbing = {{"xmin"}, {"xmax"}};
    Structure s(build_model(c), 1);
    s.release_far_field();
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double X = (nodes.x0[n].c[0] / h - n_elements / 2) / sigma;
        nodes.v[n].c[along] = 1e-6 * std::exp(-0.5 * X * X);
    }
    const LinearElastic law = LinearElastic::from_young(block.young_modulus, block.poisson_ratio);
    const double speed =
        std::sqrt((wave == Wave::pressure ? law.lambda + 2 * law.mu : law.mu) / block.density);
    const double dt = s.stable_step().dt;
    Energies first, last;
    march(s, dt, int(1.5 * n_elements / 2 * h / speed / dt), [&](int n) {
        if (n == 0) first = s.energies();
        last = s.energies();
    });
    double left = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        left = std::max(left, std::abs(nodes.v[n].c[along]));
    const double energy = first.kinetic + first.internal;
    return {left / 0.5e-6, (last.balance_error() - first.balance_error()) / energy,
            last.far_field / energy};
}

TEST_CASE("pressure and shear waves that meet the far field head on do not come back") {
    const Wave wave = GENERATE(Wave::pressure, Wave::shear);
    const double sigma = GENERATE(10.0, 5.0), cfl = GENERATE(0.5, 0.9);
    const Outcome o = pulse_in_bar(wave, sigma, cfl);
    WARN((wave == Wave::pressure ? "P" : "S")
         << " wave, sigma " << sigma << " elements, cfl " << cfl << ": reflection " << o.reflection
         << ", balance " << o.balance);
    // second order in the elements per length: a quarter of that of 5 elements at 10
    CHECK(o.reflection < (sigma == 10 ? 1e-3 : 4e-3));
    CHECK(o.absorbed == Approx(1).epsilon(1e-4));
    CHECK(std::abs(o.balance) < 1e-5);
}

/// A quarter of a soil block: symmetry planes at xmin and ymin, far field at the other sides and
/// below.
Case soil_block(double K0) {
    BlockCase block{{4, 4, 3}, {4, 4, 6}, 4.77e6, 0.49, 1846};
    Case c = block.settings();
    c.fem.block->box = {{0, 0, -3}, {4, 4, 0}};
    c.info.gravity = {0, 0, -9.81};
    c.fem.material[0].kind = MaterialKind::tresca;
    c.fem.material[0].shear_strength = 9540;
    c.fem.material[0].weight_density = 846;
    c.fem.geostatic = FemGeostatic{"block", 0, K0};
    c.fem.support = {{"xmin", {"x"}}, {"ymin", {"y"}}};
    c.fem.absorbing = {{"xmax"}, {"ymax"}, {"zmin"}};
    return c;
}

TEST_CASE("soil in its geostatic stress stays at rest on a far field that was let go") {
    const double K0 = GENERATE(0.5, 1.0);
    Structure s(build_model(soil_block(K0)), 1);
    s.release_far_field();
    march(s, s.stable_step().dt, 20000);
    // settlement of a column under the same weight: gamma H^2/(2 M), 4.6e-4 m
    const double settlement = 846 * 9.81 * 9 / (2 * 8.2e7);
    WARN("K0 " << K0 << ": drift after 20,000 steps " << s.largest_displacement() << " m");
    CHECK(s.largest_displacement() < 1e-9 * settlement);  // round-off of the stresses
}

TEST_CASE("a column that settled on a held far field keeps its reaction when it is let go") {
    Case c = soil_block(1);
    c.fem.geostatic.reset();
    c.fem.material[0].kind = MaterialKind::linear_elastic;
    c.fem.support.push_back({"xmax", {"x"}});
    c.fem.support.push_back({"ymax", {"y"}});
    c.fem.absorbing = {{"zmin"}};
    c.fem.damping_alpha = 100;  // near the critical 2 x 110 1/s of the first mode
    Structure s(build_model(c), 1);
    const double dt = s.stable_step().dt;
    march(s, dt, 4000);
    const double settlement = s.largest_displacement();
    CHECK(settlement == Approx(846 * 9.81 * 9 / (2 * 8.2e7)).epsilon(0.02));
    for (NodeRow& v : s.nodes().v) v = NodeRow{};
    s.release_far_field();
    double lowest = 0;
    march(s, s.stable_step().dt, 20000,
          [&](int) { lowest = std::max(lowest, std::abs(s.displacement(0)[2])); });
    WARN("settlement " << settlement << " m, its base moves " << lowest << " m in 20,000 steps");
    CHECK(s.largest_displacement() == Approx(settlement).epsilon(1e-6));
    CHECK(lowest < 1e-6 * settlement);
}

TEST_CASE("energy given to soil is found again: stored, plastic, or gone with the far field") {
    Case c = soil_block(1);
    c.fem.pressure = {{"zmax", 2e4, 0.05}};
    Structure s(build_model(c), 1);
    s.release_far_field();
    const double dt = s.stable_step().dt;
    Energies e;
    for (NodeRow& v : s.nodes().v) v.c[0] = 0;
    march(s, dt, int(0.4 / dt), [&](int) { e = s.energies(); });
    CHECK(e.far_field > 0.05 * std::abs(e.external));
    CHECK(std::abs(e.balance_error()) < 1e-4 * std::abs(e.far_field + e.internal));
}

struct Push {
    double u, growth;  // [m] of the pushed soil after 1.2 s, and its change in the last 0.3 s
    double balance;    // error over the work done
};

/// Half a soil box of 12 x 6 x 6 m whose middle is pushed sideways with 30 kN that stay.
Push push_sideways(std::optional<Vec3> center) {
    const double h = 0.75;
    BlockCase block{{12, 6, 6}, {16, 8, 8}, 4.77e6, 0.49, 1846};
    Case c = block.settings();
    c.fem.block->box = {{-6, 0, -6}, {6, 6, 0}};
    c.fem.support = {{"ymin", {"y"}}};
    for (const char* set : {"xmin", "xmax", "ymax", "zmin"})
        c.fem.absorbing.push_back({set, center});
    Structure s(build_model(c), 1);
    s.release_far_field();
    Nodes& nodes = s.nodes();
    std::vector<std::int32_t> pushed;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double* x = nodes.x0[n].c;
        if (x[2] > -2.3 && std::hypot(x[0], x[1]) < 1.5 * h + 0.1)
            pushed.push_back(std::int32_t(n));
    }
    const auto mean = [&] {
        double u = 0;
        for (std::int32_t n : pushed) u += s.displacement(n)[0] / double(pushed.size());
        return u;
    };
    const double dt = s.stable_step().dt;
    double at_900 = 0, work = 0;
    Energies e;
    for (int n = 0; n * dt < 1.2; ++n) {
        s.internal_forces();
        const double force = 3e4 * std::min(1.0, n * dt / 0.2) / double(pushed.size());
        for (std::int32_t i : pushed) {
            nodes.f[i].c[0] += force;
            if (n > 0) work += 0.5 * dt * force * nodes.v[i].c[0];
        }
        s.kick(dt);
        e = s.energies();
        if (n * dt < 1.2 - dt)
            for (std::int32_t i : pushed) work += 0.5 * dt * force * nodes.v[i].c[0];
        s.drift(dt);
        if (n * dt < 0.9) at_900 = mean();
    }
    return {mean(), mean() - at_900, (e.balance_error() - work) / work};
}

TEST_CASE("springs stand for the soil beyond: a load that stays finds its rest") {
    const Push alone = push_sideways({}), supported = push_sideways(Vec3{0, 0, 0});
    WARN("pushed by 30 kN: " << 1e3 * alone.u << " mm, growing by " << 1e3 * alone.growth
                             << " mm in 0.3 s, on dashpots alone; " << 1e3 * supported.u
                             << " mm and " << 1e3 * supported.growth << " mm with springs");
    CHECK(alone.growth > 0.05 * alone.u);
    CHECK(std::abs(supported.growth) < 0.015 * supported.u);  // the last of the ringing
    CHECK(std::abs(supported.balance) < 1e-3);  // the last half step of the work done here
    CHECK(std::abs(alone.balance) < 1e-3);
}

TEST_CASE("only faces of elements can absorb") {
    Case c = soil_block(1);
    c.fem.absorbing = {{"zmax"}};
    Mesh mesh = build_model(c).mesh;
    CHECK_FALSE(make_far_field(c.fem, mesh, build_model(c).parts).empty());
    mesh.facet_sets["zmax"][0] = {0, 1, 2, 3};
    CHECK_THROWS_WITH(make_far_field(c.fem, mesh, build_model(c).parts),
                      Catch::Contains("fem.absorbing") && Catch::Contains("not a face"));
}

}  // namespace
}  // namespace undertow::fem
