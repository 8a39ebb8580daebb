#include "fem_solver/elements/coloring.hpp"

#include <algorithm>

namespace undertow::fem {

Coloring color_by_nodes(const std::vector<std::vector<std::int32_t>>& nodes_of_group,
                        std::size_t n_nodes, std::size_t window) {
    const std::size_t n_groups = nodes_of_group.size();
    std::vector<std::vector<std::int32_t>> groups_at(n_nodes);
    for (std::size_t g = 0; g < n_groups; ++g)
        for (std::int32_t n : nodes_of_group[g])
            if (groups_at[n].empty() || groups_at[n].back() != std::int32_t(g))
                groups_at[n].push_back(std::int32_t(g));

    std::vector<std::int32_t> color(n_groups, -1);
    std::vector<std::int32_t> taken_by(n_groups + 1, -1);  // color -> last group that saw it taken
    std::int32_t n_colors = 0;
    for (std::size_t g = 0; g < n_groups; ++g) {
        for (std::int32_t n : nodes_of_group[g])
            for (std::int32_t other : groups_at[n])
                if (color[other] >= 0) taken_by[color[other]] = std::int32_t(g);
        std::int32_t free = 0;
        while (taken_by[free] == std::int32_t(g)) ++free;
        color[g] = free;
        n_colors = std::max(n_colors, free + 1);
    }

    Coloring out;
    for (std::size_t first = 0; first < n_groups; first += std::min(window, n_groups - first)) {
        const std::size_t last = first + std::min(window, n_groups - first);
        for (std::int32_t c = 0; c < n_colors; ++c) {
            out.begin.push_back(std::int32_t(out.order.size()));
            for (std::size_t g = first; g < last; ++g)
                if (color[g] == c) out.order.push_back(std::int32_t(g));
        }
    }
    out.begin.push_back(std::int32_t(out.order.size()));
    return out;
}

}  // namespace undertow::fem
