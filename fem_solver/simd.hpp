#pragma once
// The number type of the element kernels: eight doubles side by side, one element per lane.
// Written on the compiler's vector extension: with AVX-512 a Lanes is one register, without it the
// compiler splits it into two (AVX2) or four (SSE2); the source is the same. The kernels are
// templates over the number type, so that `double` gives the readable scalar reference.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace undertow::fem {

inline constexpr int n_lanes = 8;

using Lanes = double __attribute__((vector_size(64)));
/// A node's three components and one of padding: the unit of gather and scatter.
using Row = double __attribute__((vector_size(32)));
using RowMask = std::int64_t __attribute__((vector_size(32)));

#define UNDERTOW_KERNEL inline __attribute__((always_inline))

/// Rows in memory: 32-byte aligned, so that one load brings one node.
struct alignas(32) NodeRow {
    double c[4] = {0, 0, 0, 0};  // x, y, z, padding (0)
};
using NodeRows = std::vector<NodeRow>;  // [n_nodes]

UNDERTOW_KERNEL Row& as_row(NodeRow& r) {
    return *reinterpret_cast<Row*>(&r);
}
UNDERTOW_KERNEL const Row& as_row(const NodeRow& r) {
    return *reinterpret_cast<const Row*>(&r);
}

template <class T>
UNDERTOW_KERNEL T larger(const T& a, const T& b) {
    return a > b ? a : b;
}
template <class T>
UNDERTOW_KERNEL T smaller(const T& a, const T& b) {
    return a < b ? a : b;
}
template <class T>
UNDERTOW_KERNEL T magnitude(const T& a) {
    return a < 0.0 ? -a : a;
}

UNDERTOW_KERNEL double square_root(double a) {
    return std::sqrt(a);
}
UNDERTOW_KERNEL Lanes square_root(const Lanes& a) {
    Lanes out;
#pragma GCC unroll 8
    for (int l = 0; l < n_lanes; ++l) out[l] = std::sqrt(a[l]);
    return out;
}

/// Whether a comparison holds in any lane.
using LaneMask = std::int64_t __attribute__((vector_size(64)));
UNDERTOW_KERNEL bool any(bool a) {
    return a;
}
UNDERTOW_KERNEL bool any(const LaneMask& a) {
    std::int64_t m = 0;
#pragma GCC unroll 8
    for (int l = 0; l < n_lanes; ++l) m |= a[l];
    return m != 0;
}

/// Sum over the lanes, in one fixed order (the result must not depend on the machine's width).
UNDERTOW_KERNEL double sum_lanes(const Lanes& a) {
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}
inline double largest_lane(const Lanes& a) {
    double m = a[0];
    for (int l = 1; l < n_lanes; ++l) m = larger(m, double(a[l]));
    return m;
}
inline double smallest_lane(const Lanes& a) {
    double m = a[0];
    for (int l = 1; l < n_lanes; ++l) m = smaller(m, double(a[l]));
    return m;
}

UNDERTOW_KERNEL Lanes join(const Row& low, const Row& high) {
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// x, y, z of eight nodes, one node per lane: eight loads and a 4x4 transpose in each half.
UNDERTOW_KERNEL void gather(const NodeRow* rows, const std::int32_t* node, Lanes& x, Lanes& y,
                            Lanes& z) {
    const Lanes r0 = join(as_row(rows[node[0]]), as_row(rows[node[4]]));
    const Lanes r1 = join(as_row(rows[node[1]]), as_row(rows[node[5]]));
    const Lanes r2 = join(as_row(rows[node[2]]), as_row(rows[node[6]]));
    const Lanes r3 = join(as_row(rows[node[3]]), as_row(rows[node[7]]));
    const Lanes xz01 = __builtin_shufflevector(r0, r1, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes y01 = __builtin_shufflevector(r0, r1, 1, 9, 3, 11, 5, 13, 7, 15);
    const Lanes xz23 = __builtin_shufflevector(r2, r3, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes y23 = __builtin_shufflevector(r2, r3, 1, 9, 3, 11, 5, 13, 7, 15);
    x = __builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13);
    y = __builtin_shufflevector(y01, y23, 0, 1, 8, 9, 4, 5, 12, 13);
    z = __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// rows[node] -= (x, y, z) for the first `n` lanes, one lane after the other: two lanes may name
/// the same node.
UNDERTOW_KERNEL void scatter_subtract(NodeRow* rows, const std::int32_t* node, int n,
                                      const Lanes& x, const Lanes& y, const Lanes& z) {
    const Lanes zero = {};
    const Lanes xy_even = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes xy_odd = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
    const Lanes z_even = __builtin_shufflevector(z, zero, 0, 8, 2, 10, 4, 12, 6, 14);
    const Lanes z_odd = __builtin_shufflevector(z, zero, 1, 9, 3, 11, 5, 13, 7, 15);
    const Row r[n_lanes] = {
        __builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9),
        __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9),
        __builtin_shufflevector(xy_even, z_even, 2, 3, 10, 11),
        __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11),
        __builtin_shufflevector(xy_even, z_even, 4, 5, 12, 13),
        __builtin_shufflevector(xy_odd, z_odd, 4, 5, 12, 13),
        __builtin_shufflevector(xy_even, z_even, 6, 7, 14, 15),
        __builtin_shufflevector(xy_odd, z_odd, 6, 7, 14, 15),
    };
    if (n == n_lanes) {
#pragma GCC unroll 8
        for (int l = 0; l < n_lanes; ++l) as_row(rows[node[l]]) -= r[l];
    } else {
        for (int l = 0; l < n; ++l) as_row(rows[node[l]]) -= r[l];
    }
}

}  // namespace undertow::fem
