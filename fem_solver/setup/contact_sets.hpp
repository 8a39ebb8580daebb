#pragma once
// Resolves [[fem.contact]].

#include <vector>

#include "fem_solver/setup/model.hpp"
#include "fem_solver/setup/rigid_shell_faces.hpp"

namespace undertow::fem {

/// After the rigid bodies have been taken out of the parts, which have the thickness of shells.
/// InputError when a node of `nodes` belongs to no deformable element, or the surface is neither
/// wholly of one rigid body nor wholly free of them, or a set has shells and solids, or shells that
/// look against each other, or the two sets share a node, or the surface has triangles, or
/// adhesion_factor meets nodes without a shear strength behind them.
std::vector<ContactSet> make_contact_sets(const Case& c, const Mesh& mesh,
                                          const std::vector<Part>& parts,
                                          const std::vector<RigidSet>& bodies,
                                          const RigidShellFaces& faces);

}  // namespace undertow::fem
