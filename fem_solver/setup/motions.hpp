#pragma once
// [[fem.motion]] with its names resolved.

#include <vector>

#include "fem_solver/setup/model.hpp"

namespace undertow::fem {

/// Marks the directions of rigid bodies that are told (RigidSet::driven). InputError for nodes that
/// cannot be told, and for a motion that begins while the structure is held (start.settle).
std::vector<PrescribedMotion> make_motions(const Case& c, const Mesh& mesh,
                                           std::vector<RigidSet>& bodies);

/// Two motions, or a support and a motion, in one direction of one node; motions on nodes of an
/// absorbing boundary or an implicit part: InputError. Then driven bodies are free there no more.
void check_motions(const Case& c, Model& model);

}  // namespace undertow::fem
