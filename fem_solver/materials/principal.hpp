#pragma once
// Principal values of a symmetric tensor, and a coaxial tensor with other ones, without
// eigenvectors, branches or trigonometry.
//
// The deviator's sign is turned so that J3 <= 0: then one principal value, -x, stands alone, and
// the other two, x/2 + delta and x/2 - delta, are the near pair. x comes from the cubic, where it
// is well conditioned; the projector E on its direction and the pair's part N of the deviator D
// follow as polynomials of D, and delta as the norm of N, so that it keeps its digits where the two
// meet (sqrt(J2 - 3/4 x^2) would lose half of them):
//   E = (D^2 - x D + (x^2 - J2) I)/(3 x^2 - J2),   N = D + 3/2 x E - x/2 I,   delta^2 = N:N/2

#include "fem_solver/materials/linear_elastic.hpp"

namespace undertow::fem {

/// Isolated root y of y^3 - y - r = 0 for 0 <= r <= 2/(3 sqrt 3), 1 <= y <= 2/sqrt 3: the
/// principal value that stands alone, over sqrt(J2). Newton's iteration starts within 8e-4
/// and leaves 8e-7, 8e-13, 7e-16.
template <class T>
UNDERTOW_KERNEL T isolated_root(const T& r) {
    T y = 1.0 + r * (0.5 - r * (0.375 - 0.31 * r));
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
        const T y2 = y * y;
        y -= (y * (y2 - 1.0) - r) / (3.0 * y2 - 1.0);
    }
    return y;
}
inline constexpr double largest_isolated_r = 0.38490017945975050;  // 2/(3 sqrt 3)

/// mean I + deviator, J2 of the deviator: in principal values and what rebuilds the tensor.
template <class T>
struct Principal {
    T value[3];          // decreasing
    T sign;              // 1: the third stands alone, -1: the first
    T delta;             // half the gap of the near pair, >= 0
    Symmetric<T> alone;  // E, projector on the direction of the one that stands alone
    Symmetric<T> pair;   // N, delta times (projector of the farther minus that of the middle one)

    /// D: deviator of the tensor.
    UNDERTOW_KERNEL Principal(const T& mean, const Symmetric<T>& deviator, const T& its_J2) {
        const Symmetric<T>& d = deviator;
        const T J3 = d.xx * (d.yy * d.zz - d.yz * d.yz) - d.xy * (d.xy * d.zz - d.yz * d.zx) +
                     d.zx * (d.xy * d.yz - d.yy * d.zx);
        const T one = 1.0 + 0.0 * mean;
        sign = J3 > 0.0 ? -one : one;
        const Symmetric<T> D{sign * d.xx, sign * d.yy, sign * d.zz,
                             sign * d.xy, sign * d.yz, sign * d.zx};
        const T J2 = larger(its_J2, T(1e-200 * one));  // [Pa2] an isotropic tensor: all are alike
        const T root = square_root(J2);
        const T x = root * isolated_root(smaller(T(magnitude(J3) / (J2 * root)),
                                                 T(largest_isolated_r * one)));
        const T x2 = x * x, c = x2 - J2, scale = 1.0 / (3.0 * x2 - J2);
        alone.xx = scale * (D.xx * D.xx + D.xy * D.xy + D.zx * D.zx - x * D.xx + c);
        alone.yy = scale * (D.xy * D.xy + D.yy * D.yy + D.yz * D.yz - x * D.yy + c);
        alone.zz = scale * (D.zx * D.zx + D.yz * D.yz + D.zz * D.zz - x * D.zz + c);
        alone.xy = scale * (D.xx * D.xy + D.xy * D.yy + D.zx * D.yz - x * D.xy);
        alone.yz = scale * (D.xy * D.zx + D.yy * D.yz + D.yz * D.zz - x * D.yz);
        alone.zx = scale * (D.xx * D.zx + D.xy * D.yz + D.zx * D.zz - x * D.zx);
        const T half_x = 0.5 * x;
        pair.xx = D.xx + 3.0 * half_x * alone.xx - half_x;
        pair.yy = D.yy + 3.0 * half_x * alone.yy - half_x;
        pair.zz = D.zz + 3.0 * half_x * alone.zz - half_x;
        pair.xy = D.xy + 3.0 * half_x * alone.xy;
        pair.yz = D.yz + 3.0 * half_x * alone.yz;
        pair.zx = D.zx + 3.0 * half_x * alone.zx;
        delta = square_root(T(0.5 * (pair.xx * pair.xx + pair.yy * pair.yy + pair.zz * pair.zz) +
                              (pair.xy * pair.xy + pair.yz * pair.yz + pair.zx * pair.zx)));
        // round-off must not change the order
        delta = smaller(delta, T(1.5 * x));
        const auto third_alone = J3 <= 0.0;
        value[0] = mean + (third_alone ? T(half_x + delta) : x);
        value[1] = mean + (third_alone ? T(half_x - delta) : T(delta - half_x));
        value[2] = mean - (third_alone ? x : T(half_x + delta));
    }

    /// The coaxial tensor with the principal values r, decreasing; no pair may lie farther apart
    /// than before.
    UNDERTOW_KERNEL Symmetric<T> with_values(const T& r1, const T& r2, const T& r3) const {
        const T one = 1.0 + 0.0 * r1;
        const auto third_alone = sign > 0.0;
        const T isolated = third_alone ? r3 : r1, outer = third_alone ? r1 : r3;
        const T middle = 0.5 * (outer + r2), gap = 0.5 * magnitude(T(outer - r2));
        const T e = isolated - middle;
        // of no effect where the pair meets
        const T share = sign * smaller(T(gap / larger(delta, T(1e-300 * one))), one);
        return {middle + e * alone.xx + share * pair.xx, middle + e * alone.yy + share * pair.yy,
                middle + e * alone.zz + share * pair.zz, e * alone.xy + share * pair.xy,
                e * alone.yz + share * pair.yz,          e * alone.zx + share * pair.zx};
    }
};

}  // namespace undertow::fem
