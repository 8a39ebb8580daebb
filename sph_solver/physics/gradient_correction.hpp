#pragma once
// The velocity gradient of the continuity equation, corrected for the arrangement of the neighbors:
//
//   d(rho_i)/dt = rho_i sum_j V_j v_ij . M_i^-1 grad W_ij,  M_i = sum_j V_j (x_j - x_i) grad W_ij
//   [Randles & Libersky 1996; Bonet & Lok 1999]
//
// exact in a linear field. M changes slowly: it is found when the lists are rebuilt, and kept.
// Forces stay as they are, opposite within each pair.

#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/physics/pair_sums.hpp"
#include "sph_solver/physics/pair_terms.hpp"

namespace undertow::sph {

/// Fills neighbors.gradient_correction() (or exact()'s) from the packed records; after a rebuild.
void find_gradient_correction(const PairPhysics& physics, Neighborhood& neighbors);

/// M^-1 of a cluster's eight.
template <class Real>
Symmetric<Eight<Real>> correction_of(const Neighborhood& neighbors, int cluster) {
    Symmetric<Eight<Real>> m;
    __builtin_memcpy(static_cast<void*>(&m),
                     &neighbors.gradient_correction_in<Real>()[std::size_t(cluster) * 6 * lanes],
                     sizeof m);
    return m;
}

}  // namespace undertow::sph
