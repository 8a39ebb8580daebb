#pragma once
// Patches of a few neighboring elements, for what is averaged over them.

#include <cstdint>
#include <vector>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// Splits `elements` (tetrahedra of the mesh) into patches of about `target` that hang together by
/// faces; compact ones, because the next element is always the one with the most nodes in the patch
/// already. Patch of each, in the order given; patches count from 0.
std::vector<std::int32_t> make_patches(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                                       int target);

}  // namespace undertow::fem
