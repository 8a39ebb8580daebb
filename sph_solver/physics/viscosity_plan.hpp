#pragma once
// How the viscous forces of a scene are taken, and how stiff what does not yield is.

#include <vector>

#include "case/case.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"

namespace undertow::sph {

/// What does not yield may shear with this share of the flow's own rate V/H: Papanastasiou's m V/H
/// is then 1000, from where velocities of channels and slumps no longer depend on it.
constexpr double creep_share = 1e-3;

/// `auto` goes implicit where the explicit step would be this many times shorter than the acoustic
/// one.
constexpr double implicit_from = 10;

/// The flow's own shear rate [1/s]: largest expected speed (a tenth of c0 where it is not known)
/// over the height of the fills.
double shear_rate_of_flow(const Case& input, double c0);

/// Settles max_viscosity of the viscoplastic fluids that leave it open. c0: largest [m/s].
/// Returns true if the update is to be implicit. InputError: a cap below the Newtonian viscosity.
bool plan_viscosity(const Case& input, double c0, std::vector<FluidLaw>& laws);

/// What the cap of the viscosity makes of a viscoplastic fluid that should stand still.
struct Creep {
    double share_at_cap = 0;  // of the volume: viscosity above half its cap
    double rate = 0;          // [1/s] largest shear rate there: a body at rest would have 0
    double at_yield = 0;      // [1/s] shear rate at which the stress reaches half the yield stress
};
Creep creep_of(const FluidLaw& law, int fluid, const Particles& particles);

}  // namespace undertow::sph
