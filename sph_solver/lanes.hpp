#pragma once
// The types of simd.hpp: eight numbers, one of each particle of a cluster.

#include <cstdint>

namespace undertow::sph {

inline constexpr int lanes = 8;
typedef float float8 __attribute__((vector_size(32)));
typedef double double8 __attribute__((vector_size(64)));
typedef std::int32_t int8 __attribute__((vector_size(32)));

/// Eight of a number, and eight positions: fixed-point for float, see FixedPoint.
template <class Real>
struct EightOf;
template <>
struct EightOf<float> {
    using Number = float8;
    using Place = int8;
};
template <>
struct EightOf<double> {
    using Number = double8;
    using Place = double8;
};
template <class Real>
using Eight = typename EightOf<Real>::Number;

}  // namespace undertow::sph
