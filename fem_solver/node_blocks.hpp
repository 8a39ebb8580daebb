#pragma once
// Work on nodes by any number of threads: in fixed blocks, whose sums are added in order, so that
// the number of threads does not change a bit. A thread has the same blocks in every step: they
// stay in its core's caches. One block runs without any threading cost.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace undertow::fem {

// 0.2 MB of nodes: enough blocks for two threads from 8,192 elements on
inline constexpr std::size_t nodes_per_block = 1024;

/// of_block(b, first, last) for each block of n nodes.
template <class OfBlock>
void for_node_blocks(std::size_t n, int threads, OfBlock&& of_block) {
    const std::size_t blocks = (n + nodes_per_block - 1) / nodes_per_block;
    const auto run = [&](std::size_t b) {
        of_block(b, b * nodes_per_block, std::min(n, (b + 1) * nodes_per_block));
    };
    if (blocks <= 1 || threads <= 1) {
        for (std::size_t b = 0; b < blocks; ++b) run(b);
        return;
    }
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t b = 0; b < blocks; ++b) run(b);
}

/// Sum of of_block(first, last) over the blocks of n nodes, in their order.
template <class Sum, class OfBlock>
Sum sum_over_node_blocks(std::size_t n, int threads, OfBlock&& of_block) {
    const std::size_t blocks = (n + nodes_per_block - 1) / nodes_per_block;
    if (blocks <= 1 || threads <= 1) {   // allocates nothing
        Sum sum;
        for_node_blocks(n, 1, [&](std::size_t, std::size_t first, std::size_t last) {
            Sum part = of_block(first, last);
            asm volatile("" : "+m"(part));   // rounded before it is added, as threads' parts are
            sum += part;
        });
        return sum;
    }
    std::vector<Sum> part(blocks);
    for_node_blocks(n, threads, [&](std::size_t b, std::size_t first, std::size_t last) {
        part[b] = of_block(first, last);
    });
    Sum sum;
    for (const Sum& p : part) sum += p;
    return sum;
}

}  // namespace undertow::fem
