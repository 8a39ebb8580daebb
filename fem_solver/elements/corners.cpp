#include "fem_solver/elements/corners.hpp"

#include <algorithm>
#include <vector>

namespace undertow::fem {
namespace {

/// Edges' triple product at a corner [m3]; `at(n)` gives a node's coordinates.
template <class Positions>
double corner_jacobian(const Hexahedron& h, int corner, const Positions& at) {
    double edge[3][3];
    for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d)
            edge[k][d] = at(h[corner_edges[corner][k]])[d] - at(h[corner])[d];
    const auto &a = edge[0], &b = edge[1], &c = edge[2];
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

constexpr std::size_t block_size = 8192;  // elements; the blocks' worst are compared in order

WorstCorner worst_of_block(const Mesh& mesh, const NodeRows& x, std::size_t first,
                           std::size_t last) {
    const auto start = [&](std::int32_t n) { return mesh.x[n].data(); };
    const auto now = [&](std::int32_t n) { return x[n].c; };
    WorstCorner worst;
    for (std::size_t e = first; e < last; ++e) {
        const Hexahedron& h = mesh.hexahedra[e];
        double mean = 0, smallest = 0;
        int at = -1;
        for (int corner = 0; corner < 8; ++corner) {
            mean += corner_jacobian(h, corner, start) / 8;
            const double jacobian = corner_jacobian(h, corner, now);
            if (at >= 0 && !(jacobian < smallest)) continue;
            smallest = jacobian;
            at = corner;
        }
        if (smallest < worst.share * mean) worst = {e, h[at], smallest / mean};
    }
    return worst;
}

}  // namespace

WorstCorner worst_corner(const Mesh& mesh, const NodeRows& x, int threads) {
    const std::size_t n = mesh.hexahedra.size(), blocks = (n + block_size - 1) / block_size;
    std::vector<WorstCorner> worst(blocks);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1 && blocks > 1)
    for (std::size_t b = 0; b < blocks; ++b)
        worst[b] = worst_of_block(mesh, x, b * block_size, std::min(n, (b + 1) * block_size));
    WorstCorner all;
    for (const WorstCorner& w : worst)
        if (w.share < all.share) all = w;
    return all;
}

}  // namespace undertow::fem
