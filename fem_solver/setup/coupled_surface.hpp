#pragma once
// Resolves [[fem.surface]]: faces of solids, both faces of shells.

#include <map>

#include "fem_solver/setup/model.hpp"
#include "fem_solver/setup/rigid_shell_faces.hpp"

namespace undertow::fem {

/// [m] of the shells that deform, by sorted nodes.
std::map<Quad, double> shell_thicknesses(const Mesh& mesh, const std::vector<Part>& parts);

/// Points of the facets, each of the surface with that number: of a facet in `shells` both faces,
/// the one it looks to first.
FaceLayout lay_out_faces(const std::vector<Quad>& facets, const std::vector<std::int32_t>& surface,
                         const std::map<Quad, double>& shells);

/// `parts` give the thickness of shells. InputError for a set that mixes shells and solids, and for
/// shells under [fem.water].
CoupledSurface make_coupled_surface(const Case& c, const Mesh& mesh,
                                    const std::vector<Part>& parts,
                                    const RigidShellFaces& faces);

}  // namespace undertow::fem
