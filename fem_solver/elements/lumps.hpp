#pragma once
// Elements of a large mesh in compact lumps, so that a chunk of them touches few nodes.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// The same elements in another order: every `size` in a row, from the first on, form a lump that
/// is about as many elements long as wide and high, and neighboring lumps mostly follow each other.
/// Recursive bisection across the longest side, counted in elements; within a lump the order of the
/// mesh, whose rows gather well.
std::vector<std::int32_t> in_lumps(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                                   std::size_t size);

}  // namespace undertow::fem
