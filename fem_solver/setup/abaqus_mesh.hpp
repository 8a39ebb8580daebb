#pragma once
// Reader of the mesh in an Abaqus input file (.inp), as Abaqus, Gmsh, meshio and others write it.

#include <string>

#include "fem_solver/setup/mesh_builder.hpp"

namespace undertow::fem {

/// Nodes, elements and sets; parts, each in one instance at most, with its translation and
/// rotation. Element sets become volume sets by their solids, facet sets by their surface elements
/// (SFM3D4, CPS4, ...), node sets by their curves (T3D2); node sets and surfaces of type NODE are
/// node sets, surfaces of element faces facet sets. Shells are elements where `of_case.shells`
/// names one of their sets. A name that several parts have becomes INSTANCE.NAME. What else the
/// file says (materials, steps, ...) is skipped, each keyword told once in Mesh::remarks.
/// InputError with file:line for elements there are none of, keywords that change the mesh, and
/// other files.
Mesh read_abaqus(const std::string& path, SetsOfCase of_case = {});

}  // namespace undertow::fem
