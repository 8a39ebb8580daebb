#pragma once
// Several blocks in one mesh, for contact between them.

#include <array>
#include <functional>
#include <string>

#include "fem_solver/structure.hpp"

namespace undertow::fem {

/// Adds a structured block; its sets are called NAME for the volume and NAME.xmin ... NAME.zmax.
void add_block(Mesh& mesh, const std::string& name, const Box& box, std::array<int, 3> divisions);

/// Moves every node by a map of space.
void map_nodes(Mesh& mesh, const std::function<Vec3(const Vec3&)>& map);

/// An [fem] table with materials "soil" (E [Pa], density [kg/m3], nu = 0.3) and "steel" (7850).
Case two_solids(double young_modulus, double density);

/// Sets the gravity of a model already in a structure.
void set_gravity(Structure& structure, const Vec3& gravity);

}  // namespace undertow::fem
