#pragma once
// Reader of Gmsh's .msh format, version 4.1, ASCII.

#include <string>
#include <vector>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// Physical groups become sets of the same name (an unnamed group: its number): of volumes ->
/// volume sets, of surfaces -> facet sets with normals turned out of the solid, of curves and
/// points -> node sets. 8-node hexahedra and 4-node quads; nodes that no hexahedron uses are
/// dropped. Groups of surfaces named in `immobile` belong to no hexahedron: their facets and nodes
/// are kept as the file has them. InputError with file:line for anything else.
Mesh read_gmsh(const std::string& path, const std::vector<std::string>& immobile = {});

}  // namespace undertow::fem
