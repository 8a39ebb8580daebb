#include <catch2/catch.hpp>

#include <omp.h>

#include "scenes.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// Water that fills its domain, periodic along `axes`, without weight.
Case periodic_box(double dx, const Vec3& size, const std::vector<std::string>& axes,
                  int dimension = 3) {
    Case input = scenes::water_box(dx, size, dimension);
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;
    input.sph.domain = Box{{0, 0, 0}, size};
    input.sph.periodic = axes;
    return input;
}

void sum(FluidSystem& fluid) {
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::both);
}

/// Accelerations by identity [m/s2].
std::vector<Vec3> accelerations(const FluidSystem& fluid) {
    std::vector<Vec3> a(fluid.particles.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        a[fluid.particles.id[i]] = {fluid.particles.ax[i], fluid.particles.ay[i],
                                    fluid.particles.az[i]};
    return a;
}

}  // namespace

TEST_CASE("in a periodic box pair forces sum to zero") {
    const int dimension = GENERATE(2, 3);
    const std::vector<std::string> axes = dimension == 2 ? std::vector<std::string>{"x", "z"}
                                                         : std::vector<std::string>{"x", "y", "z"};
    FluidSystem fluid(periodic_box(0.01, {0.12, 0.07, 0.09}, axes, dimension), 0.2);
    scenes::disturb(fluid, 0.3, 0.5, 2000);
    sum(fluid);
    double total[3] = {0, 0, 0}, size = 0;
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        total[0] += fluid.particles.ax[i], total[1] += fluid.particles.ay[i];
        total[2] += fluid.particles.az[i];
        size += std::abs(fluid.particles.ax[i]);
    }
    // float32 sums of some 60 neighbors each, errors at random; without images it is 1e-2
    for (const double component : total) CHECK(std::abs(component) < 1e-6 * size);
}

TEST_CASE("nothing in a periodic box knows where the seam is") {
    const Vec3 size{0.12, 0.1, 0.08};
    Case input = periodic_box(0.01, size, {"x", "y"});
    // images of images where the seams meet the floor
    input.sph.plane = {scenes::plane("floor", {0, 0, 0}, {0, 0, 1})};
    input.info.gravity = {0.5, 0, -9.81};
    FluidSystem here(input, 0.2), there(input, 0.2);
    scenes::disturb(here, 0.3, 0.5, 2000);
    scenes::disturb(there, 0.3, 0.5, 2000);
    for (std::size_t i = 0; i < there.particles.size(); ++i) {
        there.particles.x[i] += 0.0537;
        there.particles.y[i] -= 0.231;  // more than two periods
    }
    sum(here);
    sum(there);
    const std::vector<Vec3> a = accelerations(here), b = accelerations(there);
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            largest = std::max(largest, std::abs(a[i][k]));
            difference = std::max(difference, std::abs(a[i][k] - b[i][k]));
        }
    // float32, other order of the sums, and the 14-bit reciprocal of the artificial viscosity
    CHECK(difference < 1e-4 * largest);
    for (std::size_t i = 0; i < there.particles.size(); ++i) {
        CHECK(there.particles.x[i] >= 0);
        CHECK(there.particles.y[i] < 0.1);
    }
}

TEST_CASE("a stream that crosses the seam is the water at rest seen from a boat") {
    const double dx = 0.01, speed = 0.8, dt = 2e-4;
    Case input = periodic_box(dx, {0.16, 0, 0.1}, {"x"}, 2);
    input.sph.plane = {scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                       scenes::plane("lid", {0, 0, 0.1}, {0, 0, -1})};
    FluidSystem rest(input, 0.4), stream(input, 0.4);
    const int steps = 1000;  // a period and a quarter
    for (FluidSystem* fluid : {&rest, &stream}) {
        for (std::size_t i = 0; i < fluid->particles.size(); ++i) {
            const double x = fluid->particles.x[i], z = fluid->particles.z[i];
            fluid->particles.vz[i] = 0.02 * std::sin(M_PI * z / 0.1) * std::cos(M_PI * x / 0.08);
            fluid->particles.vx[i] = fluid == &stream ? speed : 0;
        }
        double t = 0, before = 0;
        for (int n = 0; n < steps; ++n) {
            scenes::two_pass_step(*fluid, t, dt, before);
            before = dt;
        }
    }
    double largest = 0;
    const double drift = speed * dt * steps;
    for (std::size_t id = 0; id < rest.particles.size(); ++id) {
        const int i = rest.index_of(std::int64_t(id)), j = stream.index_of(std::int64_t(id));
        double apart = stream.particles.x[j] - rest.particles.x[i] - drift;
        apart -= 0.16 * std::round(apart / 0.16);
        largest = std::max(
            {largest, std::abs(apart), std::abs(stream.particles.z[j] - rest.particles.z[i])});
    }
    // velocities are float32 in the pair sums: 6e-8 of 0.8 m/s against 0.02 m/s
    CHECK(largest < 1e-4 * dx);
}

TEST_CASE("a shear wave in a periodic box decays with nu k^2") {
    const double length = 0.32, nu = 1e-3, k = 2 * M_PI / length;
    Case input = periodic_box(0.01, {0.08, 0, length}, {"x", "z"}, 2);
    input.sph.fluid[0].viscosity = 1000 * nu;
    input.sph.artificial_viscosity = 0;
    input.sph.smoothing_ratio = 1.5;
    FluidSystem fluid(input, 0.4);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        fluid.particles.vx[i] = 0.1 * std::sin(k * fluid.particles.z[i]);
    const auto amplitude = [&] {
        double sum = 0;
        for (std::size_t i = 0; i < fluid.particles.size(); ++i)
            sum += fluid.particles.vx[i] * std::sin(k * fluid.particles.z[i]);
        return sum;
    };
    double t = 0, before = 0;
    const double dt = 5e-4, first = amplitude();
    while (t < 1) {
        scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
    const double rate = std::log(first / amplitude()) / (t - 0.5 * dt);
    // rows slide past each other; Morris' form on 16 points a wave and h = 1.5 dx
    CHECK(rate == Approx(nu * k * k).epsilon(0.01));
}

TEST_CASE("gravity along a periodic axis drives the flow and makes no pressure") {
    Case input = periodic_box(0.01, {0.1, 0.08, 0.08}, {"x", "y", "z"});
    input.info.gravity = {0.3, 0, -9.81};
    FluidSystem fluid(input, 0.4);
    double t = 0, before = 0;
    for (int n = 0; n < 100; ++n) {
        scenes::two_pass_step(fluid, t, 1e-4, before);
        before = 1e-4;
    }
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        CHECK(fluid.particles.vx[i] == Approx(0.3 * (t - 0.5e-4)).epsilon(1e-6));
        CHECK(std::abs(fluid.particles.p[i]) < 1e-3);  // [Pa], of rho c0^2 = 1e5
    }
}

TEST_CASE("a periodic flow has the same bits with one thread and with two") {
    const int threads = omp_get_max_threads();
    std::vector<std::vector<double>> ends;
    for (const int n : {1, 2}) {
        omp_set_num_threads(n);
        FluidSystem fluid(periodic_box(0.01, {0.12, 0.08, 0.1}, {"x", "y"}), 0.4);
        scenes::disturb(fluid, 0.1, 0.5, 0);
        double t = 0, before = 0;
        for (int k = 0; k < 40; ++k) {
            scenes::two_pass_step(fluid, t, 3e-4, before);
            before = 3e-4;
        }
        ends.push_back(fluid.particles.x);
    }
    omp_set_num_threads(threads);
    CHECK(ends[0] == ends[1]);
}

TEST_CASE("a plate moves along a periodic axis for good") {
    Case input = periodic_box(0.01, {0.16, 0, 0.1}, {"x"}, 2);
    input.sph.domain->max[2] = 0.2;
    Body lid;
    lid.name = "lid";
    lid.shape.box = {{0, 0, 0.1}, {0.16, 0, 0.13}};
    lid.velocity = {1, 0, 0};
    lid.slip = Slip::no_slip;
    input.sph.body = {lid};
    FluidSystem fluid(input, 0.4);
    double t = 0, before = 0;
    for (int n = 0; n < 400; ++n) {  // a quarter of a period beyond the end
        scenes::two_pass_step(fluid, t, 5e-4, before);
        before = 5e-4;
        double low = 1e300, high = -1e300;
        for (int d = 0; d < fluid.bodies.size(); ++d) {
            low = std::min(low, fluid.bodies.x[d]);
            high = std::max(high, fluid.bodies.x[d]);
        }
        REQUIRE(high - low < 0.1601);
        REQUIRE(high < 0.16 + 0.005);
    }
}

TEST_CASE("what cannot be periodic is refused with the reason") {
    Case input = periodic_box(0.01, {0.09, 0.1, 0.1}, {"x"});
    input.sph.smoothing_ratio = 2.4;
    CHECK_THROWS_WITH(FluidSystem(input, 0.2),
                      Catch::Contains("0.09 m") && Catch::Contains("at least 0.096 m"));
    input = periodic_box(0.01, {0.1, 0.1, 0.1}, {"x"});
    input.sph.plane = {scenes::plane("end", {0, 0, 0}, {1, 0, 0})};
    CHECK_THROWS_WITH(FluidSystem(input, 0.2), Catch::Contains("sph.plane \"end\""));
    input.sph.plane.clear();
    input.sph.domain.reset();
    CHECK_THROWS_WITH(FluidSystem(input, 0.2), Catch::Contains("give sph.domain"));
    FluidSystem fluid(periodic_box(0.01, {0.1, 0.1, 0.1}, {"x"}), 0.2);
    CHECK_THROWS_WITH(fluid.place_surface({0, 1, 2, 2}, {0.03, 0, 0, 0.05, 0, 0, 0.09, 0, 0}),
                      Catch::Contains("x = 0.09 m"));
    CHECK_NOTHROW(fluid.place_surface({0, 1, 2, 2}, {0.03, 0, 0, 0.05, 0, 0, 0.07, 0, 0}));
}
