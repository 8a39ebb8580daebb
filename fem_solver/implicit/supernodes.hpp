#pragma once
// Where the Cholesky factor of a sparse matrix has entries, as dense panels.
//
// Neighboring columns whose entries lie in the same rows form a supernode: a panel of the factor
// that dense kernels can work on. Each passes what is left of its front on to its parent, the
// supernode of its first row below (multifrontal method [Duff and Reid 1983; Liu 1992]).

#include <cstdint>
#include <vector>

#include "fem_solver/implicit/stiffness_matrix.hpp"

namespace undertow::fem {

struct Supernode {
    std::int32_t first = 0, columns = 0;  // of blocks
    std::vector<std::int32_t> below;      // [blocks] rows under its columns, increasing
    std::vector<std::int32_t> children;   // supernodes that come before
    std::size_t panel = 0;                // first entry of its panel in the factor
    std::size_t rows() const { return std::size_t(columns) + below.size(); }  // of blocks
};

/// Supernodes of the factor of a matrix with the pattern of `k`, in the order of its rows.
std::vector<Supernode> find_supernodes(const BlockMatrix& k);

}  // namespace undertow::fem
