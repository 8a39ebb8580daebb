#include <catch2/catch.hpp>

#include "scenes.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

AbsorbingLayer layer(double from, double to) {
    AbsorbingLayer l;
    l.name = "end", l.box = {{from, 0, 0}, {to, 0, 1}};
    return l;
}

/// Steps of one size from t = 0.
void run(FluidSystem& fluid, double end, double dt) {
    double t = 0, before = 0;
    while (t < end - 0.5 * dt) {
        scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
}

}  // namespace

TEST_CASE("a pulse of sound dies in an absorbing layer") {
    const double dx = 0.01, width = 0.05, peak = 20, begin = 0.8, length = 0.2;
    Case input = scenes::water_box(dx, {begin + length, 0, 0.05}, 2);
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1, input.sph.smoothing_ratio = 1.5;
    input.sph.plane = {scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                       scenes::plane("roof", {0, 0, 0.05}, {0, 0, -1}),
                       scenes::plane("left", {0, 0, 0}, {1, 0, 0}),
                       scenes::plane("right", {begin + length, 0, 0}, {-1, 0, 0})};
    input.sph.absorbing = {layer(begin, begin + length)};
    FluidSystem fluid(input, 0.4);
    const double c0 = fluid.fluid().c0;
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double pulse = peak * std::exp(-std::pow((p.x[i] - 0.5) / width, 2));
        p.drho[i] = fluid.fluid().deviation_at(pulse);
        p.vx[i] = pulse / (1000 * c0);
    }
    run(fluid, (0.3 + 2 * length + 0.4) / c0, 0.9 * dx / c0);
    double back = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p.x[i] > 0.1 && p.x[i] < begin)
            back = std::max(back, std::abs(0.5 * (p.p[i] - 1000 * c0 * p.vx[i])));
    INFO("reflected " << back / peak);
    CHECK(back < 0.04 * peak);  // four widths long: 2 % measured, a wall sends 80 % back
}

TEST_CASE("an absorbing layer leaves the level of water at rest alone") {
    const Vec3 size{0.3, 0, 0.1};
    std::vector<double> level;
    for (const bool absorbing : {false, true}) {
        Case input = scenes::water_box(0.01, size, 2);
        scenes::add_basin(input, size);
        input.sph.smoothing_ratio = 1.5;
        if (absorbing) input.sph.absorbing = {layer(0.1, 0.3)};
        FluidSystem fluid(input, 0.4);
        run(fluid, 2, 5e-4);
        double center = 0;   // of mass: single particles of the surface come and go
        for (const double z : fluid.particles.z) center += z / 300;
        level.push_back(2 * center);
        CHECK(fluid.particles.size() == 300);
    }
    CHECK(level[1] == Approx(level[0]).margin(5e-4));  // a twentieth of a spacing
}

TEST_CASE("a current that an absorbing layer is told about passes it unhindered") {
    Case input = scenes::water_box(0.01, {0.3, 0.08, 0.08});
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;
    input.sph.domain = Box{{0, 0, 0}, {0.3, 0.08, 0.08}};
    input.sph.periodic = {"x", "y", "z"};
    input.sph.fill[0].velocity = {0, 0.3, 0};
    input.sph.absorbing = {layer(0.1, 0.3)};
    input.sph.absorbing[0].velocity = {0, 0.3, 0};
    FluidSystem fluid(input, 0.4);
    run(fluid, 0.3, 1e-3);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        CHECK(fluid.particles.vy[i] == Approx(0.3).epsilon(1e-6));
}

TEST_CASE("an absorbing layer thinner than the kernel is refused") {
    Case input = scenes::water_box(0.01, {0.3, 0, 0.1}, 2);
    input.sph.absorbing = {layer(0.29, 0.3)};
    CHECK_THROWS_WITH(FluidSystem(input, 0.4), Catch::Contains("0.01 m long"));
}
