#pragma once
// Colors for groups of elements, so that no two groups of a color share a node.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace undertow::fem {

struct Coloring {
    std::vector<std::int32_t> order;  // groups, sorted by window and color, else as given
    std::vector<std::int32_t> begin;  // first of each color in `order`, and the end
};

/// Greedy, in the order given: the smallest color that no neighbor has. Colors follow each other
/// within windows of so many groups.
Coloring color_by_nodes(const std::vector<std::vector<std::int32_t>>& nodes_of_group,
                        std::size_t n_nodes,
                        std::size_t window = std::numeric_limits<std::size_t>::max());

}  // namespace undertow::fem
