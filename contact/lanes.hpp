#pragma once
// Eight numbers side by side, one to a lane of a vector register, and what a kernel says with them:
// the same words as for one number, so that one source serves both. Without AVX-512 the compiler
// splits them up; results are the same bits.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#if defined(__AVX512DQ__) && defined(__AVX512VL__)
#define UNDERTOW_AVX512
#include <immintrin.h>
#endif

namespace undertow::contact {

constexpr int lane_count = 8;
using Lanes = double __attribute__((vector_size(64)));
using LaneWholes = std::int64_t __attribute__((vector_size(64)));
using LaneRows = std::int32_t __attribute__((vector_size(32)));
// The four pieces of one quad side by side.
using Lanes4 = double __attribute__((vector_size(32)));
using LaneMask4 = std::int64_t __attribute__((vector_size(32)));

/// The same value in all lanes (of one number: itself).
template <typename T>
T spread(double value);
template <>
inline double spread<double>(double value) {
    return value;
}
template <>
inline Lanes spread<Lanes>(double value) {
    return Lanes{value, value, value, value, value, value, value, value};
}

template <>
inline Lanes4 spread<Lanes4>(double value) {
    return Lanes4{value, value, value, value};
}

inline double select(bool here, double a, double b) {
    return here ? a : b;
}
inline double square_root(double a) {
    return std::sqrt(a);
}
inline bool any(bool here) {
    return here;
}

// The masked forms of the intrinsics: g++ 12 warns of what the others leave undefined.
#ifdef UNDERTOW_AVX512

/// Which lanes a statement holds for.
struct LaneMask {
    __mmask8 bits;
    bool operator[](int lane) const { return bits >> lane & 1; }
};
inline LaneMask operator&(LaneMask a, LaneMask b) {
    return {_kand_mask8(a.bits, b.bits)};
}
inline LaneMask operator|(LaneMask a, LaneMask b) {
    return {_kor_mask8(a.bits, b.bits)};
}
inline bool any(LaneMask here) {
    return here.bits != 0;
}
inline bool all(LaneMask here) {
    return here.bits == 0xff;
}
/// Where `here` holds and `there` does not.
inline LaneMask without(LaneMask here, LaneMask there) {
    return {_kandn_mask8(there.bits, here.bits)};
}
inline LaneMask equal(const LaneRows& a, const LaneRows& b) {
    return {_mm256_cmpeq_epi32_mask(__m256i(a), __m256i(b))};
}
inline LaneMask less(const Lanes& a, const Lanes& b) {
    return {_mm512_cmp_pd_mask(__m512d(a), __m512d(b), _CMP_LT_OQ)};
}
inline LaneMask at_most(const Lanes& a, const Lanes& b) {
    return {_mm512_cmp_pd_mask(__m512d(a), __m512d(b), _CMP_LE_OQ)};
}
inline Lanes select(LaneMask here, const Lanes& a, const Lanes& b) {
    return Lanes(_mm512_mask_blend_pd(here.bits, __m512d(b), __m512d(a)));
}
inline Lanes square_root(const Lanes& a) {
    return Lanes(_mm512_maskz_sqrt_pd(0xff, __m512d(a)));
}
inline LaneMask first_lanes(int count) {
    return {__mmask8((1u << count) - 1)};
}
inline Lanes gather(const double* base, const LaneRows& row) {
    return Lanes(_mm512_mask_i32gather_pd(_mm512_setzero_pd(), 0xff, __m256i(row), base, 8));
}
inline Lanes gather_wholes(const std::int64_t* base, const LaneRows& row) {
    return Lanes(_mm512_maskz_cvtepi64_pd(
        0xff, _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), 0xff, __m256i(row), base, 8)));
}
inline LaneRows gather_rows(const std::int32_t* base, const LaneRows& row) {
    return LaneRows(_mm256_i32gather_epi32(base, __m256i(row), 4));
}
/// Eight consecutive rows of an array (n, 3): three loads.
inline void load_three(const double* from, Lanes& x, Lanes& y, Lanes& z) {
    const __m512d a = _mm512_loadu_pd(from), b = _mm512_loadu_pd(from + 8),
                  c = _mm512_loadu_pd(from + 16);
    const auto pick = [&](const __m512i& of_two, const __m512i& of_all) {
        return Lanes(_mm512_permutex2var_pd(_mm512_permutex2var_pd(a, of_two, b), of_all, c));
    };
    x = pick(_mm512_setr_epi64(0, 3, 6, 9, 12, 15, 0, 0),
             _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 10, 13));
    y = pick(_mm512_setr_epi64(1, 4, 7, 10, 13, 0, 0, 0),
             _mm512_setr_epi64(0, 1, 2, 3, 4, 8, 11, 14));
    z = pick(_mm512_setr_epi64(2, 5, 8, 11, 14, 0, 0, 0),
             _mm512_setr_epi64(0, 1, 2, 3, 4, 9, 12, 15));
}
/// Keeps of n rows those whose number is not above `limit`, and where they were from `first` on.
/// Returns how many. There must be room for 15 more.
inline std::size_t keep_up_to(float limit, const float* number, const std::uint32_t* row,
                              std::uint32_t first, std::size_t n, std::int32_t* kept,
                              std::uint32_t* place) {
    const __m512i ones = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    std::size_t count = 0;
    for (std::size_t e = 0; e < n; e += 16) {
        const __mmask16 here = n - e < 16 ? __mmask16((1u << (n - e)) - 1) : __mmask16(0xffff);
        const __mmask16 keep =
            _mm512_mask_cmp_ps_mask(here, _mm512_maskz_loadu_ps(here, number + e),
                                    _mm512_set1_ps(limit), _CMP_NGT_UQ);
        _mm512_storeu_si512(
            kept + count,
            _mm512_maskz_compress_epi32(keep, _mm512_maskz_loadu_epi32(here, row + e)));
        _mm512_storeu_si512(
            place + count,
            _mm512_maskz_compress_epi32(
                keep, _mm512_add_epi32(ones, _mm512_set1_epi32(int(first + std::uint32_t(e))))));
        count += std::size_t(__builtin_popcount(keep));
    }
    return count;
}
/// To the nearest whole number, ties to the even one.
inline LaneWholes rounded(const Lanes& a) {
    return LaneWholes(_mm512_maskz_cvtpd_epi64(0xff, __m512d(a)));
}
inline Lanes as_numbers(const LaneWholes& a) {
    return Lanes(_mm512_maskz_cvtepi64_pd(0xff, __m512i(a)));
}
inline LaneWholes select(LaneMask here, const LaneWholes& a, const LaneWholes& b) {
    return LaneWholes(_mm512_mask_blend_epi64(here.bits, __m512i(b), __m512i(a)));
}

#else

struct LaneMask {
    std::int64_t __attribute__((vector_size(64))) bits;
    bool operator[](int lane) const { return bits[lane] != 0; }
};
inline LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    return {a.bits & b.bits};
}
inline LaneMask operator|(const LaneMask& a, const LaneMask& b) {
    return {a.bits | b.bits};
}
inline bool any(const LaneMask& here) {
    std::int64_t found = 0;
    for (int lane = 0; lane < lane_count; ++lane) found |= here.bits[lane];
    return found != 0;
}
inline bool all(const LaneMask& here) {
    std::int64_t everywhere = -1;
    for (int lane = 0; lane < lane_count; ++lane) everywhere &= here.bits[lane];
    return everywhere != 0;
}
/// Where `here` holds and `there` does not.
inline LaneMask without(const LaneMask& here, const LaneMask& there) {
    return {here.bits & ~there.bits};
}
inline LaneMask equal(const LaneRows& a, const LaneRows& b) {
    LaneMask same;
    for (int lane = 0; lane < lane_count; ++lane) same.bits[lane] = a[lane] == b[lane] ? -1 : 0;
    return same;
}
inline LaneMask less(const Lanes& a, const Lanes& b) {
    return {a < b};
}
inline LaneMask at_most(const Lanes& a, const Lanes& b) {
    return {a <= b};
}
inline Lanes select(const LaneMask& here, const Lanes& a, const Lanes& b) {
    return here.bits ? a : b;
}
inline Lanes square_root(const Lanes& a) {
    Lanes root;
    for (int lane = 0; lane < lane_count; ++lane) root[lane] = std::sqrt(a[lane]);
    return root;
}
inline LaneMask first_lanes(int count) {
    LaneMask first{};
    for (int lane = 0; lane < count; ++lane) first.bits[lane] = -1;
    return first;
}
inline Lanes gather(const double* base, const LaneRows& row) {
    Lanes found;
    for (int lane = 0; lane < lane_count; ++lane) found[lane] = base[row[lane]];
    return found;
}
inline Lanes gather_wholes(const std::int64_t* base, const LaneRows& row) {
    Lanes found;
    for (int lane = 0; lane < lane_count; ++lane) found[lane] = double(base[row[lane]]);
    return found;
}
inline LaneRows gather_rows(const std::int32_t* base, const LaneRows& row) {
    LaneRows found;
    for (int lane = 0; lane < lane_count; ++lane) found[lane] = base[row[lane]];
    return found;
}
/// Eight consecutive rows of an array (n, 3).
inline void load_three(const double* from, Lanes& x, Lanes& y, Lanes& z) {
    for (int lane = 0; lane < lane_count; ++lane)
        x[lane] = from[3 * lane], y[lane] = from[3 * lane + 1], z[lane] = from[3 * lane + 2];
}
/// Keeps of n rows those whose number is not above `limit`, and where they were from `first` on.
/// Returns how many. There must be room for 15 more.
inline std::size_t keep_up_to(float limit, const float* number, const std::uint32_t* row,
                              std::uint32_t first, std::size_t n, std::int32_t* kept,
                              std::uint32_t* place) {
    std::size_t count = 0;
    for (std::size_t e = 0; e < n; ++e) {
        kept[count] = std::int32_t(row[e]);
        place[count] = first + std::uint32_t(e);
        count += !(number[e] > limit);
    }
    return count;
}
/// To the nearest whole number, ties to the even one.
inline LaneWholes rounded(const Lanes& a) {
    LaneWholes whole;
    for (int lane = 0; lane < lane_count; ++lane) whole[lane] = std::llrint(a[lane]);
    return whole;
}
inline Lanes as_numbers(const LaneWholes& a) {
    return __builtin_convertvector(a, Lanes);
}
inline LaneWholes select(const LaneMask& here, const LaneWholes& a, const LaneWholes& b) {
    return here.bits ? a : b;
}

#endif

inline bool less(double a, double b) {
    return a < b;
}
inline bool at_most(double a, double b) {
    return a <= b;
}
inline LaneMask4 at_most(const Lanes4& a, const Lanes4& b) {
    return a <= b;
}
inline Lanes4 select(const LaneMask4& here, const Lanes4& a, const Lanes4& b) {
    return here ? a : b;
}
/// As std::min and std::max: the first if they are equal or not to be compared.
template <typename T>
T smaller(const T& a, const T& b) {
    return select(less(b, a), b, a);
}
template <typename T>
T larger(const T& a, const T& b) {
    return select(less(a, b), b, a);
}

inline Lanes load(const double* from) {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}
inline void store(const Lanes& lanes, double* to) {
    std::memcpy(to, &lanes, sizeof lanes);
}
inline LaneRows load_rows(const std::int32_t* from) {
    LaneRows rows;
    std::memcpy(&rows, from, sizeof rows);
    return rows;
}

/// A vector of three, of numbers or of lanes.
template <typename T>
struct Three {
    T x, y, z;
};
template <typename T>
Three<T> operator+(const Three<T>& a, const Three<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
Three<T> operator-(const Three<T>& a, const Three<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename T>
Three<T> operator*(const T& s, const Three<T>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <typename T>
T dot(const Three<T>& a, const Three<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
Three<T> cross(const Three<T>& a, const Three<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Length; its last product is added to the sum of the others.
template <typename T>
T norm(const Three<T>& a) {
    return square_root(dot(a, a));
}
template <typename T, typename Mask>
Three<T> select(const Mask& here, const Three<T>& a, const Three<T>& b) {
    return {select(here, a.x, b.x), select(here, a.y, b.y), select(here, a.z, b.z)};
}

#ifdef UNDERTOW_AVX512

namespace lane_detail {
/// Four registers of two rows {x, y, z, -} each, as three registers of coordinates.
inline Three<Lanes> turned(__m512d r01, __m512d r23, __m512d r45, __m512d r67) {
    const __m512i xy = _mm512_setr_epi64(0, 4, 8, 12, 1, 5, 9, 13);
    const __m512i z = _mm512_setr_epi64(2, 6, 10, 14, 2, 6, 10, 14);
    const __m512d xy03 = _mm512_permutex2var_pd(r01, xy, r23),
                  xy47 = _mm512_permutex2var_pd(r45, xy, r67),
                  z03 = _mm512_permutex2var_pd(r01, z, r23),
                  z47 = _mm512_permutex2var_pd(r45, z, r67);
    return {Lanes(_mm512_maskz_shuffle_f64x2(0xff, xy03, xy47, 0x44)),
            Lanes(_mm512_maskz_shuffle_f64x2(0xff, xy03, xy47, 0xee)),
            Lanes(_mm512_maskz_shuffle_f64x2(0xff, z03, z47, 0x44))};
}
inline __m512d two_rows(const double* base, std::int32_t a, std::int32_t b) {
    return _mm512_maskz_insertf64x4(
        0xff, _mm512_castpd256_pd512(_mm256_maskz_loadu_pd(7, base + 3 * std::size_t(a))),
        _mm256_maskz_loadu_pd(7, base + 3 * std::size_t(b)), 1);
}
}  // namespace lane_detail

/// Rows of an array (n, 3). Eight loads and seven shuffles: a third of what three gathers cost.
inline Three<Lanes> gather_three(const double* base, const LaneRows& row) {
    using lane_detail::two_rows;
    return lane_detail::turned(two_rows(base, row[0], row[1]), two_rows(base, row[2], row[3]),
                               two_rows(base, row[4], row[5]), two_rows(base, row[6], row[7]));
}

#else

inline Three<Lanes> gather_three(const double* base, const LaneRows& row) {
    Three<Lanes> found;
    for (int lane = 0; lane < lane_count; ++lane) {
        const double* at = base + 3 * std::size_t(row[lane]);
        found.x[lane] = at[0], found.y[lane] = at[1], found.z[lane] = at[2];
    }
    return found;
}

#endif

/// Rows first to first + 7 of an array (n, 3).
inline Three<Lanes> load_three(const double* base, std::size_t first) {
    Three<Lanes> found;
    load_three(base + 3 * first, found.x, found.y, found.z);
    return found;
}

}  // namespace undertow::contact
