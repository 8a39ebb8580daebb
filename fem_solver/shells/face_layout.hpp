#pragma once
// Points of a surface that forces reach: nodes of solids as they are, of shells that deform the
// points of both faces, half a thickness off the middle.

#include <cstdint>
#include <vector>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

struct FaceLayout {
    std::vector<std::int32_t> node;  // of the mesh, increasing; of a shell each on both its faces
    std::vector<Quad> quad;          // indices into `node`; normals out of the solid
    std::vector<double> offset;      // [m] of each point from the shell's middle, + and -; empty
                                     // without shells
    std::vector<std::int32_t> twin;  // of each point with an offset < 0 the one opposite
};

}  // namespace undertow::fem
