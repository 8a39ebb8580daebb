// sph.precision = "double": all that a step goes through, against the same in float.

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "scenes.hpp"
#include "sph_solver/gauges.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double dx = 0.02;
const Vec3 size{0.4, 0.2, 0.2};

/// A column that falls against a box, with much that a scene can ask for.
struct Scene {
    const char* name;
    std::function<void(Case&)> change;
    double from_float;  // positions after 60 steps, float against double, at most this [dx]
};

void no_slip(Case& c) {
    for (PlaneWall& plane : c.sph.plane) plane.slip = Slip::no_slip;
}

const Scene all_scenes[] = {
    {"water", [](Case&) {}, 1e-4},
    {"slanted plane",
     [](Case& c) {
         c.sph.plane.push_back(
             scenes::plane("slope", {0.6, 0, 0}, {-std::sqrt(0.5), 0, std::sqrt(0.5)}));
         c.sph.plane.erase(c.sph.plane.begin(), c.sph.plane.begin() + 3);
     },
     1e-4},
    {"resolved walls",
     [](Case& c) {
         no_slip(c);
         c.sph.fluid[0].viscosity = 5;
         c.sph.viscosity_solver = ViscositySolver::explicit_sums;
     },
     1e-4},
    {"strain form",
     [](Case& c) {
         no_slip(c);
         c.sph.fluid[0].viscosity = 2;
         c.sph.viscous_form = ViscousForm::strain;
         c.sph.viscosity_solver = ViscositySolver::explicit_sums;
     },
     1e-4},
    {"two fluids, one viscoplastic",
     [](Case& c) {
         Fluid slide;
         slide.name = "slide";
         slide.density = 1681;
         slide.yield_stress = 7.3, slide.consistency = 3, slide.flow_index = 0.35;
         c.sph.fluid.push_back(slide);
         Fill low = c.sph.fill[0];
         low.fluid = "slide";
         low.box.max[2] = 0.1;
         c.sph.fill.push_back(low);
         c.sph.viscosity_solver = ViscositySolver::explicit_sums;
     },
     1e-3},  // the law's slope near yield
    {"implicit viscosity",
     [](Case& c) {
         no_slip(c);
         c.sph.fluid[0].yield_stress = 50, c.sph.fluid[0].consistency = 5;
         c.sph.fluid[0].flow_index = 0.5;
         c.sph.viscosity_solver = ViscositySolver::implicit;
         c.sph.viscosity_tolerance = 1e-5;
     },
     1e-3},  // what may be left is 1e-5 of the change in a step
    {"shifting and correction",
     [](Case& c) {
         c.sph.shifting = 10;
         c.sph.gradient_correction = true;
         c.sph.tension_control = TensionControl::switched;
     },
     1e-3},  // who counts as at the surface may depend on the last digit
    {"heated", [](Case& c) { c.sph.fluid[0].gruneisen = 0.5; }, 1e-4},
    {"sizes that follow density", [](Case& c) { c.sph.variable_smoothing = true; }, 1e-4},
    {"periodic",
     [](Case& c) {
         c.sph.domain = Box{{0, 0, -0.1}, {0.8, 0.2, 1}};
         c.sph.periodic = {"x"};
         c.sph.plane.erase(c.sph.plane.begin() + 1, c.sph.plane.begin() + 3);
     },
     1e-4},
};

Case make(const Scene& scene, Precision precision) {
    Case c = scenes::water_box(dx, {0.2, 0.2, 0.2});
    scenes::add_basin(c, size);
    Body box;
    box.name = "box";
    box.shape.box = Box{{0.26, 0, 0}, {0.32, 0.2, 0.1}};
    box.velocity = {-0.5, 0, 0};
    c.sph.body = {box};
    scene.change(c);
    c.sph.precision = precision;
    return c;
}

struct Run {
    std::vector<Vec3> x;      // by identity [m]
    std::vector<Vec3> force;  // on walls [N]
    double pressure;          // of a gauge [Pa]
};

Run run(const Case& c) {
    FluidSystem fluid(c, 0.4);
    const double dt = 0.3 * dx / fluid.largest_sound_speed();
    double t = 0, before = 0;
    for (int n = 0; n < 60; ++n) {
        scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
    fluid.refresh_neighbors(t);
    fluid.pack(t);
    fluid.sum_over_neighbors(Terms::force);
    Run r;
    for (std::size_t id = 0; id < fluid.particles.size(); ++id) {
        const int i = fluid.index_of(std::int64_t(id));
        r.x.push_back({fluid.particles.x[i], fluid.particles.y[i], fluid.particles.z[i]});
    }
    r.force = fluid.wall_forces();
    r.pressure = interpolate(fluid, {0.05, 0.1, 0.05}).p;
    return r;
}

}  // namespace

TEST_CASE("whatever a scene asks for, a run in float follows the one in double") {
    for (const Scene& scene : all_scenes) {
        INFO(scene.name);
        const Run exact = run(make(scene, Precision::float64));
        const Run close = run(make(scene, Precision::float32));
        REQUIRE(exact.x.size() == close.x.size());
        double error = 0;
        for (std::size_t k = 0; k < exact.x.size(); ++k)
            for (int a = 0; a < 3; ++a)
                error = std::max(error, std::abs(exact.x[k][a] - close.x[k][a]) / dx);
        CAPTURE(error);
        CHECK(error < scene.from_float);
        CHECK(error > 1e-12);  // not one and the same
        double largest = 0, difference = 0;
        for (std::size_t w = 0; w < exact.force.size(); ++w)
            for (int a = 0; a < 3; ++a) {
                largest = std::max(largest, std::abs(exact.force[w][a]));
                difference = std::max(difference, std::abs(exact.force[w][a] - close.force[w][a]));
            }
        CAPTURE(difference / largest);
        CHECK(largest > 1);  // [N]
        CHECK(difference < 10 * scene.from_float * largest);
        CHECK(close.pressure == Approx(exact.pressure).epsilon(10 * scene.from_float));
    }
}

namespace {

/// Sums of a disturbed blob that as a whole moves with `speed`, while a lone particle stands `far`
/// away.
FluidSystem blob(Precision precision, double speed, double far) {
    Case c = scenes::water_box(0.01, {0.1, 0.1, 0.1});
    c.info.gravity = {0, 0, 0};
    c.sph.max_speed = 3;
    c.sph.precision = precision;
    FluidSystem fluid(c, 0.2);
    scenes::disturb(fluid, 0.15, 1, 2000);
    Particles& p = fluid.particles;
    p.x[0] -= far;
    p.vx[0] = p.vy[0] = p.vz[0] = 0;
    for (std::size_t i = 1; i < p.size(); ++i) p.vx[i] += speed;
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::both);
    return fluid;
}

/// Largest change of rates and accelerations, over the largest of them.
double change(const FluidSystem& one, const FluidSystem& two) {
    double a = 0, rate = 0, a_change = 0, rate_change = 0;
    for (std::size_t id = 1; id < one.particles.size(); ++id) {
        const int i = one.index_of(std::int64_t(id)), j = two.index_of(std::int64_t(id));
        a = std::max(a, std::abs(one.particles.ax[i]));
        rate = std::max(rate, std::abs(one.particles.drho_dt[i]));
        a_change = std::max(a_change, std::abs(one.particles.ax[i] - two.particles.ax[j]));
        rate_change =
            std::max(rate_change, std::abs(one.particles.drho_dt[i] - two.particles.drho_dt[j]));
    }
    return std::max(a_change / a, rate_change / rate);
}

}  // namespace

TEST_CASE(
    "in double a common speed of 1000 m/s leaves sums as they are; float loses a digit each") {
    const FluidSystem still = blob(Precision::float64, 0, 1);
    CHECK(change(still, blob(Precision::float64, 1000, 1)) < 1e-11);  // 1000 eps over 1 m/s
    const double lost = change(blob(Precision::float32, 0, 1), blob(Precision::float32, 1000, 1));
    CHECK(lost > 1e-6);
    CHECK(lost < 1e-3);
}

TEST_CASE("in double a domain of 10,000 spacings costs no digits") {
    const FluidSystem near = blob(Precision::float64, 0, 1);
    CHECK(change(near, blob(Precision::float64, 0, 100)) < 1e-10);
    // the fixed point has 2^30 units: 1e-5 dx here, in each position
    const double lost = change(near, blob(Precision::float32, 0, 100));
    CHECK(lost > 1e-6);
    CHECK(lost < 1e-4);
}
