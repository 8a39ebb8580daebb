#pragma once
// Asking memory for what the batches ahead need, while the present one is computed.
//
// A large mesh comes from memory in every step. What the processor fetches by itself ends at each
// page of 4 kB, which is three batches, and knows nothing of the nodes. Requests are spread over
// the gathers of a batch: all at once they fill the buffers that its own loads wait for, and cost
// more than they gain (measured, docs/performance.md).

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fem_solver/elements/batches.hpp"

namespace undertow::fem {

/// Batches between the present one and the one that is asked for: its records, its nodes (for these
/// its corners must have come).
inline constexpr std::size_t records_ahead = 4, nodes_ahead = 2;

/// The records of a batch in several arrays.
template <class... Records>
class RecordsAhead {
 public:
    explicit RecordsAhead(std::size_t batch, const std::vector<Records>&... of_batches)
        : first_{reinterpret_cast<const char*>(
              &of_batches[std::min(batch + records_ahead, of_batches.size() - 1)])...} {}

    /// Asks for the k-th of so many shares of the cache lines; k constant after unrolling.
    UNDERTOW_KERNEL void ask(int k, int shares) const {
        const int share = (lines.back() + shares - 1) / shares;
#pragma GCC unroll 8
        for (int i = 0; i < share; ++i) {
            const int line = k * share + i;
#pragma GCC unroll 8
            for (std::size_t r = 0; r < sizeof...(Records); ++r)
                if (line >= lines[r] && line < lines[r + 1])
                    __builtin_prefetch(first_[r] + 64 * (line - lines[r]));
        }
        asm volatile("" ::: "memory");  // or the compiler puts all requests in one place again
    }

 private:
    /// First line of each record, and the end.
    static constexpr std::array<int, sizeof...(Records) + 1> lines = [] {
        std::array<int, sizeof...(Records) + 1> begin{};
        int r = 0;
        ((begin[r + 1] = begin[r] + int((sizeof(Records) + 63) / 64), ++r), ...);
        return begin;
    }();

    const char* first_[sizeof...(Records)];
};

/// Asks for rows of the nodes that come into the chunk with the batch `nodes_ahead` from here.
template <class Batches>
UNDERTOW_KERNEL void ask_for_nodes(const Batches& batches, std::size_t batch, const Nodes& nodes) {
    for (std::int32_t n : batches.new_nodes(batch + nodes_ahead)) {
        __builtin_prefetch(&nodes.x[n]);
        __builtin_prefetch(&nodes.v[n]);
        __builtin_prefetch(&nodes.f[n], 1);
    }
}

}  // namespace undertow::fem
