#pragma once
// Stable step of the fluid.

#include <algorithm>
#include <cmath>
#include <string>

#include "case/case.hpp"

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

/// cfl of the acoustic limit: the case's, or the safe value of its integrator (`auto` may take two
/// passes).
inline double acoustic_cfl(const SphSettings& sph) {
    if (sph.cfl > 0) return sph.cfl;
    return default_cfl(sph.integrator == Integrator::one_pass ? Integrator::one_pass
                                                              : Integrator::two_pass,
                       sph.smoothing_ratio);
}

constexpr double viscous_cfl = 0.125;   // of h^2 rho/mu  [Morris 1997]

/// How much shorter the step of a viscous form is than Morris' laplacian. Largest eigenvalue times step
/// on a lattice (stable up to 2, Wendland C2, h = 1.2 to 2 dx): 0.85 for the laplacian at 0.125 h^2/nu,
/// 1.2 to 1.9 for "strain", which resists compression with 3 mu.
constexpr double viscous_stiffness(ViscousForm form) {
    return form == ViscousForm::strain ? 2 : 1;
}

/// What limits a step.
struct StepLimits {
    double h;                         // smoothing length, the least [m]
    double c0;                        // that of the fluid of the least h/c0, times least h/its h [m/s]
    double max_speed;                 // [m/s]
    double max_acceleration;          // [m/s2]
    double max_kinematic_viscosity;   // largest mu/rho0 anywhere, times viscous_stiffness [m2/s]
};

/// dt = min( cfl h/(c0 + |v|), lambda' sqrt(h/|a|), h^2 rho/(8 mu) )   [Wang 2024, Eq. 14, with the
/// acoustic and viscous limits it leaves out; Morris 1997]
inline StableStep stable_step(const StepLimits& of, double cfl, double force_cfl) {
    StableStep step{cfl * of.h / (of.c0 + of.max_speed), "sound"};
    const double force = force_cfl * std::sqrt(of.h / std::max(of.max_acceleration, 1e-300));
    if (force < step.dt) step = {force, "force"};
    if (of.max_kinematic_viscosity > 0) {
        const double viscous = viscous_cfl * of.h * of.h / of.max_kinematic_viscosity;
        if (viscous < step.dt) step = {viscous, "viscosity"};
    }
    return step;
}

/// The viscosity whose limit is the acoustic one of fluid at rest: a larger one would shorten steps.
/// [Pa s]
inline double largest_free_viscosity(const SphSettings& sph, double rho0, double c0) {
    double dx = sph.spacing;   // the finest: it asks for the shortest step
    for (const Fluid& f : sph.fluid)
        if (f.spacing > 0) dx = std::min(dx, f.spacing);
    const double h = sph.smoothing_ratio * dx;
    return viscous_cfl * rho0 * h * c0 / (acoustic_cfl(sph) * viscous_stiffness(sph.viscous_form));
}

}  // namespace undertow::sph
