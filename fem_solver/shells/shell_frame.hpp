#pragma once
// The geometry of a quadrilateral shell at its center: local axes, Jacobian, warp.
//
//     x(xi, eta) = mean + xi X_xi + eta X_eta + xi eta X_h
//
// n is perpendicular to X_xi and X_eta, hence to both diagonals; e1 lies along X_xi. In these axes
// X_xi = (l, 0, 0), X_eta = (ex, ey, 0), X_h = (hx, hy, hz): hx, hy vanish for a parallelogram, hz
// for a flat element.

#include "fem_solver/elements/tensor.hpp"
#include "fem_solver/shells/quad_modes.hpp"

namespace undertow::fem {

template <class T>
struct ShellFrame {
    T e1[3], e2[3], n[3];
    T area;           // [m2] of the projection along n
    T l, ex, ey;      // [m] X_xi, X_eta
    T hx, hy, hz;     // [m] X_h
    T gxx, gxy, gyy;  // [1/m] dual vectors: g^xi = (gxx, gxy), g^eta = (0, gyy)
    T c_xi, c_eta;    // X_h in the plane = c_xi X_xi + c_eta X_eta
};

template <class T>
UNDERTOW_KERNEL ShellFrame<T> shell_frame(const T (&X_xi)[3], const T (&X_eta)[3],
                                          const T (&X_h)[3]) {
    ShellFrame<T> f;
    T a[3];
    cross(X_xi, X_eta, a);
    const T quarter = square_root(dot(a, a));
    f.l = square_root(dot(X_xi, X_xi));
    const T inverse_area = 1.0 / quarter, inverse_l = 1.0 / f.l;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        f.n[i] = inverse_area * a[i];
        f.e1[i] = inverse_l * X_xi[i];
    }
    cross(f.n, f.e1, f.e2);
    f.area = 4.0 * quarter;
    f.ex = dot(X_eta, f.e1);
    f.ey = quarter * inverse_l;
    f.hx = dot(X_h, f.e1);
    f.hy = dot(X_h, f.e2);
    f.hz = dot(X_h, f.n);
    f.gyy = f.l * inverse_area;
    f.gxx = inverse_l;
    f.gxy = -(f.ex * inverse_l) * f.gyy;
    f.c_xi = f.gxx * f.hx + f.gxy * f.hy;
    f.c_eta = f.gyy * f.hy;
    return f;
}

}  // namespace undertow::fem
