#pragma once
// From the case to particles.

#include "case/case.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"

namespace undertow::sph {

/// Largest expected speed [m/s]: sph.max_speed, or 2 sqrt(g H) of the fills' total height plus the
/// largest initial speed (the tip of a dam break on a dry bed, Ritter 1892).
double expected_speed(const Case& input);

/// Constants of the (single) fluid; throws InputError when the case has none or more than one.
FluidLaw resolve_fluid(const Case& input);

/// Particles in the middle of cubic cells of all fills, with hydrostatic pressure below
/// `surface_level`. A box must hold a whole number of cells to 1 % of a spacing, else InputError.
Particles fill_particles(const Case& input, const FluidLaw& fluid);

}  // namespace undertow::sph
