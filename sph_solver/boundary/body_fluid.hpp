#pragma once
// What the dummies of bodies show to the fluid: its pressure and its velocity, continued.

#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// p_w = sum_f [p_f + rho0 (g - a_w).(x_w - x_f)] W / sum_f W, a_w the body's acceleration, over
/// the fluid and its images.  [Adami, Hu & Adams 2012, Eqs. 23, 27] A dummy shows the mean of the
/// fluid's velocities as the surface reflects them (NearWalls::reflect): along the face as they
/// are, across it turned round relative to the wall, as at mirror planes. Each particle is
/// reflected by the surface next to itself: what flows past an edge is not turned round by the
/// dummies of the other face. Shear at the wall is a stress of its own (wall_friction.hpp), so that
/// it does not disturb the continuity sum.
/// A dummy passes for the fluid with the largest share in sum_f W, and shows the mean viscosity.
void continue_into_bodies(const PairPhysics& physics, const Neighborhood& neighbors,
                          const MirrorPlanes& mirror, const std::vector<Vec3>& reflected,
                          Bodies& bodies);

}  // namespace undertow::sph
