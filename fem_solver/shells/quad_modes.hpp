#pragma once
// Four nodal values of a quadrilateral as four modes, and back: a Walsh-Hadamard transform.
//   a(xi, eta) = mean + xi a_xi + eta a_eta + xi eta a_h
// Nodes as in Gmsh and VTK: 0 (- -), 1 (+ -), 2 (+ +), 3 (- +).

#include "fem_solver/simd.hpp"

namespace undertow::fem {

template <class T>
struct QuadModes {
    T mean, xi, eta, h;
};

template <class T>
UNDERTOW_KERNEL QuadModes<T> quad_modes(const T (&a)[4]) {
    const T s02 = a[0] + a[2], s13 = a[1] + a[3], d20 = a[2] - a[0], d13 = a[1] - a[3];
    return {0.25 * (s02 + s13), 0.25 * (d20 + d13), 0.25 * (d20 - d13), 0.25 * (s02 - s13)};
}

/// Nodal forces of forces that do work on the modes (the transpose).
template <class T>
UNDERTOW_KERNEL void quad_forces(const QuadModes<T>& m, T (&f)[4]) {
    const T even = m.mean + m.h, odd = m.mean - m.h, sum = m.xi + m.eta, gap = m.xi - m.eta;
    f[0] = 0.25 * (even - sum);
    f[1] = 0.25 * (odd + gap);
    f[2] = 0.25 * (even + sum);
    f[3] = 0.25 * (odd - gap);
}

}  // namespace undertow::fem
