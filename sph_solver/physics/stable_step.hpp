#pragma once
// Stable step of the fluid.

#include <cmath>
#include <string>

#include "case/case.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

struct StableStep {
    double dt;             // [s]
    const char* limiter;   // "sound", "force", "viscosity"
};

/// Acoustic limits measured on a resting column at c0 dt/dx: 0.65 with one pass per step, 1.74 with
/// two. Impacts and run-ups bear half: of dam breaks with c0 = 10 v, two passes at 1.3 ran through at 15 mm
/// and lost a particle at 10 mm, at 0.9 they ran through; one pass blew up at 0.49 and lost particles at
/// 0.36.
inline double default_cfl(Integrator integrator, double h_over_dx) {
    return (integrator == Integrator::two_pass ? 0.9 : 0.25) / h_over_dx;
}

/// dt = min( cfl h/(c0 + |v|), lambda' sqrt(h/|a|), h^2 rho/(8 mu) )   [Wang 2024, Eq. 14, with the
/// acoustic and viscous limits it leaves out; Morris 1997]
inline StableStep stable_step(const PairPhysics& physics, double cfl, double force_cfl,
                              double max_speed, double max_acceleration) {
    const double h = physics.h;
    StableStep step{cfl * h / (physics.fluid.c0 + max_speed), "sound"};
    const double force = force_cfl * std::sqrt(h / std::max(max_acceleration, 1e-300));
    if (force < step.dt) step = {force, "force"};
    if (physics.fluid.mu > 0) {
        const double viscous = 0.125 * h * h * physics.fluid.rho0 / physics.fluid.mu;
        if (viscous < step.dt) step = {viscous, "viscosity"};
    }
    return step;
}

}  // namespace undertow::sph
