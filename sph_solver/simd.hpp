#pragma once
// Eight floats or doubles as one value: the lanes are the eight particles of a cluster. The same
// pair physics is instantiated with float8 (fast), double8 (sph.precision = "double"), and with
// double (reference).

// For loops only: headers that many include take the types alone from lanes.hpp, for immintrin.h costs
// each file a third of a second to compile.

#include <cmath>
#include <cstdint>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "sph_solver/lanes.hpp"

namespace undertow::sph {

inline float square_root(float a) { return std::sqrt(a); }
inline double square_root(double a) { return std::sqrt(a); }
inline float positive_part(float a) { return a > 0 ? a : 0; }
inline double positive_part(double a) { return a > 0 ? a : 0; }
inline float negative_part(float a) { return a < 0 ? a : 0; }
inline double negative_part(double a) { return a < 0 ? a : 0; }
inline float reciprocal(float a) { return 1 / a; }
inline double reciprocal(double a) { return 1 / a; }

#if defined(__AVX__)
inline float8 square_root(float8 a) { return (float8)_mm256_sqrt_ps((__m256)a); }
inline float8 positive_part(float8 a) {
    return (float8)_mm256_max_ps((__m256)a, _mm256_setzero_ps());
}
inline float8 negative_part(float8 a) {
    return (float8)_mm256_min_ps((__m256)a, _mm256_setzero_ps());
}
#else
inline float8 square_root(float8 a) {
    for (int k = 0; k < lanes; ++k) a[k] = std::sqrt(a[k]);
    return a;
}
inline float8 positive_part(float8 a) { return a > 0 ? a : float8{}; }
inline float8 negative_part(float8 a) { return a < 0 ? a : float8{}; }
#endif

#if defined(__AVX512F__)
// with a mask of all lanes: what g++ 12 has in the plain forms draws warnings
inline double8 square_root(double8 a) {
    return (double8)_mm512_maskz_sqrt_pd(0xff, (__m512d)a);
}
inline double8 positive_part(double8 a) {
    return (double8)_mm512_maskz_max_pd(0xff, (__m512d)a, _mm512_setzero_pd());
}
inline double8 negative_part(double8 a) {
    return (double8)_mm512_maskz_min_pd(0xff, (__m512d)a, _mm512_setzero_pd());
}
#else
inline double8 square_root(double8 a) {
    for (int k = 0; k < lanes; ++k) a[k] = std::sqrt(a[k]);
    return a;
}
inline double8 positive_part(double8 a) {
    return a > 0 ? a : double8{};
}
inline double8 negative_part(double8 a) {
    return a < 0 ? a : double8{};
}
#endif

/// Positions of eight with those of them that do not see (bit k) moved by `far`, towards zero so that
/// fixed-point differences do not overflow. Who was within far/2 of a record is beyond it then.
template <class Place, class Scalar>
inline Place hide(Place x, std::uint32_t hidden, Scalar far) {
    if (hidden)
        for (int k = 0; k < lanes; ++k)
            if (hidden >> k & 1) x[k] += x[k] > 0 ? -far : far;
    return x;
}

/// NaN is not zero.
inline bool any_nonzero(float8 a) {
#if defined(__AVX512VL__)
    return _mm256_cmp_ps_mask((__m256)a, _mm256_setzero_ps(), _CMP_NEQ_UQ) != 0;
#elif defined(__AVX__)
    return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, _mm256_setzero_ps(), _CMP_NEQ_UQ)) != 0;
#else
    bool any = false;
    for (int k = 0; k < lanes; ++k) any |= a[k] != 0;
    return any;
#endif
}
inline bool any_nonzero(double8 a) {
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask((__m512d)a, _mm512_setzero_pd(), _CMP_NEQ_UQ) != 0;
#else
    bool any = false;
    for (int k = 0; k < lanes; ++k) any |= a[k] != 0;
    return any;
#endif
}

/// 1/a to 14 bits where the processor has it: used in the artificial viscosity and in mean viscosities,
/// where a relative error of 6e-5 is far below the term's own meaning.
#if defined(__AVX512VL__)
inline float8 reciprocal(float8 a) { return (float8)_mm256_rcp14_ps((__m256)a); }
#else
inline float8 reciprocal(float8 a) { return 1.0f / a; }
#endif
inline double8 reciprocal(double8 a) {
    return 1.0 / a;
}

/// 1/a to round-off, without the divider: the reciprocal and one step of Newton's method.
#if defined(__AVX512VL__)
inline float8 precise_reciprocal(float8 a) {
    const float8 r = reciprocal(a);
    return r * (2.0f - a * r);
}
#else
inline float8 precise_reciprocal(float8 a) { return 1.0f / a; }
#endif
inline double8 precise_reciprocal(double8 a) {
    return 1.0 / a;
}
inline float precise_reciprocal(float a) { return 1 / a; }
inline double precise_reciprocal(double a) { return 1 / a; }

inline float sum_of_lanes(float8 a) {
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

/// Differences of fixed-point positions are exact in int32; only then they become floating point.
inline float8 to_real(int8 a) { return __builtin_convertvector(a, float8); }
inline double8 to_real(double8 a) {
    return a;
}
inline float to_real(std::int32_t a, float) { return static_cast<float>(a); }
inline double to_real(std::int32_t a, double) { return static_cast<double>(a); }
inline double to_real(double a, double) {
    return a;
}

}  // namespace undertow::sph
