#pragma once
// Where the fluid ends: which particles lie at its free surface and which are near it.

#include <cstdint>
#include <vector>

#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// Finds the depth of every particle from the positions in the records, and stores it in
/// `neighbors`. lambda_i = sum_j V_j x_ij . (-grad W_ij) is the dimension d inside and d/2 on a
/// plane surface. Below 0.75 d in 2D and 0.8 d in 3D a particle lies at the surface [Lee et al.
/// 2008: 1.5, 2.4]; below d/2 it is spray or the edge of a jet; whoever sees one of those within 2h
/// is near the surface [Sun et al. 2018]. Images and dummies complete the kernel: a wall is no free
/// surface. The coupled surface has no records: what touches it counts as free.
void find_free_surface(const PairPhysics& physics, Neighborhood& neighbors);

}  // namespace undertow::sph
