#pragma once
// What in a case cannot be meant so: told at the start, before hours are spent on it.

#include <string>
#include <vector>

#include "sph_solver/fluid_system.hpp"

namespace undertow::sph {

/// Spacings across a scene up to which positions of a precision tell particles apart: 2^30 steps are
/// 1e-3 dx in sums in float, and a tenth of a list's skin where lists alone go by them.
double widest_scene(Precision precision);

/// Sentences to warn with, of a fluid as it starts. InputError where nothing can come of the run: a
/// sound speed at which the fluid's own weight crushes it, a scene too wide for its positions.
std::vector<std::string> doubts_at_start(const Case& input, const FluidSystem& fluid);

}  // namespace undertow::sph
