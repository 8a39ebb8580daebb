#include "sph_solver/gauges.hpp"

#include <catch2/catch.hpp>

#include "scenes.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

FluidSystem still_basin() {
    const Vec3 size{0.3, 0.1, 0.2};
    Case input = scenes::water_box(0.01, size);
    scenes::add_basin(input, size);
    input.sph.plane.erase(input.sph.plane.begin() + 2);   // open to the right
    FluidSystem fluid(input, 0.2);
    return fluid;
}

}  // namespace

TEST_CASE("the front is half a spacing ahead of the foremost particle that has a neighbor") {
    FluidSystem fluid = still_basin();
    fluid.particles.x[0] = 0.9;   // a lonely drop far ahead
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    CHECK(front_position(fluid, {1, 0, 0}) == Approx(0.3));
    CHECK(front_position(fluid, {2, 0, 0}) == Approx(0.3));   // a direction, not a scale
}

TEST_CASE("the water level of a still basin is its surface") {
    FluidSystem fluid = still_basin();
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    CHECK(water_level(fluid, 0.15, 0.05) == Approx(0.2).margin(0.0025));   // a quarter spacing
    CHECK(water_level(fluid, 0.6, 0.05) == Approx(0.0).margin(1e-9));      // dry
}

TEST_CASE("a pressure gauge reads the hydrostatic pressure, at the wall too") {
    FluidSystem fluid = still_basin();
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    CHECK(interpolate(fluid, {0.15, 0.05, 0.05}).p == Approx(1000 * 9.81 * 0.15).epsilon(0.005));
    CHECK(interpolate(fluid, {0.0, 0.05, 0.10}).p == Approx(1000 * 9.81 * 0.10).epsilon(0.005));
    CHECK(interpolate(fluid, {0.15, 0.05, 0.5}).filled == 0);
}
