// Loads and energies: pressure on a block, plates, energy balance, damping.

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);

TEST_CASE("a pressed block carries sigma = -p and its supports the force, on a distorted mesh") {
    BlockCase block{{1, 0.8, 1.2}, {3, 4, 3}};
    Case c = block.settings();
    c.fem.support = {{"zmin", {"z"}}, {"xmin", {"x"}}, {"ymin", {"y"}}};
    c.fem.pressure = {{"zmax", 1e3, 0.02}};
    c.fem.damping_alpha = 2000;
    Model model = build_model(c);
    distort(model.mesh, block, 0.1);
    Structure s(std::move(model), 1);
    march(s, s.stable_step().dt, 3000);
    const std::vector<double> stress = s.elements().stress();
    for (std::size_t e = 0; e < s.elements().size(); ++e)
        for (int k = 0; k < 6; ++k)  // strain 1e-6: finite-strain terms of that size, and decay
            CHECK(stress[6 * e + k] == Approx(k == 2 ? -1e3 : 0).margin(1e-2));
    s.internal_forces();
    s.pressure_forces(1);
    CHECK(s.reaction(s.model().supports[0])[2] == Approx(1e3 * 0.8).epsilon(1e-5));
    CHECK(s.displacement(std::int32_t(s.nodes().size()) - 1)[2] ==
          Approx(-1e3 / block.young_modulus * 1.2).epsilon(1e-5));
}

TEST_CASE("the ramp of a pressure rises smoothly and holds") {
    const PressureLoad load({}, 5, 2);
    CHECK(load.pressure(0) == 0);
    CHECK(load.pressure(1) == Approx(2.5));
    CHECK(load.pressure(1e-6) < 1e-10);
    CHECK(load.pressure(2) == 5);
    CHECK(load.pressure(9) == 5);
    CHECK(PressureLoad({}, 5, 0).pressure(0) == 5);
}

TEST_CASE("pressure on a closed surface has no resultant, however bent its facets") {
    BlockCase block{{1, 1, 1}, {3, 3, 3}};
    Case c = block.settings();
    for (const char* set : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
        c.fem.pressure.push_back({set, 1e6, 0});
    Structure s(build_model(c), 1);
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int d = 0; d < 3; ++d) nodes.x[n].c[d] += 0.1 * std::sin(7.0 * n + d);
    s.pressure_forces(0);
    for (int d = 0; d < 3; ++d) {
        double sum = 0, moment = 0;
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            const int a = (d + 1) % 3, b = (d + 2) % 3;
            sum += nodes.f[n].c[d];
            moment += nodes.x[n].c[a] * nodes.f[n].c[b] - nodes.x[n].c[b] * nodes.f[n].c[a];
        }
        CHECK(std::abs(sum) < 1e-9);  // of forces of size 1e5: round-off
        CHECK(std::abs(moment) < 1e-9);
    }
}

TEST_CASE("the energy balance of a beam under a pressure pulse closes over 10,000 steps") {
    BlockCase block{{1, 0.1, 0.1}, {20, 2, 2}};
    Case c = block.settings();
    const bool damped = GENERATE(false, true);
    c.info.gravity = {0, 0, -9.81};
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 2e4, 0.005}};  // bends it by a third of its depth
    if (damped) {
        c.fem.damping_alpha = 10;
        c.fem.bulk_viscosity_linear = 0.06;
        c.fem.bulk_viscosity_quadratic = 1.2;
    }
    Structure s(build_model(c), 1);
    double peak = 0, worst = 0, hourglass = 0, internal = 0, reach = 0;
    march(s, s.stable_step().dt, 10000, [&](int n) {
        if (n % 20 != 0) return;
        const Energies e = s.energies();
        peak = std::max({peak, e.kinetic, e.internal});
        internal = std::max(internal, e.internal + e.hourglass);
        hourglass = std::max(hourglass, e.hourglass);
        worst = std::max(worst, std::abs(e.balance_error()));
        reach = std::max(reach, s.largest_displacement());
    });
    WARN((damped ? "damped" : "undamped")
         << " beam, deflection " << reach << " m, balance error over peak energy " << worst / peak
         << ", hourglass share of the stored energy " << hourglass / internal);
    // the trapezoidal work of element and nodal forces differs by the strain of a step squared
    CHECK(worst / peak < 1e-4);
}

TEST_CASE("Rayleigh damping decays a mode at alpha/2") {
    BlockCase block{{1, 0.1, 0.1}, {10, 1, 1}};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x"}}, {"block", {"y", "z"}}};  // a bar: first mode at c/4L
    c.fem.damping_alpha = 50;
    Structure s(build_model(c), 1);
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        nodes.v[n].c[0] = 1e-4 * std::sin(0.5 * pi * nodes.x0[n].c[0]);
    const double dt = s.stable_step().dt;
    double start = 0, end = 0;
    const int steps = int(0.05 / dt);
    march(s, dt, steps, [&](int n) {
        const Energies e = s.energies();
        if (n == 0) start = e.kinetic + e.internal;
        if (n == steps - 1) end = e.kinetic + e.internal;
    });
    // energy decays at alpha; it ripples by alpha/(2 omega) = 1.4 % with the phase of the mode
    CHECK(std::log(start / end) == Approx(50 * (steps - 1) * dt).epsilon(0.02));
}

TEST_CASE("a clamped square plate one element thick sags as plate theory with shear says") {
    // w = 0.00126532 p a^4/D at the center (Timoshenko and Woinowsky-Krieger, table 35, more digits
    // from Taylor and Govindjee 2004); shear adds about 0.0736 p a^2/(kappa G t), the deflection of
    // a membrane under the same load with tension kappa G t: exact for the simply supported plate.
    const double a = 1, t = 0.05, E = 1e9, p = 10, nu = 0.3, kappa = 5.0 / 6;
    const double D = E * t * t * t / (12 * (1 - nu * nu)), G = E / (2 * (1 + nu));
    const double thin = 0.00126532 * p * a * a * a * a / D;
    const double thick = thin + 0.0736714 * p * a * a / (kappa * G * t);
    const auto sag = [&](int n) {  // a quarter of the plate
        BlockCase block{{a / 2, a / 2, t}, {n, n, 1}};
        Case c = block.settings();
        c.fem.support = {
            {"xmax", {"x", "y", "z"}}, {"ymax", {"x", "y", "z"}}, {"xmin", {"x"}}, {"ymin", {"y"}}};
        c.fem.pressure = {{"zmax", p, 0}};
        const double omega = 35.99 / (a * a) * std::sqrt(D / (block.density * t));
        c.fem.damping_alpha = 2 * omega;  // critical for the first mode
        Structure s(build_model(c), 1);
        const double dt = s.stable_step().dt;
        march(s, dt, int(12 / omega / dt));
        return -s.displacement(0)[2];
    };
    const double coarse = sag(5), fine = sag(10);
    WARN("clamped plate, t/a 1/20, one element thick: w over plate theory with shear: 10 x 10 "
         << coarse / thick << ", 20 x 20 " << fine / thick << " (shear adds " << thick / thin - 1
         << ")");
    CHECK(coarse == Approx(thick).epsilon(0.05));
    CHECK(fine == Approx(thick).epsilon(0.02));
}

}  // namespace
}  // namespace undertow::fem
