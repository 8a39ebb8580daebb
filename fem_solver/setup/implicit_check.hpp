#pragma once
// What implicit parts (fem_solver/implicit) go together with, and what not.

#include "case/case.hpp"
#include "fem_solver/setup/model.hpp"

namespace undertow::fem {

/// InputError for an implicit part that is plastic or rigid or not of one-point hexahedra, touches
/// a rigid body or an absorbing boundary, has more bulk viscosity than its scheme bears, or leaves
/// a run without any limit of the step.
void check_implicit_parts(const Case& c, const Model& model);

/// Whether nothing in the structure limits the step: all that deforms is implicit.
bool only_implicit_parts(const Model& model);

}  // namespace undertow::fem
