#include "sph_solver/physics/shifting.hpp"

#include <catch2/catch.hpp>

#include "scenes.hpp"
#include "sph_solver/physics/free_surface.hpp"
#include "sph_solver/physics/stable_step.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// Steps of two passes until `end`.
void run(FluidSystem& fluid, const Case& input, double end) {
    double t = 0, before = 0;
    Health health = fluid.health();
    while (t < end) {
        const StableStep step =
            stable_step({fluid.physics().h, fluid.fluid().c0, health.max_speed,
                         health.max_acceleration, health.max_kinematic_viscosity},
                        acoustic_cfl(input.sph), 0.25);
        health = scenes::two_pass_step(fluid, t, step.dt, before);
        REQUIRE(health.finite);
        before = step.dt;
    }
}

Case unit_square(int n) {
    Case input = scenes::water_box(1.0 / n, {1, 1, 1}, 2);
    input.info.gravity = {0, 0, 0};
    input.sph.smoothing_ratio = 1.5;
    input.sph.max_speed = 1;
    return input;
}

/// Root mean square error of the velocity at t = 1, over the exact largest speed, of a cell of
/// vortices [Taylor, Green 1937] at Re = 100 that starts from a disordered lattice.
double vortex_error(double shifting) {
    const int n = 24;
    Case input = unit_square(n);
    input.sph.shifting = shifting;
    input.sph.fluid[0].viscosity = 10;
    input.sph.plane = {scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                       scenes::plane("left", {0, 0, 0}, {1, 0, 0}),
                       scenes::plane("roof", {0, 0, 1}, {0, 0, -1}),
                       scenes::plane("right", {1, 0, 0}, {-1, 0, 0})};
    FluidSystem fluid(input, 0.4);
    scenes::disturb(fluid, 0.1, 0, 0);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.vx[i] = std::sin(M_PI * p.x[i]) * std::cos(M_PI * p.z[i]);
        p.vz[i] = -std::cos(M_PI * p.x[i]) * std::sin(M_PI * p.z[i]);
        p.drho[i] = fluid.fluid().deviation_at(
            250 * (std::cos(2 * M_PI * p.x[i]) + std::cos(2 * M_PI * p.z[i])));
    }
    run(fluid, input, 1);
    const double decay = std::exp(-2 * 0.01 * M_PI * M_PI);
    double error2 = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double x = M_PI * p.x[i], z = M_PI * p.z[i];
        error2 += std::pow(decay * std::sin(x) * std::cos(z) - p.vx[i], 2) +
                  std::pow(decay * std::cos(x) * std::sin(z) + p.vz[i], 2);
    }
    return std::sqrt(error2 / double(p.size())) / decay;
}

}  // namespace

TEST_CASE("shifting more than halves the error of vortices that turn particles over") {
    const double with = vortex_error(10), without = vortex_error(0);
    CAPTURE(with, without);
    CHECK(with < 0.5 * without);
    CHECK(with < 0.04);  // disorder and artificial viscosity at 24 particles across
}

TEST_CASE("a body that moves without strain is not shifted, however fast it moves") {
    Case input = unit_square(20);
    input.sph.shifting = 10;
    input.sph.fill[0].velocity = {3, 0, -1};
    FluidSystem fluid(input, 0.4);
    scenes::disturb(fluid, 0.1, 0, 0);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    find_free_surface(fluid.physics(), const_cast<Neighborhood&>(fluid.neighbors()));
    Shift shift;
    find_shift(fluid.physics(), fluid.neighbors(), 1e-3, shift);
    CHECK(shift.fastest == 0);
}

TEST_CASE("shifting leaves the free surface where it is") {
    const Vec3 size{0.4, 0.1, 0.4};
    Case input = scenes::water_box(0.02, size, 2);
    scenes::add_basin(input, size);
    input.sph.shifting = 10;
    FluidSystem fluid(input, 0.4);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.vx[i] = 10 * p.z[i];
        if (p.z[i] < 0.25) p.z[i] += (i % 3 - 1.0) * 0.004;   // uneven far below the surface
    }
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    Shift shift;
    find_shift(fluid.physics(), fluid.neighbors(), 1e-3, shift);
    double inside = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p.z[i] > size[2] - 0.03)
            CHECK(std::abs(shift.uz[i]) < 1e-5);  // [m/s] float32 of a drift of up to 0.3 m/s
        else
            inside = std::max(inside, double(std::abs(shift.uz[i])));
    CHECK(inside > 0.01);
}

TEST_CASE("a rotating square under tension neither clumps nor gains angular momentum") {
    const int n = 24;
    Case input = unit_square(n);
    input.sph.fluid[0].viscosity = 0;
    input.sph.shifting = 10;
    FluidSystem fluid(input, 0.4);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.vx[i] = p.z[i] - 0.5, p.vz[i] = 0.5 - p.x[i];
        // close to laplace(p) = 2 rho omega^2 with p = 0 on the edge: its first mode
        p.drho[i] = fluid.fluid().deviation_at(-1000 * 16 / std::pow(M_PI, 4) *
                                               std::sin(M_PI * p.x[i]) * std::sin(M_PI * p.z[i]));
    }
    const auto angular = [&] {
        double sum = 0;
        for (std::size_t i = 0; i < p.size(); ++i)
            sum += (p.z[i] - 0.5) * p.vx[i] - (p.x[i] - 0.5) * p.vz[i];
        return sum;
    };
    const double before = angular();
    run(fluid, input, 1.2);
    CHECK(angular() == Approx(before).epsilon(0.01));
    int clumped = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            clumped += std::hypot(p.x[i] - p.x[j], p.z[i] - p.z[j]) < 0.5 / n;
    CHECK(clumped < 0.05 * double(p.size()));
}
