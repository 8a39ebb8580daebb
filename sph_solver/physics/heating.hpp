#pragma once
// What friction inside the fluid turns into heat, for fluids whose pressure depends on their
// energy.

#include <vector>

#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// dE_i/dt = -1/2 sum_j a_ij . v_ij of the artificial viscosity and of the viscosity, where a_ij is
/// the acceleration that j gives to i: each of a pair gets half of the work the two lose.  [W/kg],
/// [n padded] [Monaghan 2005, Eq. 2.35]  What compression does, p d(rho)/rho^2, comes with the
/// density.
void dissipation(const PairPhysics& physics, const Neighborhood& neighbors,
                 std::vector<double>& heating);

}  // namespace undertow::sph
