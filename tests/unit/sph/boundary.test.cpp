#include <catch2/catch.hpp>

#include "scenes.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

TEST_CASE("a particle in a corner of three walls has seven images") {
    const MirrorPlanes walls({scenes::plane("x", {0, 0, 0}, {1, 0, 0}),
                              scenes::plane("y", {0, 0, 0}, {0, 1, 0}),
                              scenes::plane("z", {0, 0, 0}, {0, 0, 1})});
    std::vector<PlaneMask> masks;
    walls.images_of(0.01, 0.02, 0.03, 0.05, masks);
    CHECK(masks.size() == 7);
    masks.clear();
    walls.images_of(0.01, 0.02, 0.9, 0.05, masks);
    CHECK(masks.size() == 3);
    const Reflection& r = walls.reflection(0b011);
    CHECK(r.m[0][0] == -1);
    CHECK(r.m[1][1] == -1);
    CHECK(r.m[2][2] == 1);
}

TEST_CASE("a slanted wall off the origin mirrors a point to the other side at the same distance") {
    const double s = std::sqrt(0.5);
    const MirrorPlanes walls({scenes::plane("slope", {1, 0, 0}, {-s, 0, s})});
    const Reflection& r = walls.reflection(1);
    const double x = 0.3, z = 0.5;
    const double mx = r.m[0][0] * x + r.m[0][2] * z + r.t[0],
                 mz = r.m[2][0] * x + r.m[2][2] * z + r.t[2];
    CHECK(walls.distance(0, mx, 0, mz) == Approx(-walls.distance(0, x, 0, z)));
    CHECK((mx - x) * s + (mz - z) * s == Approx(0).margin(1e-15));   // moved along the normal only
}

TEST_CASE("parallel walls are never combined, oblique ones are refused") {
    const MirrorPlanes slot({scenes::plane("left", {0, 0, 0}, {1, 0, 0}),
                             scenes::plane("right", {0.04, 0, 0}, {-1, 0, 0})});
    std::vector<PlaneMask> masks;
    slot.images_of(0.02, 0, 0, 0.03, masks);
    CHECK(masks.size() == 2);
    CHECK_THROWS_AS(MirrorPlanes({scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                                  scenes::plane("slope", {0, 0, 0}, {1, 0, 1})}),
                    InputError);
}

TEST_CASE("a particle behind a wall is put back with its approach reversed") {
    const MirrorPlanes floor({scenes::plane("floor", {0, 0, 0}, {0, 0, 1})});
    double x = 1, y = 2, z = -0.25, vx = 3, vy = 0, vz = -4;
    CHECK(floor.put_back(x, y, z, vx, vy, vz));
    CHECK(z == 0.25);
    CHECK(vz == 4);
    CHECK(vx == 3);
    CHECK_FALSE(floor.put_back(x, y, z, vx, vy, vz));
}

TEST_CASE("a body shows the hydrostatic pressure of the water beside it") {
    Case input = scenes::water_box(0.01, {0.1, 0.1, 0.2});
    scenes::add_basin(input, {0.1, 0.1, 0.2});
    input.sph.plane.erase(input.sph.plane.begin() + 2);   // "right" becomes a body
    Body gate;
    gate.name = "gate";
    gate.shape.box = Box{{0.1, 0, 0}, {0.13, 0.1, 0.2}};
    input.sph.body = {gate};
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    int checked = 0;
    for (int d = 0; d < fluid.bodies.size(); ++d)
        if (fluid.bodies.x[d] < 0.11 && fluid.bodies.z[d] < 0.17) {
            const double exact = 1000 * 9.81 * (0.2 - fluid.bodies.z[d]);
            // the extrapolation is exact for a linear field; the water's own pressure is linear
            CHECK(fluid.bodies.p[d] == Approx(exact).epsilon(1e-3));
            ++checked;
        }
    CHECK(checked == 170);
}

TEST_CASE("friction on a no-slip floor is the wall stress over one layer of particles") {
    Case input = scenes::water_box(0.01, {0.2, 0.1, 0.05});
    scenes::add_basin(input, {0.2, 0.1, 0.05});
    input.sph.plane[0].slip = Slip::no_slip;
    input.sph.fill[0].velocity = {2, 0, 0};
    input.sph.fluid[0].sound_speed = 30;
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::force);
    const auto ax = fluid.particles.ax;
    fluid.add_wall_friction();
    double force = 0;
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        force += fluid.fluid().mass * (ax[i] - fluid.particles.ax[i]);
    // law of the wall at 5 mm for 2 m/s over 0.2 m x 0.1 m
    const double a = 2 / 8.3, b = 1e-6 / 5e-3;
    const double stress = 1000 * std::pow(a, 1.75) * std::pow(b, 0.25);
    CHECK(force == Approx(stress * 0.02).epsilon(1e-3));   // float32 accelerations of 1e2 m/s2
}
