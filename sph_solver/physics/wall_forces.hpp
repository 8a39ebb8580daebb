#pragma once
// What the fluids press on rigid walls.

#include <vector>

#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// Force of each fluid on each mirror plane, then on each body, from the pairs of particles with
/// images and dummies: -sum_i m_i a_i. A plane takes the part along its normal: what its images do
/// along it cancels in pairs. Of the image of a dummy the plane takes the part along its normal and
/// the body the rest, which makes the body's force that of the half which is modeled. A resolved
/// no-slip plane also takes the shear of its images; that of an implicit viscous update is missing.
/// [N], [planes + bodies, fluids]
std::vector<Vec3> wall_forces(const PairPhysics& physics, const Neighborhood& neighbors,
                              const MirrorPlanes& mirror, const Bodies& bodies,
                              const NoSlipImages& no_slip);

}  // namespace undertow::sph
