#pragma once
// Several blocks in one mesh, for contact between them.

#include <array>
#include <functional>
#include <string>

#include "fem_solver/structure.hpp"

namespace undertow::fem {

/// Adds a structured block; its sets are called NAME for the volume and NAME.xmin ... NAME.zmax.
void add_block(Mesh& mesh, const std::string& name, const Box& box, std::array<int, 3> divisions);

/// Adds n x n shells that span a and b from the corner at `from`, to the volume and the facet set
/// NAME; normals along a x b. Nodes within 1e-9 of one that is there are shared. After all solid
/// blocks.
void add_sheet(Mesh& mesh, const std::string& name, const Vec3& from, const Vec3& a, const Vec3& b,
               int n);

/// Moves every node by a map of space.
void map_nodes(Mesh& mesh, const std::function<Vec3(const Vec3&)>& map);

/// An [fem] table with materials "soil" (E [Pa], density [kg/m3], nu = 0.3) and "steel" (7850).
Case two_solids(double young_modulus, double density);

/// Sets the gravity of a model already in a structure.
void set_gravity(Structure& structure, const Vec3& gravity);

}  // namespace undertow::fem
