// Several fluids in one sum over neighbors.

#include <omp.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "scenes.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// Two fluids, disordered, in motion; the viscosities found in a first sum are in force.
FluidSystem disturbed_layers(Kernel kernel, int dimension, bool viscoplastic,
                             TensionControl control = TensionControl::switched,
                             Precision precision = Precision::float32) {
    Case input = scenes::two_layers(0.01, {0.12, 0.1, 0.11}, 0.05, viscoplastic, dimension);
    input.sph.kernel = kernel;
    input.sph.tension_control = control;
    input.sph.precision = precision;
    input.sph.artificial_viscosity = 0.1;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.15, 1, 2000);
    fluid.refresh_neighbors(0);
    for (int k = 0; k < 2; ++k) {
        fluid.pack(0);
        fluid.sum_over_neighbors(Terms::both);
    }
    return fluid;
}

struct Largest {
    double value = 0, error = 0;
    void compare(double exact, double found) {
        value = std::max(value, std::abs(exact));
        error = std::max(error, std::abs(exact - found));
    }
};

}  // namespace

TEST_CASE("pair forces between two fluids conserve momentum to round-off") {
    const Kernel kernel =
        GENERATE(Kernel::wendland_c2, Kernel::wendland_c4, Kernel::cubic_spline);
    const bool viscoplastic = GENERATE(false, true);
    const Precision precision = GENERATE(Precision::float32, Precision::float64);
    FluidSystem fluid =
        disturbed_layers(kernel, GENERATE(2, 3), viscoplastic, TensionControl::spray, precision);
    const Particles& p = fluid.particles;
    double sum[3] = {0, 0, 0}, magnitude = 0, on_water = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double m = fluid.fluid_of(i).mass;
        sum[0] += m * p.ax[i], sum[1] += m * p.ay[i], sum[2] += m * p.az[i];
        magnitude += m * (std::abs(p.ax[i]) + std::abs(p.ay[i]) + std::abs(p.az[i]));
        if (p.fluid[i] == 0) on_water += m * p.az[i];
    }
    // as for one fluid: float32 sums of some 60 terms and a 14-bit reciprocal, or round-off
    const double round_off = precision == Precision::float64 ? 1e-15 : 1e-6;
    for (const double s : sum) CHECK(std::abs(s) < round_off * magnitude);
    CHECK(std::abs(on_water) > 1e-3 * magnitude);  // there is something to be balanced
}

TEST_CASE("the fast sums over two fluids, in float and in double, agree with the reference") {
    const Kernel kernel =
        GENERATE(Kernel::wendland_c2, Kernel::wendland_c4, Kernel::cubic_spline);
    const bool viscoplastic = GENERATE(false, true);
    const Precision precision = GENERATE(Precision::float32, Precision::float64);
    FluidSystem fluid =
        disturbed_layers(kernel, GENERATE(2, 3), viscoplastic, TensionControl::switched, precision);
    fluid.pack(0);
    const ReferenceSums exact = sum_over_neighbors_reference(fluid.physics(), fluid.neighbors());
    fluid.sum_over_neighbors(Terms::both);
    const Particles& p = fluid.particles;
    Largest rate, a, shear;
    for (std::size_t i = 0; i < p.size(); ++i) {
        rate.compare(exact.rate[i], p.drho_dt[i]);
        a.compare(exact.acceleration[i][0], p.ax[i]);
        a.compare(exact.acceleration[i][1], p.ay[i]);
        a.compare(exact.acceleration[i][2], p.az[i]);
        if (fluid.fluid_of(i).viscoplastic()) shear.compare(exact.shear_rate[i], p.shear_rate[i]);
    }
    CHECK((viscoplastic ? shear.value > 10 : shear.value == 0));  // [1/s]
    if (precision == Precision::float64) {
        CHECK(rate.error < 1e-13 * rate.value);
        CHECK(a.error < 1e-13 * a.value);
        CHECK(shear.error <= 1e-13 * shear.value);
        return;
    }
    CHECK(rate.error < 1e-5 * rate.value);
    CHECK(a.error < 1e-4 * a.value);           // the 14-bit reciprocal of the artificial viscosity
    CHECK(shear.error <= 1e-4 * shear.value);  // float32 through the inverse of a 3 x 3 matrix
}

TEST_CASE("clusters inside one fluid run the loop of one fluid") {
    FluidSystem fluid = disturbed_layers(Kernel::wendland_c2, 3, true);
    const Neighborhood& near = fluid.neighbors();
    int pure = 0, mixed = 0;
    for (int c = 0; c < near.fluid_lists().clusters(); ++c) {
        FluidBits held = 0, met = 0;
        for (int i = c * lanes; i < std::min(near.fluid_count(), (c + 1) * lanes); ++i)
            held |= FluidBits(1u << fluid.particles.fluid[i]);
        for (const int* j = near.fluid_lists().begin(c); j != near.fluid_lists().end(c); ++j)
            met |= FluidBits(1u << fluid.particles.fluid[*j]);
        REQUIRE(near.held(c) == held);
        REQUIRE(near.met(c) == (held | met));
        ++(met == 0b01 ? pure : mixed);
    }
    CHECK(pure > 0);
    CHECK(mixed > 0);
}

TEST_CASE("sums over two fluids have the same bits for one thread and for two") {
    FluidSystem fluid = disturbed_layers(Kernel::wendland_c2, 3, true);
    omp_set_num_threads(1);
    fluid.sum_over_neighbors(Terms::both);
    const Particles one = fluid.particles;
    omp_set_num_threads(2);
    fluid.sum_over_neighbors(Terms::both);
    CHECK(one.ax == fluid.particles.ax);
    CHECK(one.drho_dt == fluid.particles.drho_dt);
    CHECK(one.viscosity == fluid.particles.viscosity);
}

TEST_CASE("the same fluid named twice flows as one") {
    Case input = scenes::two_layers(0.01, {0.12, 0.1, 0.11}, 0.05, false);
    input.sph.fluid[1] = input.sph.fluid[0];
    Case single = input;
    single.sph.fluid.pop_back();
    input.sph.fluid[1].name = "slide";
    single.sph.fill.pop_back();
    input.sph.density_diffusion = single.sph.density_diffusion = 0;  // never between two names
    FluidSystem two(input, 0.2), one(single, 0.2);
    for (FluidSystem* fluid : {&two, &one}) {
        Particles& p = fluid->particles;
        for (std::size_t i = 0; i < p.size(); ++i) {
            const double s = std::sin(300 * p.x[i] + 500 * p.y[i] + 700 * p.z[i]);
            p.vx[i] = s, p.vy[i] = -s * s, p.drho[i] += 0.3 * s;
        }
        fluid->refresh_neighbors(0);
        fluid->pack(0);
        fluid->sum_over_neighbors(Terms::both);
    }
    const auto key = [](const Particles& p, std::size_t i) {
        return std::lround(p.x[i] * 1e4) * 100000000 + std::lround(p.y[i] * 1e4) * 10000 +
               std::lround(p.z[i] * 1e4);
    };
    std::vector<std::pair<long, std::size_t>> order;
    for (std::size_t i = 0; i < one.particles.size(); ++i)
        order.push_back({key(one.particles, i), i});
    std::sort(order.begin(), order.end());
    Largest a, rate;
    for (std::size_t i = 0; i < two.particles.size(); ++i) {
        const auto at = std::lower_bound(order.begin(), order.end(),
                                         std::make_pair(key(two.particles, i), std::size_t(0)));
        a.compare(one.particles.ax[at->second], two.particles.ax[i]);
        rate.compare(one.particles.drho_dt[at->second], two.particles.drho_dt[i]);
    }
    REQUIRE(a.value > 1);             // [m/s2]
    CHECK(a.error < 1e-5 * a.value);  // the tag takes 4e-7 of a volume; float32 in another order
    CHECK(rate.error < 1e-5 * rate.value);
}

TEST_CASE("a heavy layer under water stays at rest, unmixed, under the weight of both") {
    const double dx = 0.01, depth = 0.2, lower = 0.1;
    const bool viscoplastic = GENERATE(false, true);
    const Vec3 size{0.08, 0.08, depth};
    Case input = scenes::two_layers(dx, size, lower, viscoplastic);
    scenes::add_basin(input, size);
    input.sph.artificial_viscosity = 0.05;
    input.sph.smoothing_ratio = 1.5;  // 107 neighbors hold a lattice, see fluid_system.test.cpp
    FluidSystem fluid(input, 0.4);
    const double dt = 1.3 * dx / fluid.fluid().c0;
    double t = 0, before = 0;
    Health health;
    for (int n = 0; n < 2000; ++n) {
        health = scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
    CHECK(health.max_speed < 1e-4 * fluid.fluid().c0);
    const double g = 9.81, bottom = g * (1000 * (depth - lower) + 1681 * lower);
    const Particles& p = fluid.particles;
    double error = 0, floor = 0, momentum = 0;
    int on_floor = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double exact =
            p.fluid[i] == 1 ? bottom - 1681 * g * p.z[i] : 1000 * g * (depth - p.z[i]);
        error = std::max(error, std::abs(p.p[i] - exact));
        CHECK((p.fluid[i] == 1) == (p.z[i] < lower));
        momentum += p.vz[i];
        if (p.z[i] < dx) floor += p.p[i], ++on_floor;
    }
    CHECK(floor / on_floor == Approx(bottom - 1681 * g * dx / 2).epsilon(0.01));
    // the layers next to the interface see both densities in one kernel, and the first layer of the
    // free surface has half a kernel
    CHECK(error < 0.02 * bottom);
    CHECK(std::abs(momentum) / double(p.size()) < 1e-5 * fluid.fluid().c0);
}

TEST_CASE("images and dummies are of the fluid they stand for") {
    const Vec3 size{0.1, 0.1, 0.2};
    Case input = scenes::two_layers(0.01, size, 0.1, true);
    scenes::add_basin(input, size);
    input.sph.plane.erase(input.sph.plane.begin() + 2);  // "right" becomes a body
    Body gate;
    gate.name = "gate";
    gate.shape.box = Box{{0.1, 0, 0}, {0.13, 0.1, 0.2}};
    input.sph.body = {gate};
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    const Neighborhood& near = fluid.neighbors();
    for (std::size_t e = 0; e < near.extras().size(); ++e) {
        const Extra& extra = near.extras()[e];
        if (extra.from_body) continue;
        const Packed& image = near.records()[near.first_extra() + e];
        REQUIRE(FluidTag::of(image) == fluid.particles.fluid[extra.source]);
        REQUIRE(near.root_viscosity()[near.first_extra() + e] ==
                std::sqrt(static_cast<float>(fluid.particles.viscosity[extra.source])));
    }
    const double g = 9.81;
    int checked = 0;
    for (int d = 0; d < fluid.bodies.size(); ++d) {
        const double z = fluid.bodies.z[d];
        // a kernel's reach from the interface and from the surface
        if (fluid.bodies.x[d] > 0.11 || z > 0.17 || std::abs(z - 0.1) < 0.024) continue;
        const double exact = z > 0.1 ? 1000 * g * (0.2 - z) : g * (1000 * 0.1 + 1681 * (0.1 - z));
        CHECK(fluid.bodies.p[d] == Approx(exact).epsilon(2e-3));
        CHECK(fluid.bodies.fluid[d] == (z < 0.1 ? 1 : 0));
        CHECK(fluid.bodies.viscosity[d] ==
              Approx(z < 0.1 ? fluid.fluid(1).viscosity_at_rest() : 1e-3));
        ++checked;
    }
    CHECK(checked == 130);
}

TEST_CASE("the planes carry the weight of each fluid") {
    const Vec3 size{0.1, 0.1, 0.2};
    Case input = scenes::two_layers(0.01, size, 0.1, GENERATE(false, true));
    scenes::add_basin(input, size);
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    const auto force = fluid.wall_forces();
    REQUIRE(force.size() == 10);
    const double g = 9.81, area = 0.01;
    // floor: all rests on the lower fluid; the pair sum at a mirror is the pressure of the first
    // layer
    CHECK(force[0][2] == 0);
    CHECK(-force[1][2] == Approx(area * g * 0.1 * (1000 + 1681)).epsilon(0.02));
    // side: mean pressure of each layer's half of it
    CHECK(-force[2][0] == Approx(area * g * 1000 * 0.05).epsilon(0.05));
    CHECK(-force[3][0] == Approx(area * g * (1000 * 0.1 + 1681 * 0.05)).epsilon(0.02));
}

TEST_CASE("what leaves the domain is counted by fluid") {
    Case input = scenes::two_layers(0.01, {0.1, 0.1, 0.1}, 0.05, true);
    input.sph.domain = Box{{-0.1, -0.1, -0.1}, {0.2, 0.2, 0.2}};
    FluidSystem fluid(input, 0.2);
    REQUIRE(fluid.filled() == std::vector<std::int64_t>{500, 500});
    fluid.particles.x[3] = 9;
    fluid.particles.x[700] = 9;
    fluid.particles.x[701] = 9;
    const double water = fluid.particles.drho[3];
    const int first = fluid.particles.fluid[3], second = fluid.particles.fluid[700];
    REQUIRE(first == 0);
    REQUIRE(second == 1);
    fluid.refresh_neighbors(0);
    REQUIRE(fluid.removed().size() == 3);
    CHECK(fluid.removed()[0].fluid == 0);
    CHECK(fluid.removed()[0].volume == Approx(1e-3 / (1000 + water)).epsilon(1e-12));
    CHECK(fluid.removed()[1].fluid == 1);
    CHECK(fluid.removed()[2].fluid == 1);
    std::int64_t left[2] = {0, 0};
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) ++left[fluid.particles.fluid[i]];
    CHECK(left[0] == 499);
    CHECK(left[1] == 498);
    // viscosities went along with their particles
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        CHECK(fluid.particles.viscosity[i] == float(fluid.fluid_of(i).viscosity_at_rest()));
}

TEST_CASE("more fluids than a record can tell apart are refused") {
    Case input = scenes::water_box(0.01, {0.05, 0.05, 0.05});
    input.sph.fluid.resize(9, input.sph.fluid[0]);
    CHECK_THROWS_WITH(FluidSystem(input, 0.2), Catch::Contains("at most 8"));
}
