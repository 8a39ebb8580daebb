#pragma once
// Constants of the pair sums from the case.

#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// Throws InputError where choices of the case do not go together.
PairPhysics resolve_physics(const Case& input);

}  // namespace undertow::sph
