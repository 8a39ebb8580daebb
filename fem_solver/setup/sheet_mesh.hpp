#pragma once
// The structured sheet of [fem.block] with cells = "shells".

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// A flat rectangle of quads, perpendicular to the axis along which divisions are 0 and the box has no
/// extent. Volume and facet set "block", normals along that axis; node sets "xmin", ... of its four
/// edges. InputError for another box or other divisions.
Mesh make_sheet(const FemBlock& block);

}  // namespace undertow::fem
