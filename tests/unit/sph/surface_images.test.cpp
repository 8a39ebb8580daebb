#include <catch2/catch.hpp>

#include "scenes.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// A floor of two by two quads over the basin, at z = 0, seen from above.
void lay_floor(FluidSystem& fluid, const Vec3& size) {
    std::vector<double> x;
    for (int iy = 0; iy < 3; ++iy)
        for (int ix = 0; ix < 3; ++ix) x.insert(x.end(), {ix * size[0] / 2, iy * size[1] / 2, 0.0});
    fluid.place_surface({0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7}, x);
}

constexpr double dx = 0.01;
const Vec3 size{0.08, 0.08, 0.10};

/// A basin; its floor is a mirror plane or a coupled surface that the lowest layer touches.
FluidSystem basin(bool of_facets, bool sides = true, double gravity = -9.81,
                  Precision precision = Precision::float32) {
    Case input = scenes::water_box(dx, size);
    input.info.gravity = {0, 0, gravity};
    input.sph.max_speed = 3;
    input.sph.precision = precision;
    scenes::add_basin(input, size);
    if (!sides) input.sph.plane.resize(1);
    if (of_facets) input.sph.plane.erase(input.sph.plane.begin());
    input.sph.artificial_viscosity = 0.1;
    // a mirror plane completes the kernel of its records, the coupled surface does not: under tension
    // they differ on purpose
    input.sph.tension_control = TensionControl::none;
    FluidSystem fluid(input, 0.2);
    if (of_facets) lay_floor(fluid, size);
    scenes::disturb(fluid, 0.05, 0.1, 500);
    return fluid;
}

/// The lowest layer presses as hard as its own pressure: it stands off the floor as it is.
void touch(FluidSystem& fluid) {
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const double rho0 = fluid.fluid_of(int(i)).rho0;
        const double at_floor = p.p[i] - rho0 * fluid.gravity()[2] * 0.5 * dx;
        p.fz[i] = p.z[i] < dx ? at_floor / (rho0 * dx) : 0;
    }
}

void sum(FluidSystem& fluid) {
    fluid.refresh_neighbors(0);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i)   // contact only pushes
        if (p.z[i] < dx) p.drho[i] = std::abs(p.drho[i]) + 1e-3;
    fluid.pack(0);
    touch(fluid);
    fluid.sum_over_neighbors(Terms::both);
}

/// Makes the touching layer stand still across the floor.
void hold_first_layer(FluidSystem& fluid) {
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        if (fluid.particles.z[i] < dx) fluid.particles.vz[i] = 0;
}

}  // namespace

TEST_CASE("behind a flat surface the images are those of a mirror plane") {
    const double gravity = GENERATE(-9.81, 0);
    const Precision precision = GENERATE(Precision::float32, Precision::float64);
    FluidSystem plane = basin(false, true, gravity, precision),
                facets = basin(true, true, gravity, precision);
    hold_first_layer(plane);
    hold_first_layer(facets);
    sum(plane);
    sum(facets);
    const Particles &p = plane.particles, &f = facets.particles;
    double rate = 0, along = 0, across = 0, largest_rate = 0, largest_a = 0;
    for (std::size_t a = 0; a < p.size(); ++a) {
        const int i = plane.index_of(std::int64_t(a)), k = facets.index_of(std::int64_t(a));
        largest_rate = std::max(largest_rate, double(std::abs(p.drho_dt[i])));
        largest_a = std::max(largest_a, double(std::abs(p.az[i])));
        rate = std::max(rate, double(std::abs(p.drho_dt[i] - f.drho_dt[k])));
        along = std::max(along, double(std::hypot(p.ax[i] - f.ax[k], p.ay[i] - f.ay[k])));
        // what touches carries reactions instead
        if (p.z[i] > dx) across = std::max(across, double(std::abs(p.az[i] - f.az[k])));
    }
    const bool exact = precision == Precision::float64;
    CHECK(rate < (exact ? 1e-12 : 1e-5) * largest_rate);  // sums in another order
    // along the wall a pair's hydrostatic parts are averaged, so that its two forces cancel
    const double viscosity = exact ? 1e-12 : 1e-4;  // its reciprocal has 14 bits in float
    if (gravity == 0) CHECK(along < viscosity * largest_a);
    CHECK(across < viscosity * largest_a);
}

TEST_CASE("the images behind a surface leave the momentum of the fluid unchanged") {
    const Precision precision = GENERATE(Precision::float32, Precision::float64);
    FluidSystem with = basin(true, false, -9.81, precision),
                without = basin(true, false, -9.81, precision);
    without.place_surface({}, {});
    sum(with);
    sum(without);
    REQUIRE(with.surface().pairs() > 0);
    const Particles &a = with.particles, &b = without.particles;
    double change[3] = {0, 0, 0}, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        change[0] += double(a.ax[i]) - b.ax[i];
        change[1] += double(a.ay[i]) - b.ay[i];
        change[2] += double(a.az[i]) - b.az[i];
        largest += std::hypot(a.ax[i] - b.ax[i], a.ay[i] - b.ay[i], a.az[i] - b.az[i]);
    }
    REQUIRE(largest > 100);  // [m/s2] they do act
    const double round_off = precision == Precision::float64 ? 1e-14 : 1e-6;
    for (const double component : change) CHECK(std::abs(component) < round_off * largest);
}

TEST_CASE("the work of the images' forces is that of their density rates") {
    // sum m v.a + sum V p (1/rho) d(rho)/dt = 0 without gravity, viscosity and diffusion
    Case input = scenes::water_box(dx, size);
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;
    input.sph.artificial_viscosity = input.sph.density_diffusion = 0;
    input.sph.fluid[0].viscosity = 0;
    FluidSystem with(input, 0.2), without(input, 0.2);
    for (FluidSystem* fluid : {&with, &without}) scenes::disturb(*fluid, 0.05, 0.1, 500);
    lay_floor(with, size);
    sum(with);
    sum(without);
    double kinetic = 0, stored = 0;
    const Particles &a = with.particles, &b = without.particles;
    const double mass = with.fluid().mass, rho0 = with.fluid().rho0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        kinetic += mass * (a.vx[i] * (a.ax[i] - b.ax[i]) + a.vy[i] * (a.ay[i] - b.ay[i]) +
                           a.vz[i] * (a.az[i] - b.az[i]));
        const double rho = rho0 + a.drho[i];
        stored += mass * a.p[i] / (rho * rho) * (a.drho_dt[i] - b.drho_dt[i]);
    }
    REQUIRE(std::abs(kinetic) > 1e-6);                                      // [W]
    CHECK(kinetic + stored == Approx(0).margin(1e-4 * std::abs(kinetic)));  // float32 sums
}

namespace {

/// Water over 20 mm of the slide: the interface is so near to the floor that images of both are within reach.
FluidSystem layered_basin(bool of_facets, bool sides, bool viscoplastic) {
    Case input = scenes::two_layers(dx, size, 0.02, viscoplastic);
    input.info.gravity = {0, 0, 0};   // continued differently: see the test for one fluid
    input.sph.max_speed = 3;
    scenes::add_basin(input, size);
    if (!sides) input.sph.plane.resize(1);
    if (of_facets) input.sph.plane.erase(input.sph.plane.begin());
    input.sph.artificial_viscosity = 0.1;
    input.sph.tension_control = TensionControl::none;   // see basin()
    FluidSystem fluid(input, 0.2);
    if (of_facets) lay_floor(fluid, size);
    scenes::disturb(fluid, 0.05, 0.1, 500);
    return fluid;
}

}  // namespace

TEST_CASE("behind a flat surface under two fluids the images are those of a mirror plane") {
    const bool viscoplastic = GENERATE(false, true);
    FluidSystem plane = layered_basin(false, true, viscoplastic),
                facets = layered_basin(true, true, viscoplastic);
    hold_first_layer(plane);
    hold_first_layer(facets);
    sum(plane);
    sum(facets);
    const Particles &p = plane.particles, &f = facets.particles;
    double rate = 0, a_error = 0, largest_rate = 0, largest_a = 0;
    for (std::size_t a = 0; a < p.size(); ++a) {
        const int i = plane.index_of(std::int64_t(a)), k = facets.index_of(std::int64_t(a));
        largest_rate = std::max(largest_rate, double(std::abs(p.drho_dt[i])));
        largest_a = std::max(largest_a, double(std::abs(p.az[i])));
        rate = std::max(rate, double(std::abs(p.drho_dt[i] - f.drho_dt[k])));
        a_error = std::max(a_error, double(std::hypot(p.ax[i] - f.ax[k], p.ay[i] - f.ay[k])));
        if (p.z[i] > dx) a_error = std::max(a_error, double(std::abs(p.az[i] - f.az[k])));
    }
    CHECK(rate < 1e-5 * largest_rate);
    CHECK(a_error < 1e-4 * largest_a);
}

TEST_CASE("a layer that presses less than its pressure stands off the surface, and back") {
    FluidSystem fluid = basin(true);
    sum(fluid);
    Particles& p = fluid.particles;
    const int i = int(std::find_if(p.z.begin(), p.z.end(), [](double z) { return z < dx; }) -
                      p.z.begin());
    const double c0 = fluid.fluid().c0, full = 0.8 * p.fz[i] * dx / c0;
    // what the images ask for is a sum over the kernel, 3 % off p A on a lattice
    CHECK(std::abs(fluid.contact_velocity(i)[2] - p.vz[i]) < 0.03 * full);
    p.fz[i] *= 0.5;   // its fluid pushes twice as hard as the surface
    fluid.sum_over_neighbors(Terms::force);
    const double lift = p.vz[i] - fluid.contact_velocity(i)[2];
    CHECK(lift == Approx(0.5 * full).margin(0.03 * full));
    for (int n = 0; n < 2000; ++n) {
        fluid.sum_over_neighbors(Terms::force);
        fluid.kick_and_drift(0, 0, 0, false);   // nothing moves
    }
    CHECK(fluid.contact_point(i)[2] == p.z[i]);   // no time, no lift
}

TEST_CASE("who leaves the surface comes back from his lift, and touches where he is") {
    FluidSystem fluid = basin(true);
    sum(fluid);
    Particles& p = fluid.particles;
    const int i = int(std::find_if(p.z.begin(), p.z.end(), [](double z) { return z < dx; }) -
                      p.z.begin());
    p.fz[i] *= 0.5;
    fluid.sum_over_neighbors(Terms::force);
    for (auto* v : {&p.vx, &p.vy, &p.vz, &p.fx, &p.fy}) std::fill(v->begin(), v->end(), 0.0);
    fluid.kick_and_drift(1e-5, 0, 0, false);
    REQUIRE(p.z[i] - fluid.contact_point(i)[2] > 0);
    fluid.place_surface({}, {});   // no surface near: as around an edge, where the mirror ends
    std::fill(p.fz.begin(), p.fz.end(), 0.0);
    fluid.place_surface({0, 1, 2, 2}, {9, 9, 9, 10, 9, 9, 10, 10, 9});
    fluid.sum_over_neighbors(Terms::force);
    const double lift = p.z[i] - fluid.contact_point(i)[2];
    const double tau = 400 * dx / fluid.fluid().c0;
    CHECK(fluid.contact_velocity(i)[2] - p.vz[i] == Approx(lift / tau));
    for (int n = 0; n < 100; ++n) {
        fluid.sum_over_neighbors(Terms::force);
        for (std::size_t i = 0; i < p.az.size(); ++i) p.az.set(i, 0);
        fluid.kick_and_drift(tau / 10, 0, 0, false);
    }
    CHECK(p.z[i] - fluid.contact_point(i)[2] == Approx(0).margin(1e-3 * lift));
}

TEST_CASE("the images behind a surface leave the momentum of two fluids unchanged") {
    FluidSystem with = layered_basin(true, false, true), without = layered_basin(true, false, true);
    without.place_surface({}, {});
    // a disordered first layer of both fluids
    for (FluidSystem* fluid : {&with, &without})
        for (std::size_t i = 0; i < fluid->particles.size(); i += 3) fluid->particles.fluid[i] = 0;
    sum(with);
    sum(without);
    REQUIRE(with.surface().pairs() > 0);
    double change[3] = {0, 0, 0}, largest = 0;
    const Particles &a = with.particles, &b = without.particles;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double m = with.fluid_of(i).mass;
        const double d[3] = {double(a.ax[i]) - b.ax[i], double(a.ay[i]) - b.ay[i],
                             double(a.az[i]) - b.az[i]};
        for (int c = 0; c < 3; ++c) change[c] += m * d[c];
        largest += m * std::hypot(d[0], d[1], d[2]);
    }
    REQUIRE(largest > 0.1);  // [N]
    for (const double component : change) CHECK(std::abs(component) < 1e-6 * largest);  // float32
}

TEST_CASE("a dry surface has no images: what arrives is not compressed before it touches") {
    FluidSystem near = basin(true), far = basin(true);
    far.place_surface({}, {});
    for (FluidSystem* fluid : {&near, &far}) {
        fluid->refresh_neighbors(0);
        fluid->pack(0);
        fluid->sum_over_neighbors(Terms::both);
    }
    for (std::size_t i = 0; i < near.particles.size(); ++i) {
        REQUIRE(near.particles.drho_dt[i] == far.particles.drho_dt[i]);
        REQUIRE(near.particles.az[i] == far.particles.az[i]);
    }
}

TEST_CASE("in two dimensions the images push nobody out of the plane, whatever the facets") {
    Case input = scenes::water_box(dx, size, 2);
    input.sph.max_speed = 3;
    FluidSystem fluid(input, 0.2);
    // a bent floor under the water whose corners are no round numbers: closest points are off by rounding
    std::vector<double> x;
    for (int k = 0; k < 6; ++k)
        for (const double y : {0.0, 0.05})
            x.insert(x.end(), {-0.013 + 0.0223 * k, y / 3 - 0.007, -0.001 * ((k * 7) % 3)});
    std::vector<std::int32_t> quad;
    for (int k = 0; k < 5; ++k)
        quad.insert(quad.end(), {2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
    fluid.place_surface(quad, x);
    scenes::disturb(fluid, 0.05, 0.1, 500);
    sum(fluid);
    REQUIRE(fluid.surface().pairs() > 0);
    double out_of_plane = 0, largest = 0;
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        out_of_plane = std::max(out_of_plane, std::abs(double(fluid.particles.ay[i])));
        largest = std::max(largest, std::abs(double(fluid.particles.az[i])));
    }
    CHECK(out_of_plane == 0);   // from 1e-16 of the rest particles under pressure buckle out
    CHECK(largest > 1);
}

TEST_CASE("images follow a surface that goes on without being placed again") {
    const Vec3 by{0.0004, -0.0003, 0.0007};
    const auto floor_at = [&](double part) {
        std::vector<double> x;
        for (int iy = 0; iy < 3; ++iy)
            for (int ix = 0; ix < 3; ++ix)
                x.insert(x.end(), {ix * size[0] / 2 + part * by[0], iy * size[1] / 2 + part * by[1],
                                   part * by[2]});
        return x;
    };
    const std::vector<std::int32_t> quad{0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7};
    FluidSystem follows = basin(true), placed = basin(true), stays = basin(true);
    for (FluidSystem* fluid : {&follows, &placed, &stays}) sum(*fluid);
    for (const double part : {0.3, 0.7, 1.0}) follows.place_surface(quad, floor_at(part));
    REQUIRE_FALSE(follows.surface().stale());
    placed.place_surface({}, {});
    placed.place_surface(quad, floor_at(1));
    REQUIRE(placed.surface().stale());
    for (FluidSystem* fluid : {&follows, &placed, &stays}) fluid->sum_over_neighbors(Terms::both);
    double error = 0, change = 0;
    for (std::size_t i = 0; i < stays.particles.size(); ++i) {
        const auto rate = [&](const FluidSystem& fluid) { return double(fluid.particles.drho_dt[i]); };
        error = std::max(error, std::abs(rate(follows) - rate(placed)));
        change = std::max(change, std::abs(rate(stays) - rate(placed)));
    }
    CHECK(change > 1);   // [kg/m3/s]
    CHECK(error < 1e-5 * change);

    SECTION("until it has gone a tenth of a spacing, or is another one") {
        follows.place_surface(quad, floor_at(2));
        CHECK(follows.surface().stale());
        stays.place_surface({0, 1, 4, 3}, floor_at(0));
        CHECK(stays.surface().stale());
    }
}
