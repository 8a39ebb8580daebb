#include "dam_break_scene.hpp"

#include <cmath>
#include <stdexcept>

#include "case/case_file.hpp"
#include "sph_solver/physics/stable_step.hpp"

namespace undertow::benchmarks {

using namespace sph;

namespace {

constexpr double depth = 0.3;   // [m] H of the case
constexpr double width = 0.15;  // [m] of its tank

Snapshot state_of(const FluidSystem& fluid, double t) {
    const Particles& p = fluid.particles;
    return {t, p.x, p.y, p.z, p.vx, p.vy, p.vz, p.drho};
}

}  // namespace

Case dam_break(double spacing, const std::vector<std::string>& set) {
    CaseOptions options;
    options.variants = {"rigid_wall"};
    options.set = {"sph.spacing=" + std::to_string(spacing)};
    options.set.insert(options.set.end(), set.begin(), set.end());
    return read_case(UNDERTOW_CASES "/dam_break", options);
}

double step_size(const Case& input, const FluidSystem& fluid, const Health& health, bool two_pass) {
    const double cfl = default_cfl(two_pass ? Integrator::two_pass : Integrator::one_pass,
                                   input.sph.smoothing_ratio);
    return stable_step({fluid.physics().h, fluid.largest_sound_speed(), health.max_speed,
                        health.max_acceleration, health.max_kinematic_viscosity},
                       cfl, input.sph.force_cfl)
        .dt;
}

Health take_step(FluidSystem& fluid, Steps& s, bool two_pass) {
    fluid.refresh_neighbors(s.t);
    fluid.pack(s.t);
    if (two_pass && s.before > 0) {
        fluid.sum_over_neighbors(Terms::rate);
        fluid.advance_density(s.before);
        fluid.pack(s.t);
    }
    fluid.sum_over_neighbors(two_pass ? Terms::force : Terms::both);
    fluid.add_wall_friction();
    fluid.take_viscosity(s.dt, s.before);
    const Health health = fluid.kick_and_drift(s.dt, s.before, s.before_that, !two_pass);
    s.before_that = s.before, s.before = s.dt, s.t += s.dt;
    return health;
}

std::vector<Snapshot> develop(const Case& input, const std::vector<double>& t_star) {
    FluidSystem fluid(input, 0.4);
    std::vector<Snapshot> found;
    Health health = fluid.health();
    Steps steps;
    for (const double star : t_star) {
        const double until = star * std::sqrt(depth / 9.81);
        while (steps.t < until) {
            steps.dt = step_size(input, fluid, health, true);
            health = take_step(fluid, steps, true);
        }
        found.push_back(state_of(fluid, steps.t));
    }
    return found;
}

Snapshot side_by_side(const Snapshot& one, int copies) {
    Snapshot all;
    all.t = one.t;
    for (int c = 0; c < copies; ++c) {
        const bool mirrored = c % 2;
        for (std::size_t i = 0; i < one.x.size(); ++i) {
            all.x.push_back(one.x[i]);
            all.y.push_back(mirrored ? (c + 1) * width - one.y[i] : c * width + one.y[i]);
            all.z.push_back(one.z[i]);
            all.vx.push_back(one.vx[i]);
            all.vy.push_back(mirrored ? -one.vy[i] : one.vy[i]);
            all.vz.push_back(one.vz[i]);
            all.drho.push_back(one.drho[i]);
        }
    }
    return all;
}

Case widened(Case one, int copies) {
    const double far = copies * width;
    for (Fill& fill : one.sph.fill) fill.box.max[1] = far;
    for (Body& body : one.sph.body) body.shape.box->max[1] += far - width;
    for (PlaneWall& plane : one.sph.plane)
        if (plane.point[1] == width) plane.point[1] = far;
    one.sph.domain->max[1] += far - width;
    return one;
}

void load(const Snapshot& state, FluidSystem& fluid) {
    Particles& p = fluid.particles;
    if (state.x.size() != p.size())
        throw std::runtime_error("the state has another number of particles than the case");
    p.x = state.x, p.y = state.y, p.z = state.z;
    p.vx = state.vx, p.vy = state.vy, p.vz = state.vz;
    p.drho = state.drho;
}

}  // namespace undertow::benchmarks
