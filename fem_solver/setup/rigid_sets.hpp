#pragma once
// Resolves [[fem.rigid]]: takes the elements of rigid bodies out of the parts that deform.

#include <vector>

#include "fem_solver/setup/model.hpp"

namespace undertow::fem {

/// Removes the sets' elements from `parts` (one per [[fem.part]], in that order). InputError for an
/// element in two bodies, and for a node that a body shares with a deformable element or another
/// body.
std::vector<RigidSet> take_rigid_sets(const Case& c, const Mesh& mesh, std::vector<Part>& parts);

/// A support may name nodes of a body where the body cannot move anyway (a plane of symmetry): they
/// are left to the body. InputError where it could.
void leave_rigid_nodes(std::vector<Support>& supports, const std::vector<RigidSet>& bodies);

}  // namespace undertow::fem
