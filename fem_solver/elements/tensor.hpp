#pragma once
// 3x3 algebra of the element kernels, written out: plain arrays of the number type, no loops that a
// compiler might leave rolled.

#include "fem_solver/materials/linear_elastic.hpp"
#include "fem_solver/simd.hpp"

namespace undertow::fem {

template <class T>
UNDERTOW_KERNEL T dot(const T (&a)[3], const T (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
UNDERTOW_KERNEL void cross(const T (&a)[3], const T (&b)[3], T (&c)[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/// Displacement gradient of the step with respect to its midpoint, from the one with respect to its
/// end: L = G (I - G/2)^-1. A rigid turn gives exactly a skew L.  [Hughes and Winget 1980]
template <class T>
UNDERTOW_KERNEL void to_midpoint(const T (&G)[3][3], T (&L)[3][3]) {
    T A[3][3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) A[i][j] = (i == j ? 1.0 : 0.0) - 0.5 * G[i][j];
    T adjugate[3][3];  // A^-1 det A
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            adjugate[j][i] = A[i1][j1] * A[i2][j2] - A[i1][j2] * A[i2][j1];
        }
    }
    const T inverse_det =
        1.0 / (A[0][0] * adjugate[0][0] + A[0][1] * adjugate[1][0] + A[0][2] * adjugate[2][0]);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j)
            L[i][j] = inverse_det * (G[i][0] * adjugate[0][j] + G[i][1] * adjugate[1][j] +
                                     G[i][2] * adjugate[2][j]);
}

/// s <- R s R^T with the rotation R = (I - W/2)^-1 (I + W/2) of the spin W of the midpoint gradient
/// L; R is orthogonal to round-off for any size of the step.  [Hughes and Winget 1980, Eq. 25]
template <class T>
UNDERTOW_KERNEL void rotate_with_spin(const T (&L)[3][3], Symmetric<T>& s) {
    const T hx = 0.25 * (L[2][1] - L[1][2]), hy = 0.25 * (L[0][2] - L[2][0]),
            hz = 0.25 * (L[1][0] - L[0][1]);  // half the axial vector of W
    const T xx = hx * hx, yy = hy * hy, zz = hz * hz;
    const T k = 2.0 / (1.0 + (xx + yy + zz));
    const T kx = k * hx, ky = k * hy, kz = k * hz;
    const T xy = kx * hy, yz = ky * hz, zx = kz * hx;
    const T r00 = 1.0 - k * (yy + zz), r11 = 1.0 - k * (zz + xx), r22 = 1.0 - k * (xx + yy);
    const T r01 = xy - kz, r10 = xy + kz, r12 = yz - kx, r21 = yz + kx, r20 = zx - ky,
            r02 = zx + ky;
    // a = R s
    const T a00 = r00 * s.xx + r01 * s.xy + r02 * s.zx, a01 = r00 * s.xy + r01 * s.yy + r02 * s.yz,
            a02 = r00 * s.zx + r01 * s.yz + r02 * s.zz;
    const T a10 = r10 * s.xx + r11 * s.xy + r12 * s.zx, a11 = r10 * s.xy + r11 * s.yy + r12 * s.yz,
            a12 = r10 * s.zx + r11 * s.yz + r12 * s.zz;
    const T a20 = r20 * s.xx + r21 * s.xy + r22 * s.zx, a21 = r20 * s.xy + r21 * s.yy + r22 * s.yz,
            a22 = r20 * s.zx + r21 * s.yz + r22 * s.zz;
    s.xx = a00 * r00 + a01 * r01 + a02 * r02;
    s.yy = a10 * r10 + a11 * r11 + a12 * r12;
    s.zz = a20 * r20 + a21 * r21 + a22 * r22;
    s.xy = a00 * r10 + a01 * r11 + a02 * r12;
    s.yz = a10 * r20 + a11 * r21 + a12 * r22;
    s.zx = a20 * r00 + a21 * r01 + a22 * r02;
}

template <class T>
UNDERTOW_KERNEL Symmetric<T> symmetric_part(const T (&L)[3][3]) {
    return {L[0][0],
            L[1][1],
            L[2][2],
            0.5 * (L[0][1] + L[1][0]),
            0.5 * (L[1][2] + L[2][1]),
            0.5 * (L[2][0] + L[0][2])};
}

/// (a + b) : d_eps
template <class T>
UNDERTOW_KERNEL T work_of_sum(const Symmetric<T>& a, const Symmetric<T>& b,
                              const Symmetric<T>& d_eps) {
    return ((a.xx + b.xx) * d_eps.xx + (a.yy + b.yy) * d_eps.yy + (a.zz + b.zz) * d_eps.zz) +
           2.0 * ((a.xy + b.xy) * d_eps.xy + (a.yz + b.yz) * d_eps.yz + (a.zx + b.zx) * d_eps.zx);
}

/// Cofactors of A, which holds A_k as columns: c_k = A_k' x A_k''. Returns det A = A_0 . c_0.
template <class T>
UNDERTOW_KERNEL T cofactors(const T (&A)[3][3], T (&c)[3][3]) {
    T column[3][3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) column[k][i] = A[i][k];
    cross(column[1], column[2], c[0]);
    cross(column[2], column[0], c[1]);
    cross(column[0], column[1], c[2]);
    return dot(column[0], c[0]);
}

/// Strain increment of the midpoint gradient L with another dilatation in place of its own.
template <class T>
UNDERTOW_KERNEL Symmetric<T> strain_with_dilatation(const T (&L)[3][3], const T& dilatation) {
    Symmetric<T> d_eps = symmetric_part(L);
    const T shift = (1.0 / 3) * (dilatation - (d_eps.xx + d_eps.yy + d_eps.zz));
    d_eps.xx += shift;
    d_eps.yy += shift;
    d_eps.zz += shift;
    return d_eps;
}

}  // namespace undertow::fem
