#include <omp.h>

#include <catch2/catch.hpp>

#include "scenes.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

FluidSystem disturbed_blob(Kernel kernel, int dimension,
                           TensionControl control = TensionControl::switched,
                           bool gradient_correction = false,
                           Precision precision = Precision::float32) {
    Case input = scenes::water_box(0.01, {0.12, 0.1, 0.11}, dimension);
    input.sph.kernel = kernel;
    input.sph.tension_control = control;
    input.sph.gradient_correction = gradient_correction;
    input.sph.precision = precision;
    input.sph.artificial_viscosity = 0.1;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.15, 1, 2000);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    return fluid;
}

}  // namespace

TEST_CASE("pair forces conserve momentum to round-off") {
    const Kernel kernel =
        GENERATE(Kernel::wendland_c2, Kernel::wendland_c4, Kernel::cubic_spline);
    const TensionControl control = GENERATE(TensionControl::none, TensionControl::spray);
    const Precision precision = GENERATE(Precision::float32, Precision::float64);
    FluidSystem fluid = disturbed_blob(kernel, GENERATE(2, 3), control, false, precision);
    fluid.sum_over_neighbors(Terms::both);
    const Particles& p = fluid.particles;
    double sum[3] = {0, 0, 0}, magnitude = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        sum[0] += p.ax[i], sum[1] += p.ay[i], sum[2] += p.az[i];
        magnitude += std::abs(p.ax[i]) + std::abs(p.ay[i]) + std::abs(p.az[i]);
    }
    // float32 sums of some 60 terms, and a 14-bit reciprocal that is the same for both of a pair
    // only to 6e-5 of the artificial viscosity: random, so far below 1e-6 of the sum of magnitudes;
    // in double round-off alone
    const double round_off = precision == Precision::float64 ? 1e-15 : 1e-6;
    for (const double s : sum) CHECK(std::abs(s) < round_off * magnitude);
}

TEST_CASE("the fast sums, in float and in double, agree with the reference of one pair at a time") {
    const Kernel kernel =
        GENERATE(Kernel::wendland_c2, Kernel::wendland_c4, Kernel::cubic_spline);
    const Precision precision = GENERATE(Precision::float32, Precision::float64);
    const bool correction = GENERATE(false, true);
    FluidSystem fluid =
        disturbed_blob(kernel, GENERATE(2, 3), TensionControl::switched, correction, precision);
    fluid.sum_over_neighbors(Terms::both);
    const auto [rate, a, shear] = sum_over_neighbors_reference(fluid.physics(), fluid.neighbors());
    double largest_rate = 0, largest_a = 0, rate_error = 0, a_error = 0;
    for (std::size_t i = 0; i < rate.size(); ++i) {
        largest_rate = std::max(largest_rate, std::abs(rate[i]));
        rate_error = std::max(rate_error, std::abs(rate[i] - fluid.particles.drho_dt[i]));
        const double fast[3] = {fluid.particles.ax[i], fluid.particles.ay[i], fluid.particles.az[i]};
        for (int k = 0; k < 3; ++k) {
            largest_a = std::max(largest_a, std::abs(a[i][k]));
            a_error = std::max(a_error, std::abs(a[i][k] - fast[k]));
        }
    }
    REQUIRE(largest_a > 10);                // [m/s2] there is something to compare
    if (precision == Precision::float64) {  // sums of some 60 terms in another order
        CHECK(rate_error < 1e-13 * largest_rate);
        CHECK(a_error < 1e-13 * largest_a);
        return;
    }
    // corrected: float32 through the inverse of a 3 x 3 matrix
    CHECK(rate_error < (correction ? 1e-4 : 1e-5) * largest_rate);
    CHECK(a_error < 1e-4 * largest_a);   // the 14-bit reciprocal of the artificial viscosity
}

TEST_CASE("rate and force passes give together what the single pass gives") {
    const Kernel kernel =
        GENERATE(Kernel::wendland_c2, Kernel::wendland_c4, Kernel::cubic_spline);
    FluidSystem fluid = disturbed_blob(kernel, 3, TensionControl::switched, false,
                                       GENERATE(Precision::float32, Precision::float64));
    fluid.sum_over_neighbors(Terms::both);
    const Particles both = fluid.particles;
    fluid.sum_over_neighbors(Terms::rate);
    fluid.sum_over_neighbors(Terms::force);
    CHECK(both.drho_dt == fluid.particles.drho_dt);
    CHECK(both.ax == fluid.particles.ax);
}

TEST_CASE("the sum of forces leaves out entries that give exactly nothing, until something moves") {
    FluidSystem fluid =
        disturbed_blob(Kernel::wendland_c2, 3, TensionControl::none, false,
                       GENERATE(Precision::float32, Precision::float64));
    const Neighborhood& near = fluid.neighbors();
    const auto marked = [&] {
        std::int64_t count = 0;
        for (int c = 0; c < near.fluid_lists().clusters(); ++c)
            for (int k = 0; k < near.fluid_lists().end(c) - near.fluid_lists().begin(c); ++k)
                count += near.marked().of(c)[k / 64] >> (k % 64) & 1;
        return count;
    };
    const std::int64_t all = near.fluid_lists().entries();
    fluid.sum_over_neighbors(Terms::force);
    CHECK(marked() == all);   // nobody has looked yet
    const Particles full = fluid.particles;
    fluid.sum_over_neighbors(Terms::rate);
    CHECK(marked() < 0.9 * all);   // lists reach 0.2 dx beyond the support of 2.4 dx
    fluid.sum_over_neighbors(Terms::force);
    CHECK(full.ax == fluid.particles.ax);
    CHECK(full.ay == fluid.particles.ay);
    CHECK(full.az == fluid.particles.az);

    // pairs that were too far apart come into reach, within the skin of the lists
    scenes::disturb(fluid, 0.05, 1, 2000);
    fluid.moved(0.0005);
    CHECK_FALSE(fluid.refresh_neighbors(0));
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::force);
    const Particles again = fluid.particles;
    fluid.sum_over_neighbors(Terms::both);
    CHECK(again.ax == fluid.particles.ax);
}

TEST_CASE("sums have the same bits for one thread and for two") {
    FluidSystem fluid = disturbed_blob(Kernel::wendland_c2, 3, TensionControl::switched, false,
                                       GENERATE(Precision::float32, Precision::float64));
    omp_set_num_threads(1);
    fluid.sum_over_neighbors(Terms::both);
    const Particles one = fluid.particles;
    omp_set_num_threads(2);
    fluid.sum_over_neighbors(Terms::both);
    CHECK(one.ax == fluid.particles.ax);
    CHECK(one.drho_dt == fluid.particles.drho_dt);
}

TEST_CASE("uniform motion changes neither density nor velocity") {
    Case input = scenes::water_box(0.01, {0.1, 0.1, 0.1});
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 3;
    input.sph.fill[0].velocity = {3, -1, 2};
    input.sph.precision = GENERATE(Precision::float32, Precision::float64);
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::both);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        CHECK(fluid.particles.drho_dt[i] == 0);
        CHECK(fluid.particles.ax[i] == 0);
    }
}

TEST_CASE("a uniform expansion thins the fluid at three times its rate") {
    Case input = scenes::water_box(0.01, {0.14, 0.14, 0.14});
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;
    input.sph.density_diffusion = 0;
    FluidSystem fluid(input, 0.2);
    const double rate = 2;   // [1/s]
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i)
        p.vx[i] = rate * p.x[i], p.vy[i] = rate * p.y[i], p.vz[i] = rate * p.z[i];
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::both);
    // h = 1.2 dx on a lattice: the uncorrected gradient of a linear field is off by up to 2 %
    for (std::size_t i = 0; i < p.size(); ++i)
        if (std::abs(p.x[i] - 0.07) < 0.04 && std::abs(p.y[i] - 0.07) < 0.04 &&
            std::abs(p.z[i] - 0.07) < 0.04)
            CHECK(p.drho_dt[i] == Approx(-3 * rate * 1000).epsilon(0.02));
}

TEST_CASE("with the gradient corrected an expansion is exact in disorder") {
    const int dimension = GENERATE(2, 3);
    Case input = scenes::water_box(0.01, {0.14, 0.14, 0.14}, dimension);
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;
    input.sph.density_diffusion = 0;
    input.sph.gradient_correction = true;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.2, 0, 0);
    const double rate = 2;  // [1/s]
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.vx[i] = rate * p.x[i] + 3 * p.z[i], p.vz[i] = rate * p.z[i] - 5 * p.x[i];
        if (dimension == 3) p.vy[i] = rate * p.y[i];
    }
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(GENERATE(Terms::rate, Terms::both));
    const auto inside = [](double x) { return x > 0.03 && x < 0.11; };
    for (std::size_t i = 0; i < p.size(); ++i) {
        // at the free surface it is left as it is
        if (!inside(p.x[i]) || !inside(p.z[i]) || !(dimension == 2 || inside(p.y[i]))) continue;
        CHECK(p.drho_dt[i] == Approx(-dimension * rate * 1000).epsilon(1e-4));
    }
}
