#pragma once
// Small scenes for the tests.

#include <cmath>
#include <random>

#include "sph_solver/fluid_system.hpp"

namespace undertow::sph::scenes {

inline Case water_box(double dx, const Vec3& size, int dimension = 3) {
    Case input;
    input.file = "scene";
    input.info.dimension = dimension;
    input.sph.present = true;
    input.sph.spacing = dx;
    Fluid water;
    water.name = "water";
    water.density = 1000;
    water.viscosity = 1e-3;
    input.sph.fluid = {water};
    Fill fill;
    fill.fluid = "water";
    fill.box = {{0, 0, 0}, size};
    input.sph.fill = {fill};
    return input;
}

inline PlaneWall plane(const char* name, const Vec3& point, const Vec3& normal,
                       Slip slip = Slip::free_slip) {
    return {name, point, normal, slip};
}

/// Five walls around a box open at the top.
inline void add_basin(Case& input, const Vec3& size) {
    input.sph.plane = {plane("floor", {0, 0, 0}, {0, 0, 1}), plane("left", {0, 0, 0}, {1, 0, 0}),
                       plane("right", {size[0], 0, 0}, {-1, 0, 0})};
    if (input.info.dimension == 3) {
        input.sph.plane.push_back(plane("near", {0, 0, 0}, {0, 1, 0}));
        input.sph.plane.push_back(plane("far", {0, size[1], 0}, {0, -1, 0}));
    }
}

/// Water over the slide of the bucket scene, `lower` m deep; Newtonian or Herschel-Bulkley.
inline Case two_layers(double dx, const Vec3& size, double lower, bool viscoplastic,
                       int dimension = 3) {
    Case input = water_box(dx, size, dimension);
    Fluid slide;
    slide.name = "slide";
    slide.density = 1681;
    if (viscoplastic)
        slide.yield_stress = 7.3, slide.consistency = 3, slide.flow_index = 0.35;
    else
        slide.viscosity = 2;
    input.sph.fluid.push_back(slide);
    Fill low;
    low.fluid = "slide";
    low.box = {{0, 0, 0}, {size[0], size[1], lower}};
    input.sph.fill.push_back(low);   // it has the place
    return input;
}

/// Moves every particle by up to `share` of a spacing and gives it a random velocity and pressure.
inline void disturb(FluidSystem& fluid, double share, double speed, double pressure) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in(-1, 1);
    Particles& p = fluid.particles;
    const bool flat = fluid.physics().dimension == 2;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.x[i] += share * fluid.spacing() * in(random);
        if (!flat) p.y[i] += share * fluid.spacing() * in(random);
        p.z[i] += share * fluid.spacing() * in(random);
        p.vx[i] += speed * in(random);
        if (!flat) p.vy[i] += speed * in(random);
        p.vz[i] += speed * in(random);
        p.drho[i] += pressure * in(random) / std::pow(fluid.fluid_of(i).c0, 2);
    }
}

/// One step of the two-pass integrator without contact.
inline Health two_pass_step(FluidSystem& fluid, double& t, double dt, double dt_before) {
    fluid.refresh_neighbors(t);
    fluid.pack(t);
    fluid.sum_over_neighbors(Terms::rate);
    fluid.advance_density(dt_before);
    fluid.pack(t);
    fluid.sum_over_neighbors(Terms::force);
    fluid.add_wall_friction();
    fluid.take_viscosity(dt, dt_before);
    fluid.constrain_ends(t, dt, dt_before);
    const Health health = fluid.kick_and_drift(dt, dt_before, 0, false);
    t += dt;
    return health;
}

}  // namespace undertow::sph::scenes
