#pragma once
// The nodes of a list of facets, for loads and surfaces that carry their own short node list.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// Each node once, increasing.
inline std::vector<std::int32_t> nodes_of(const std::vector<Quad>& facets) {
    std::vector<std::int32_t> nodes;
    for (const Quad& q : facets) nodes.insert(nodes.end(), q.begin(), q.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

/// Turns the corners of `facets` into indices into `nodes` = nodes_of(facets).
inline void number_within(const std::vector<std::int32_t>& nodes, std::vector<Quad>& facets) {
    for (Quad& q : facets)
        for (std::int32_t& n : q)
            n = std::int32_t(std::lower_bound(nodes.begin(), nodes.end(), n) - nodes.begin());
}

}  // namespace undertow::fem
