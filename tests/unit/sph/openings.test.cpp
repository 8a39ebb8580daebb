#include <catch2/catch.hpp>

#include "scenes.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

Inflow inflow(const std::string& velocity, const Box& box) {
    Inflow in;
    in.name = "in", in.fluid = "water", in.box = box;
    in.velocity = Expression(velocity, "xyzt", "velocity");
    return in;
}

Outflow outflow(const Box& box) {
    Outflow out;
    out.name = "out", out.box = box, out.normal = {-1, 0, 0};
    return out;
}

/// A duct in the x-z plane between free-slip walls, full of water that flows with `speed` [m/s].
Case duct(double dx, double length, double height, double speed) {
    Case input = scenes::water_box(dx, {length, 0, height}, 2);
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;   // c0 = 10 m/s
    input.sph.fill[0].velocity = {speed, 0, 0};
    input.sph.plane = {scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                       scenes::plane("roof", {0, 0, height}, {0, 0, -1})};
    input.sph.inflow = {inflow(std::to_string(speed), {{0, 0, 0}, {0, 0, height}})};
    input.sph.outflow = {outflow({{length, 0, 0}, {length, 0, height}})};
    input.sph.outflow[0].pressure = 0;
    return input;
}

void advance(FluidSystem& fluid, double& t, double end, double dt) {
    static double before = 0;
    if (t == 0) before = 0;
    while (t < end - 0.5 * dt) {
        scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
}

}  // namespace

TEST_CASE("plug flow through a duct goes on as it is, counted to the particle") {
    const double dx = 0.01, speed = 0.5;
    FluidSystem fluid(duct(dx, 0.3, 0.1, speed), 0.4);
    const std::size_t start = fluid.particles.size();
    double t = 0;
    advance(fluid, t, 1.2, 5e-4);   // twice through
    const std::int64_t in = fluid.openings().passed(0, 0).particles,
                       out = -fluid.openings().passed(1, 0).particles;
    INFO(in << " in, " << out << " out");
    // ten columns; those that cross do it when lists are rebuilt, 0.2 dx late at most
    CHECK(std::abs(in - 10 * std::floor(speed * t / dx)) <= 10);
    CHECK(std::abs(in - out) <= 10);
    CHECK(std::abs(int(fluid.particles.size()) - int(start)) <= 10);
    double speed_error = 0, pressure = 0;
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        speed_error = std::max(speed_error, std::hypot(fluid.particles.vx[i] - speed,
                                                       fluid.particles.vz[i]));
        pressure = std::max(pressure, std::abs(fluid.particles.p[i]));
    }
    INFO("speed error " << speed_error << " m/s, pressure " << pressure << " Pa");
    CHECK(speed_error < 1e-3 * speed);
    CHECK(pressure < 0.01 * 500 * speed * speed);
    // identities stay unique
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        CHECK(fluid.index_of(fluid.particles.id[i]) == int(i));
}
