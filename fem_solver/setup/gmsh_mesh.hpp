#pragma once
// Reader of Gmsh's .msh format, versions 4.1 and 2.2, ASCII.

#include <string>

#include "fem_solver/setup/mesh_builder.hpp"

namespace undertow::fem {

/// Physical groups become sets of the same name (an unnamed group: its number): of volumes ->
/// volume sets, of surfaces -> facet sets with normals turned out of the solid, of curves and
/// points -> node sets. 8-node hexahedra and 4-node tetrahedra, 4-node quads and triangles; nodes
/// that no element uses are dropped. Groups of surfaces named in `of_case.immobile` belong to no element:
/// their facets and nodes are kept as the file has them. Quads of the groups named in `of_case.shells` are
/// elements, and the group is both a volume set and, as the file has it, a facet set. InputError
/// with file:line for anything else.
Mesh read_gmsh(const std::string& path, SetsOfCase of_case = {});

}  // namespace undertow::fem
