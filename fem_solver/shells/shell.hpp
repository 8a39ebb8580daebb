#pragma once
// The one-point quadrilateral shell: corotational axes, curvatures of rotated normals, transverse
// shear from the edges, physical stabilization, warp.
//
// One step of one element (T = double) or of eight (T = Lanes), from the same source:
//   1. nodal positions x^n, displacements dx and rotations dphi = dt omega of the step become modes
//   2. at the midpoint of the step: axes, strains, curvatures, shears (all zero in a rigid turn)
//   3. section: resultants; stabilization: generalized stresses of what varies over the element
//   4. at the end of the step: forces and moments that do the same work (the transpose)
// Derivations are in docs/theory_shells.md.

#include "fem_solver/shells/section.hpp"
#include "fem_solver/shells/shell_frame.hpp"

namespace undertow::fem {

/// What an element keeps from step to step besides its section.
template <class T>
struct ShellState {
    T shear[2];     // [N/m] transverse shear resultants along e1, e2
    T membrane[2];  // [N/m] of the in-plane hourglass, along X_xi and X_eta
    T bending[2];   // [N m] of the hourglass of the rotations, along e1, e2
    T twist[2];     // [N] of the shear that varies along eta (gamma_xi) and xi (gamma_eta)
    T drill;        // [N/m] of the normals' turn against the surface's
};

/// What stays constant for an element.
template <class T>
struct ShellConstants {
    T mass;              // [kg]
    T area;              // [m2] at the start
    T rotary;            // [m2] rotary inertia over mass
    T axis_weight[2];    // [1/m2] 1/|X_xi|^2, 1/|X_eta|^2 at the start
    T omega2_reference;  // [1/s2] eigenvalue bound when the largest frequency was last found
};

/// Scalars that all elements of a part share.
struct ShellLaw {
    double density;        // [kg/m3]
    double thickness;      // [m]
    double young_modulus;  // [Pa]
    double poisson_ratio;
    double plane_modulus;  // [Pa] E/(1 - nu^2)
    double shear_modulus;  // [Pa] times 5/6
};

/// What an element reports of a step.
template <class T>
struct ShellReport {
    T strain_work;     // [J] of the step, hourglass left out
    T hourglass_work;  // [J] of the step
    T omega2;          // [1/s2] bound on the largest eigenvalue
    T relative_area;   // A/A0
    T plastic_work;    // [J] of the step, a part of strain_work; of plastic sections alone
    T yielding;        // 1 where a point flowed, else 0; the same
};

/// Displacements, or rotated normals, of the modes along the element's axes.
template <class T>
struct InPlane {
    T x, y;
};

/// Generalized strains of a step: those of the center, and those that vary.
template <class T>
struct ShellStrains {
    T membrane[3];   // xx, yy, 2 xy
    T curvature[3];  // [1/m] xx, yy, 2 xy
    T shear[2];      // along e1, e2
    T q[2];          // [m] in-plane displacements that are not linear
    T r[2];          // rotated normals that are not linear
    T twist[2];      // [m] covariant shears that vary along eta and xi
    T drill;         // turn of the nodes about n less the spin of the surface, at the center
};

template <class T>
UNDERTOW_KERNEL void mode_vectors(const T (&a)[3][4], T (&xi)[3], T (&eta)[3], T (&h)[3],
                                  T (&mean)[3]) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const QuadModes<T> m = quad_modes(a[i]);
        mean[i] = m.mean;
        xi[i] = m.xi;
        eta[i] = m.eta;
        h[i] = m.h;
    }
}

/// beta = phi cross n along e1, e2: how far a rotation moves the end of the normal.
template <class T>
UNDERTOW_KERNEL InPlane<T> rotated_normal(const ShellFrame<T>& f, const T (&phi)[3]) {
    return {dot(phi, f.e2), -dot(phi, f.e1)};
}

/// Strains of displacements v and rotations phi in the geometry `f`:
///   membrane  sym(grad v),  curvature  sym(grad beta)  at the center
///   shear     covariant, from the edges' midpoints  [Dvorkin and Bathe 1984]
///   q, r      V_h - (grad v) X_h with the turn of the warp hz n, the same of beta
template <class T>
UNDERTOW_KERNEL void shell_strains(const ShellFrame<T>& f, const T (&v)[3][4], const T (&phi)[3][4],
                                   ShellStrains<T>& s) {
    T mean[3], xi[3], eta[3], h[3];
    mode_vectors(v, xi, eta, h, mean);
    const T u_xi = dot(xi, f.e1), v_xi = dot(xi, f.e2), w_xi = dot(xi, f.n);
    const T u_eta = dot(eta, f.e1), v_eta = dot(eta, f.e2), w_eta = dot(eta, f.n);
    const T w_x = f.gxx * w_xi, w_y = f.gxy * w_xi + f.gyy * w_eta;
    s.membrane[0] = f.gxx * u_xi;
    s.membrane[1] = f.gxy * v_xi + f.gyy * v_eta;
    s.membrane[2] = (f.gxy * u_xi + f.gyy * u_eta) + f.gxx * v_xi;
    s.q[0] = (dot(h, f.e1) - (f.c_xi * u_xi + f.c_eta * u_eta)) + f.hz * w_x;
    s.q[1] = (dot(h, f.e2) - (f.c_xi * v_xi + f.c_eta * v_eta)) + f.hz * w_y;
    const T w_h = dot(h, f.n);

    mode_vectors(phi, xi, eta, h, mean);
    s.drill = dot(mean, f.n) - 0.5 * (f.gxx * v_xi - (f.gxy * u_xi + f.gyy * u_eta));
    const InPlane<T> b = rotated_normal(f, mean), b_xi = rotated_normal(f, xi);
    const InPlane<T> b_eta = rotated_normal(f, eta), b_h = rotated_normal(f, h);
    s.curvature[0] = f.gxx * b_xi.x;
    s.curvature[1] = f.gxy * b_xi.y + f.gyy * b_eta.y;
    s.curvature[2] = (f.gxy * b_xi.x + f.gyy * b_eta.x) + f.gxx * b_xi.y;
    s.r[0] = b_h.x - (f.c_xi * b_xi.x + f.c_eta * b_eta.x);
    s.r[1] = b_h.y - (f.c_xi * b_xi.y + f.c_eta * b_eta.y);

    const T g_xi = w_xi + ((b.x * f.l + b_eta.x * f.hx) + b_eta.y * f.hy);
    const T g_eta = w_eta + ((b.x * f.ex + b.y * f.ey) + (b_xi.x * f.hx + b_xi.y * f.hy));
    s.shear[0] = f.gxx * g_xi;
    s.shear[1] = f.gxy * g_xi + f.gyy * g_eta;
    // of a shear that is uniform in the plane, and of the normals of a warped element that is
    // stretched: not strains that vary
    const T uniform = f.c_xi * g_xi + f.c_eta * g_eta;
    const T skew = (0.5 * f.gyy * f.ex) * s.membrane[2];
    const T common = (w_h - uniform) + (b.x * f.hx + b.y * f.hy);
    s.twist[0] = (common + b_eta.x * f.l) - f.hz * (s.membrane[0] - skew);
    s.twist[1] = (common + (b_xi.x * f.ex + b_xi.y * f.ey)) - f.hz * (s.membrane[1] + skew);
}

/// Forces and moments whose work on (v, phi) is area (N : membrane + M : curvature + S . shear + Z
/// drill) + Q . q + R . r + Y . twist: the transpose of shell_strains, line by line.   [N], [N m]
template <class T>
UNDERTOW_KERNEL void shell_forces(const ShellFrame<T>& f, const Resultants<T>& section,
                                  const ShellState<T>& state, T (&force)[3][4], T (&moment)[3][4]) {
    const T y_xi = state.twist[0], y_eta = state.twist[1], Y = y_xi + y_eta;
    const T Q_x = f.l * state.membrane[0] + f.ex * state.membrane[1];
    const T Q_y = f.ey * state.membrane[1];
    const T R_x = state.bending[0], R_y = state.bending[1];
    const T g_xi = f.area * (f.gxx * state.shear[0] + f.gxy * state.shear[1]) - f.c_xi * Y;
    const T g_eta = f.area * (f.gyy * state.shear[1]) - f.c_eta * Y;
    const T N_xx = f.area * section.N[0] - f.hz * y_xi;
    const T N_yy = f.area * section.N[1] - f.hz * y_eta;
    const T N_xy = f.area * section.N[2] + (0.5 * f.hz * f.gyy * f.ex) * (y_xi - y_eta);
    const T M_xx = f.area * section.M[0], M_yy = f.area * section.M[1];
    const T M_xy = f.area * section.M[2];

    const T turn = f.area * state.drill;

    const T u_xi = (f.gxx * N_xx + f.gxy * (N_xy + 0.5 * turn)) - f.c_xi * Q_x;
    const T v_xi = (f.gxy * N_yy + f.gxx * (N_xy - 0.5 * turn)) - f.c_xi * Q_y;
    const T w_xi = g_xi + f.hz * (f.gxx * Q_x + f.gxy * Q_y);
    const T u_eta = f.gyy * (N_xy + 0.5 * turn) - f.c_eta * Q_x;
    const T v_eta = f.gyy * N_yy - f.c_eta * Q_y;
    const T w_eta = g_eta + f.hz * (f.gyy * Q_y);

    const T b_x = (g_xi * f.l + g_eta * f.ex) + Y * f.hx;
    const T b_y = g_eta * f.ey + Y * f.hy;
    const T b_xi_x = ((f.gxx * M_xx + f.gxy * M_xy) - f.c_xi * R_x) + (g_eta * f.hx + y_eta * f.ex);
    const T b_xi_y = ((f.gxy * M_yy + f.gxx * M_xy) - f.c_xi * R_y) + (g_eta * f.hy + y_eta * f.ey);
    const T b_eta_x = (f.gyy * M_xy - f.c_eta * R_x) + (g_xi * f.hx + y_xi * f.l);
    const T b_eta_y = (f.gyy * M_yy - f.c_eta * R_y) + g_xi * f.hy;

#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const T a = f.e1[i], b = f.e2[i], c = f.n[i];
        quad_forces(QuadModes<T>{0.0 * Y, a * u_xi + b * v_xi + c * w_xi,
                                 a * u_eta + b * v_eta + c * w_eta, a * Q_x + b * Q_y + c * Y},
                    force[i]);
        quad_forces(QuadModes<T>{(b * b_x - a * b_y) + c * turn, b * b_xi_x - a * b_xi_y,
                                 b * b_eta_x - a * b_eta_y, b * R_x - a * R_y},
                    moment[i]);
    }
}

/// Generalized stresses of what varies over the element. Returns the work [J].
///   in the plane: bending along the element's own axes without parasitic shear; each in plane
///   stress, so that one element across bends right  [after Belytschko and Bindeman 1993]
///   rotations: the full strains of the bilinear field; shear: those of the edges.
/// And of the turn about the normal against the surface, with the shear modulus [Hughes and Brezzi
/// 1989]: moments of a shell that bends out of its neighbor's plane go on into that plane.
template <class T>
UNDERTOW_KERNEL T update_stabilization(const ShellLaw& law, const ShellConstants<T>& element,
                                       const ShellFrame<T>& f, const ShellStrains<T>& s,
                                       ShellState<T>& state) {
    const double t = law.thickness, nu = law.poisson_ratio;
    const T p_xi = f.l * s.q[0], p_eta = f.ex * s.q[0] + f.ey * s.q[1];
    const T membrane = (law.young_modulus * t / 3) * element.area;
    const T w_xi = element.axis_weight[0], w_eta = element.axis_weight[1];
    const T dQ_xi = membrane * (w_xi * w_xi) * p_xi;
    const T dQ_eta = membrane * (w_eta * w_eta) * p_eta;

    const T third = (1.0 / 3) * f.area;
    const T H_xx = third * (f.gxx * f.gxx), H_xy = third * (f.gxx * f.gxy);
    const T H_yy = third * (f.gxy * f.gxy + f.gyy * f.gyy);
    const double D = law.plane_modulus * t * t * t / 12, half = 0.5 * (1 - nu);
    const T dR_x = D * ((H_xx + half * H_yy) * s.r[0] + ((nu + half) * H_xy) * s.r[1]);
    const T dR_y = D * (((nu + half) * H_xy) * s.r[0] + (H_yy + half * H_xx) * s.r[1]);

    const double shear = law.shear_modulus * t;
    const T dY_xi = shear * (H_xx + third * (f.gxy * f.gxy)) * s.twist[0];
    const T dY_eta = shear * (third * (f.gyy * f.gyy)) * s.twist[1];

    const T dZ = shear * s.drill;

    const T work =
        (f.area * (state.drill + 0.5 * dZ)) * s.drill +
        ((state.membrane[0] + 0.5 * dQ_xi) * p_xi + (state.membrane[1] + 0.5 * dQ_eta) * p_eta) +
        ((state.bending[0] + 0.5 * dR_x) * s.r[0] + (state.bending[1] + 0.5 * dR_y) * s.r[1]) +
        ((state.twist[0] + 0.5 * dY_xi) * s.twist[0] +
         (state.twist[1] + 0.5 * dY_eta) * s.twist[1]);
    state.membrane[0] += dQ_xi;
    state.membrane[1] += dQ_eta;
    state.bending[0] += dR_x;
    state.bending[1] += dR_y;
    state.twist[0] += dY_xi;
    state.twist[1] += dY_eta;
    state.drill += dZ;
    return work;
}

/// Stresses that vary around the mean flow with it: they return by the same share, and are bounded
/// by the full plastic load of the section (docs/theory_fem.md, 9, has the reasons for solids).
template <class T>
UNDERTOW_KERNEL void limit_stabilization(const ShellLaw& law, const ShellConstants<T>& element,
                                         const ShellFrame<T>& f, const SectionWork<T>& flow,
                                         ShellState<T>& state) {
    const double t = law.thickness;
    const T third = (1.0 / 3) * element.area;
    // half again as much as where the outer fiber yields
    const T membrane = (1.5 * t) * third * flow.strength;
    const T bending =
        (1.5 * t * t / 6) * third * flow.strength * (f.gxx + magnitude(f.gxy) + f.gyy);
#pragma GCC unroll 2
    for (int k = 0; k < 2; ++k) {
        const T Q = membrane * element.axis_weight[k];
        state.membrane[k] = larger(T(-Q), smaller(Q, T(flow.membrane_left * state.membrane[k])));
        state.bending[k] =
            larger(T(-bending), smaller(bending, T(flow.bending_left * state.bending[k])));
    }
}

/// [J] of the step: mean of the stresses before and after.
template <class T>
UNDERTOW_KERNEL T stabilization_work(const ShellFrame<T>& f, const ShellStrains<T>& s,
                                     const ShellState<T>& before, const ShellState<T>& after) {
    const T p_xi = f.l * s.q[0], p_eta = f.ex * s.q[0] + f.ey * s.q[1];
    return 0.5 * (((before.membrane[0] + after.membrane[0]) * p_xi +
                   (before.membrane[1] + after.membrane[1]) * p_eta) +
                  ((before.bending[0] + after.bending[0]) * s.r[0] +
                   (before.bending[1] + after.bending[1]) * s.r[1]) +
                  f.area * (before.drill + after.drill) * s.drill +
                  ((before.twist[0] + after.twist[0]) * s.twist[0] +
                   (before.twist[1] + after.twist[1]) * s.twist[1]));
}

/// Bound on the largest eigenvalue [1/s2]: the largest of membrane, hourglass, shear against
/// rotation, and bending with varying shear, which do not meet in a parallelogram; distortion and
/// warp mix them by at most 1 + c.
template <class T>
UNDERTOW_KERNEL T shell_eigenvalue_bound(const ShellLaw& law, const ShellConstants<T>& element,
                                         const ShellFrame<T>& f) {
    const double nu = law.poisson_ratio, t = law.thickness;
    const T specific = law.thickness * f.area / element.mass;  // [m3/kg] 1/density at the start
    const T inverse_rotary = 1.0 / element.rotary;
    const T xi2 = f.gxx * f.gxx + f.gxy * f.gxy, eta2 = f.gyy * f.gyy;
    const T gxx = f.gxx * f.gxx, gyy = f.gxy * f.gxy + eta2, gxy = magnitude(f.gxx * f.gxy);
    const T row = larger(gxx, gyy) + gxy, trace = gxx + gyy;
    const T plane = law.plane_modulus * specific;
    const T membrane = plane * ((nu > 0 ? nu : 0) * trace + (1 - nu) * row);
    const T hourglass = (1.0 / 3) * plane * (element.axis_weight[0] + element.axis_weight[1]);
    const T bending = larger(membrane, T((1.0 / 3) * plane * trace));
    const T warp2 = f.hx * f.hx + f.hy * f.hy;
    const T shear = law.shear_modulus * specific;
    const T rigid = shear * (row * (1.0 + warp2 * inverse_rotary) + inverse_rotary);
    const T eta_length2 = f.ex * f.ex + f.ey * f.ey;
    const T varying = (1.0 / 3) * shear *
                      (xi2 * (1.0 + (warp2 + f.l * f.l) * inverse_rotary) +
                       eta2 * (1.0 + (warp2 + eta_length2) * inverse_rotary));
    const T drill = shear * (inverse_rotary + 0.25 * trace);
    const T c = magnitude(f.c_xi) + magnitude(f.c_eta) +
                magnitude(f.hz) * (f.gxx + magnitude(f.gxy) + f.gyy);
    const T together = larger(larger(larger(membrane, hourglass), drill),
                              larger(rigid, T(varying + (t * t / 12) * inverse_rotary * bending)));
    return (1.0 + c) * (1.0 + c) * together;
}

/// A/A0, less where corners close: 0 when a corner's Jacobian is as far below zero as it was above.
template <class T>
UNDERTOW_KERNEL T relative_area(const ShellFrame<T>& f, const T& area_start) {
    return f.area / area_start * (1.0 - 0.5 * (magnitude(f.c_xi) + magnitude(f.c_eta)));
}

/// One step. x [m] positions at n, dx [m] displacements and dphi [rad] rotations from n-1 to n;
/// f [N], m [N m] internal forces and moments, and `end` the geometry at n; the section's
/// resultants are as `points` has them.
template <class T, class Section>
UNDERTOW_KERNEL void step_shell(const T (&x)[3][4], const T (&dx)[3][4], const T (&dphi)[3][4],
                                const ShellConstants<T>& element, const Section& section,
                                const ShellLaw& law, typename Section::template State<T>& points,
                                ShellState<T>& state, Resultants<T>& resultants, T (&f)[3][4],
                                T (&m)[3][4], ShellReport<T>& report, ShellFrame<T>& end) {
    T mean[3], xi[3], eta[3], h[3], d_xi[3], d_eta[3], d_h[3];
    mode_vectors(x, xi, eta, h, mean);
    mode_vectors(dx, d_xi, d_eta, d_h, mean);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        d_xi[i] = xi[i] - 0.5 * d_xi[i];
        d_eta[i] = eta[i] - 0.5 * d_eta[i];
        d_h[i] = h[i] - 0.5 * d_h[i];
    }
    const ShellFrame<T> middle = shell_frame(d_xi, d_eta, d_h);
    ShellStrains<T> strain;
    shell_strains(middle, dx, dphi, strain);

    // the axes follow X_xi; the material turns against it by half of the shear
    const T turn = -0.5 * strain.membrane[2];
    const SectionWork<T> work =
        section(points, turn, strain.membrane, strain.curvature, resultants);
    const T s0 = state.shear[0] - turn * state.shear[1],
            s1 = state.shear[1] + turn * state.shear[0];
    const double shear_stiffness = law.shear_modulus * law.thickness;
    state.shear[0] = s0 + shear_stiffness * strain.shear[0];
    state.shear[1] = s1 + shear_stiffness * strain.shear[1];
    report.strain_work =
        middle.area * (work.total + 0.5 * ((s0 + state.shear[0]) * strain.shear[0] +
                                           (s1 + state.shear[1]) * strain.shear[1]));
    if constexpr (Section::plastic) {
        const ShellState<T> before = state;
        update_stabilization(law, element, middle, strain, state);
        limit_stabilization(law, element, middle, work, state);
        report.hourglass_work = stabilization_work(middle, strain, before, state);
        report.plastic_work = middle.area * work.plastic;
        report.yielding = work.yielding;
    } else {
        report.hourglass_work = update_stabilization(law, element, middle, strain, state);
    }

    end = shell_frame(xi, eta, h);
    shell_forces(end, resultants, state, f, m);
    report.omega2 = shell_eigenvalue_bound(law, element, end);
    report.relative_area = relative_area(end, element.area);
}

}  // namespace undertow::fem
