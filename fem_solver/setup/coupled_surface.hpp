#pragma once
// Resolves [[fem.surface]]: faces of solids, both faces of shells.

#include "fem_solver/setup/model.hpp"
#include "fem_solver/setup/rigid_shell_faces.hpp"

namespace undertow::fem {

/// `parts` give the thickness of shells. InputError for a set that mixes shells and solids, and for
/// shells under [fem.water].
CoupledSurface make_coupled_surface(const Case& c, const Mesh& mesh,
                                    const std::vector<Part>& parts,
                                    const RigidShellFaces& faces);

}  // namespace undertow::fem
