#pragma once
// Whether hexahedra have folded: their volume alone does not tell, for clay keeps it however bent.
// (Of a tetrahedron it does.)

#include <cstddef>
#include <cstdint>

#include "fem_solver/mesh.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

/// A corner's three neighbors along +xi, +eta, +zeta or against them, right-handed.
inline constexpr int corner_edges[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                           {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

struct WorstCorner {
    std::size_t element = 0;
    std::int32_t node = 0;
    double share = 1;  // its Jacobian over the mean of the element's corners at the start; a corner
                       // that has folded through is negative
};

/// Smallest of all hexahedra in the shape x [m], of the mesh that had the shape mesh.x; the same for
/// any number of threads.
WorstCorner worst_corner(const Mesh& mesh, const NodeRows& x, int threads);

}  // namespace undertow::fem
