// Where sums in float lose their digits: sph.precision = "float" against "double" for one and the
// same state, a cube of N^3 particles disordered by 0.15 dx.
//
//   domain  a lone particle D spacings away: the fixed point of positions has 2^30 units for the
//   scene depth   the cube under H spacings of water: forces are differences of pressures rho g H
//   speed   the cube moves as a whole: rates are differences of velocities
//
//   bench_sph_precision [N]      default 16
// Errors are rms over all particles: of accelerations in g, of d(rho)/dt relative to its rms.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "sph_solver/fluid_system.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double dx = 0.01, g = 9.81;  // [m], [m/s2]

struct State {
    double domain = 0;  // [dx]
    double depth = 0;   // [dx]
    double speed = 0;   // [m/s]
};

FluidSystem sums(int n, const State& state, Precision precision) {
    Case c;
    c.file = "bench";
    c.sph.present = true;
    c.sph.spacing = dx;
    c.sph.max_speed = 10;
    c.sph.precision = precision;
    Fluid water;
    water.name = "water";
    water.density = 1000;
    water.viscosity = 1e-3;
    // deep water is not to be compressed by what is compared here
    water.sound_speed = std::max(100.0, 20 * std::sqrt(g * dx * state.depth));
    c.sph.fluid = {water};
    Fill fill;
    fill.fluid = "water";
    fill.box = {{0, 0, 0}, {n * dx, n * dx, n * dx}};
    c.sph.fill = {fill};
    FluidSystem fluid(c, 0.2);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in(-1, 1);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.x[i] += 0.15 * dx * in(random);
        p.y[i] += 0.15 * dx * in(random);
        p.z[i] += 0.15 * dx * in(random);
        p.vx[i] = 0.1 * in(random) + state.speed;
        p.vy[i] = 0.1 * in(random);
        p.vz[i] = 0.1 * in(random);
        p.drho[i] = fluid.fluid().deviation_at(1000 * g * (state.depth * dx + n * dx - p.z[i]));
    }
    if (state.domain > 0) p.x[0] -= state.domain * dx;
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::both);
    return fluid;
}

void compare(const char* name, double value, int n, const State& state) {
    const FluidSystem close = sums(n, state, Precision::float32);
    const FluidSystem exact = sums(n, state, Precision::float64);
    const Particles &p = close.particles, &q = exact.particles;
    double a = 0, a_all = 0, rate = 0, rate_all = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double d[3] = {p.ax[i] - q.ax[i], p.ay[i] - q.ay[i], p.az[i] - q.az[i]};
        a += d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        a_all += q.ax[i] * q.ax[i] + q.ay[i] * q.ay[i] + q.az[i] * q.az[i];
        rate += std::pow(p.drho_dt[i] - q.drho_dt[i], 2);
        rate_all += q.drho_dt[i] * q.drho_dt[i];
    }
    const double count = double(p.size());
    std::printf("%-7s %9.3g | a: %.2e g of %.2e g | d(rho)/dt: %.2e of %.2e kg/m3/s, %.2e\n", name,
                value, std::sqrt(a / count) / g, std::sqrt(a_all / count) / g,
                std::sqrt(rate / count), std::sqrt(rate_all / count), std::sqrt(rate / rate_all));
}

}  // namespace

int main(int argc, char** argv) {
    const int n = argc > 1 ? std::atoi(argv[1]) : 16;
    for (const double d : {0.0, 1e2, 1e3, 1e4, 1e5}) compare("domain", d, n, {.domain = d});
    for (const double h : {0.0, 1e1, 1e2, 1e3, 1e4}) compare("depth", h, n, {.depth = h});
    for (const double v : {0.0, 1.0, 10.0, 100.0}) compare("speed", v, n, {.speed = v});
}
