#include "fem_solver/implicit/supernodes.hpp"

#include <algorithm>
#include <utility>

namespace undertow::fem {
namespace {

// Columns join although they are not quite alike while this share of the panel holds zeros only.
constexpr double share_of_zeros = 0.2;

using Columns = std::vector<std::vector<std::int32_t>>;

/// Rows below the diagonal of each column of the factor: those of the matrix and of the columns
/// whose first row it is.
Columns columns_of_factor(const BlockMatrix& k) {
    Columns column(k.rows());
    std::vector<std::int32_t> merged;
    for (std::size_t j = 0; j < k.rows(); ++j) {
        std::vector<std::int32_t>& own = column[j];  // children have put theirs in already
        const auto rows = k.row.begin();
        merged.clear();
        std::set_union(own.begin(), own.end(), rows + k.begin[j] + 1, rows + k.begin[j + 1],
                       std::back_inserter(merged));
        own = merged;
        if (own.empty()) continue;
        std::vector<std::int32_t>& parent = column[own.front()];
        merged.clear();
        std::set_union(parent.begin(), parent.end(), own.begin() + 1, own.end(),
                       std::back_inserter(merged));
        parent = merged;
    }
    return column;
}

}  // namespace

std::vector<Supernode> find_supernodes(const BlockMatrix& k) {
    Columns column = columns_of_factor(k);
    std::vector<Supernode> nodes;
    std::vector<std::int32_t> supernode_of(k.rows());
    std::size_t panel = 0;
    for (std::size_t first = 0; first < k.rows();) {
        std::size_t last = first, entries = column[first].size() + 1;
        // the next column, if it is the parent of this one, has all of this one's other rows
        while (last + 1 < k.rows() && !column[last].empty() &&
               column[last].front() == std::int32_t(last + 1)) {
            const std::size_t width = last + 2 - first, below = column[last + 1].size();
            const std::size_t room = width * (width + 1) / 2 + width * below;
            if (double(room - entries - below - 1) > share_of_zeros * double(room)) break;
            entries += below + 1;
            ++last;
        }
        Supernode node;
        node.first = std::int32_t(first);
        node.columns = std::int32_t(last + 1 - first);
        node.below = std::move(column[last]);
        node.panel = panel;
        panel += 9 * node.rows() * std::size_t(node.columns);
        for (std::size_t j = first; j <= last; ++j) supernode_of[j] = std::int32_t(nodes.size());
        nodes.push_back(std::move(node));
        first = last + 1;
    }
    for (std::size_t s = 0; s < nodes.size(); ++s)
        if (!nodes[s].below.empty())
            nodes[supernode_of[nodes[s].below.front()]].children.push_back(std::int32_t(s));
    return nodes;
}

}  // namespace undertow::fem
