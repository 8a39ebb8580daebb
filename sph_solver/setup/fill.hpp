#pragma once
// From the case to particles.

#include "case/case.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"

namespace undertow::sph {

struct Filled {
    Particles particles;
    std::vector<std::int64_t> first_id;   // [fills + 1] identities of each fill's particles: from its
                                          // entry to the next
};

/// Particles in the middle of cubic cells of all fills as FillPlan deals out the places, under the
/// pressure of what lies above them. fluids: in the order of [[sph.fluid]]. InputError: a box must
/// hold a whole number of cells to 1 % of a spacing.
Filled fill_particles(const Case& input, const std::vector<FluidLaw>& fluids);

}  // namespace undertow::sph
