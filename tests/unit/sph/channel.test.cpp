// Flow between no-slip planes against exact solutions: Newton, power law, Bingham,
// Herschel-Bulkley, two layers, and a wall set in motion.

#include <catch2/catch.hpp>
#include <cmath>

#include "scenes.hpp"
#include "sph_solver/physics/stable_step.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// Plates at z = -h and h, driven by a force G per volume; tau = tau_y + K gd^n.
///   plug |z| < z_y = tau_y/G:  u = n/(n+1) (G/K)^(1/n) (h - z_y)^(1+1/n), outside it less the same
///   of |z| - z_y
struct Channel {
    double G, tau_y, K, n, h;  // [N/m3], [Pa], [Pa s^n], [-], [m]
    double velocity(double z) const {
        const double plug = tau_y / G, e = 1 + 1 / n, a = n / (n + 1) * std::pow(G / K, 1 / n);
        const double beyond = std::max(0.0, std::abs(z) - plug);
        return a * (std::pow(h - plug, e) - std::pow(beyond, e));
    }
};

/// A strip between planes at low and high, periodic along x.
Case strip(double dx, double low, double high, const std::vector<Fluid>& fluids) {
    Case input;
    input.file = "channel";
    input.info.dimension = 2;
    input.info.gravity = {0, 0, 0};
    input.sph.present = true;
    input.sph.spacing = dx;
    input.sph.artificial_viscosity = 0;
    input.sph.fluid = fluids;
    const double length = 12 * dx;
    input.sph.domain = Box{{0, -1, low - dx}, {length, 1, high + dx}};
    input.sph.periodic = {"x"};
    for (std::size_t k = 0; k < fluids.size(); ++k) {
        Fill fill;
        fill.fluid = fluids[k].name;
        const double step = (high - low) / double(fluids.size());
        fill.box = {{0, 0, low + double(k) * step}, {length, dx, low + double(k + 1) * step}};
        input.sph.fill.push_back(fill);
    }
    input.sph.plane = {scenes::plane("low", {0, 0, low}, {0, 0, 1}, Slip::no_slip),
                       scenes::plane("high", {0, 0, high}, {0, 0, -1}, Slip::no_slip)};
    return input;
}

void run(FluidSystem& fluid, const Case& input, double end) {
    double t = 0, before = 0;
    Health health = fluid.health();
    while (t < end) {
        const double c0 = fluid.largest_sound_speed();
        const StableStep stable =
            stable_step({fluid.physics().h, c0, health.max_speed, health.max_acceleration,
                         health.max_kinematic_viscosity},
                        acoustic_cfl(input.sph), input.sph.force_cfl);
        const double dt = before > 0 ? std::min(stable.dt, 1.05 * before) : stable.dt;
        health = scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
}

/// sqrt( sum (u - exact)^2 / sum exact^2 )
template <class Exact>
double l2_error(const FluidSystem& fluid, Exact&& exact) {
    const Particles& p = fluid.particles;
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double u = exact(p.z[i]);
        difference += (p.vx[i] - u) * (p.vx[i] - u);
        size += u * u;
    }
    return std::sqrt(difference / size);
}

/// Started from the exact profile, after half a viscous time h^2/nu: long enough for an error of
/// the stress to have become one of the velocity (the slowest mode falls by 1 - exp(-pi^2/8) = 71
/// %).
/// cap [Pa s]: then the viscous forces are explicit, with that largest viscosity.
double channel_error(const Channel& exact, int across, double cap = 0) {
    const double top = exact.velocity(0), dx = 2 * exact.h / across;
    Fluid f;
    f.name = "f";
    f.density = 2.5 * exact.G * exact.h / (top * top);  // Re = rho V^2/(G h) = 2.5
    if (exact.tau_y == 0 && exact.n == 1)
        f.viscosity = exact.K;
    else
        f.yield_stress = exact.tau_y, f.consistency = exact.K, f.flow_index = exact.n;
    Case input = strip(dx, -exact.h, exact.h, {f});
    input.info.gravity = {exact.G / f.density, 0, 0};
    input.sph.max_speed = top;
    if (f.viscosity == 0) input.sph.viscosity_solver = ViscositySolver::implicit;
    if (cap > 0) {
        input.sph.viscosity_solver = ViscositySolver::explicit_sums;
        input.sph.fluid[0].max_viscosity = cap;
    }
    FluidSystem fluid(input, 0.4);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        fluid.particles.vx[i] = exact.velocity(fluid.particles.z[i]);
    const double mu = exact.G * exact.h * exact.h / (2 * top);
    run(fluid, input, 0.5 * f.density * exact.h * exact.h / mu);
    return l2_error(fluid, [&](double z) { return exact.velocity(z); });
}

}  // namespace

TEST_CASE(
    "Poiseuille flow of Newton, power-law, Bingham and Herschel-Bulkley fluids is the exact one") {
    struct Set {
        const char* name;
        Channel channel;
        double coarse, fine;  // L2 error at 10 and 20 particles across
    };
    // Measured at 10, 20, 40 across: see docs/theory.md. Limits leave a fifth; orders are above 1,
    // from 10 to 20 that of Bingham 0.84.
    const Set sets[] = {{"newton", {1, 0, 0.01, 1, 0.5}, 0.013, 0.0024},
                        {"power law", {1, 0, 0.1, 0.5, 0.5}, 0.029, 0.0085},
                        {"bingham", {1, 0.2, 0.1, 1, 0.5}, 0.03, 0.0165},
                        {"slurry", {200, 7.3, 3, 0.35, 0.1}, 0.048, 0.0176},
                        {"slide", {20000, 500, 429.74, 0.23, 0.1}, 0.061, 0.0255}};
    for (const Set& set : sets) {
        const double coarse = channel_error(set.channel, 10), fine = channel_error(set.channel, 20);
        INFO(set.name << ": L2 error " << coarse << " at 10, " << fine << " at 20 across");
        CHECK(coarse < set.coarse);
        CHECK(fine < set.fine);
        CHECK(std::log2(coarse / fine) > 0.8);
    }
}

TEST_CASE("explicit channel flow is as exact with the viscosity held for some steps") {
    // Steps of 1/4 to 1/10 of the hold. Measured 0.0193, 0.0131. (With the harmonic mean inside the
    // fluid 0.0399, 0.0208; with the rate found in every step 0.0400, 0.0208.)
    const Channel bingham{1, 0.2, 0.1, 1, 0.5};
    const double coarse = channel_error(bingham, 10, 3), fine = channel_error(bingham, 20, 3);
    INFO("L2 error " << coarse << " at 10, " << fine << " at 20 across");
    CHECK(coarse < 0.022);
    CHECK(fine < 0.015);
}

TEST_CASE("a wall set in motion drags the fluid along as Couette flow starts up") {
    const double gap = 0.2, speed = 0.1, nu = 1e-2;  // [m], [m/s], [m2/s]
    const ViscositySolver solver =
        GENERATE(ViscositySolver::explicit_sums, ViscositySolver::implicit);
    Fluid f;
    f.name = "f";
    f.density = 1000;
    f.viscosity = 1000 * nu;
    Case input = strip(0.01, 0, gap, {f});
    input.sph.max_speed = speed;
    input.sph.viscosity_solver = solver;
    input.sph.plane[1].velocity = {speed, 0, 0};
    FluidSystem fluid(input, 0.4);
    const double end = GENERATE(0.1, 1.0) * gap * gap / nu;
    run(fluid, input, end);
    const auto exact = [&](double z) {
        double u = z / gap;
        for (int k = 1; k < 60; ++k)
            u += 2 / (k * M_PI) * (k % 2 ? -1 : 1) * std::sin(k * M_PI * z / gap) *
                 std::exp(-k * k * M_PI * M_PI * nu * end / (gap * gap));
        return speed * u;
    };
    const double error = l2_error(fluid, exact);
    INFO("L2 error " << error);
    CHECK(error < 0.01);
}

TEST_CASE("the velocity between two layers under shear follows from their viscosities") {
    const double gap = 0.2, speed = 0.1;
    const auto [ratio, implicit] = GENERATE(std::make_pair(10.0, false), std::make_pair(10.0, true),
                                            std::make_pair(100.0, true));
    Fluid thick, thin;
    thick.name = "thick", thin.name = "thin";
    thick.density = thin.density = 1000;
    thick.viscosity = 100, thin.viscosity = 100 / ratio;  // [Pa s]
    Case input = strip(0.005, 0, gap, {thick, thin});
    input.sph.max_speed = 2 * speed;
    input.sph.viscosity_solver =
        implicit ? ViscositySolver::implicit : ViscositySolver::explicit_sums;
    input.sph.plane[1].velocity = {speed, 0, 0};
    // the same stress in both: the interface has speed/(1 + ratio)
    const double at_interface = speed / (1 + ratio);
    const auto exact = [&](double z) {
        return z < 0.5 * gap ? at_interface * z / (0.5 * gap)
                             : at_interface + (speed - at_interface) * (z / (0.5 * gap) - 1);
    };
    FluidSystem fluid(input, 0.4);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) p.vx[i] = exact(p.z[i]);
    run(fluid, input, (implicit ? 0.125 : 0.06) * gap * gap * 1000 / thin.viscosity);
    double slope = 0, size = 0;  // of the thick layer, through the wall at rest
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p.z[i] < 0.5 * gap) slope += p.vx[i] * p.z[i], size += p.z[i] * p.z[i];
    const double found = slope / size * 0.5 * gap;
    INFO("interface at " << found << " m/s, exact " << at_interface);
    // 0.3 to 0.43 % at 20 particles a layer, first order: pairs beyond the nearest meet the interface
    // off middle
    CHECK(found == Approx(at_interface).epsilon(0.006));
    CHECK(l2_error(fluid, exact) < 0.01);
}
