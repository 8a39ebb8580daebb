#pragma once
// The structured block of [fem.block].

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// divisions[0] x [1] x [2] equal hexahedra in the box, or between the eight corners; or each of
/// them cut into six tetrahedra. Volume set "block"; facet sets "xmin",
/// "xmax", "ymin", "ymax", "zmin", "zmax". InputError for an empty box or divisions < 1.
Mesh make_block(const FemBlock& block);

}  // namespace undertow::fem
