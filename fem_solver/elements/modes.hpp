#pragma once
// Eight nodal values of a hexahedron as eight modes, and back: a Walsh-Hadamard transform, adds
// only. In modes the mean-gradient element of Flanagan and Belytschko needs a quarter of the
// arithmetic of its nodal formula: volume, gradient and forces involve the three linear modes and
// three of the four hourglass modes alone.
//
// Nodes as in VTK and Gmsh: 0 (- - -), 1 (+ - -), 2 (+ + -), 3 (- + -), 4 to 7 the same with zeta =
// +.

#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// mode_m = sum_I Gamma_mI a_I, Gamma_mI = +-1; a_I = (1/8) sum_m Gamma_mI mode_m.
/// linear[k]: xi, eta, zeta. hourglass[a]: eta zeta, zeta xi, xi eta, xi eta zeta. The mean is left
/// out: no force and no strain depends on it.
template <class T>
struct Modes {
    T linear[3];
    T hourglass[4];
};

template <class T>
UNDERTOW_KERNEL Modes<T> to_modes(const T (&a)[8]) {
    // opposite corners: their sum holds the even modes, their difference the odd ones
    const T s0 = a[6] + a[0], s1 = a[7] + a[1], s2 = a[4] + a[2], s3 = a[5] + a[3];
    const T d0 = a[6] - a[0], d1 = a[7] - a[1], d2 = a[4] - a[2], d3 = a[5] - a[3];
    const T d01 = d0 + d1, d23 = d2 + d3, e01 = d0 - d1, e23 = d2 - d3;
    return {{e01 - e23, d01 - d23, d01 + d23},
            {(s0 + s1) - (s2 + s3), (s0 + s3) - (s1 + s2), (s0 + s2) - (s1 + s3), e01 + e23}};
}

/// The transpose: f_I = sum_m Gamma_mI mode_m (forces from modal forces).
template <class T>
UNDERTOW_KERNEL void from_modes(const Modes<T>& m, T (&f)[8]) {
    const T a = m.hourglass[0], b = m.hourglass[1], c = m.hourglass[2], d = m.hourglass[3];
    const T x = m.linear[0], y = m.linear[1], z = m.linear[2];
    const T even0 = (a + b) + c, even1 = (a - b) - c, even2 = c - (a + b), even3 = (b - a) - c;
    const T xd = x + d, dx = d - x, yz = y + z, zy = z - y;
    const T odd0 = yz + xd, odd1 = yz - xd, odd2 = zy + dx, odd3 = zy - dx;
    f[0] = even0 - odd0;
    f[6] = even0 + odd0;
    f[1] = even1 - odd1;
    f[7] = even1 + odd1;
    f[2] = even2 - odd2;
    f[4] = even2 + odd2;
    f[3] = even3 - odd3;
    f[5] = even3 + odd3;
}

}  // namespace undertow::fem
