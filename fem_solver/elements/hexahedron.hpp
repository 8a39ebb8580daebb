#pragma once
// The one-point hexahedron: mean gradient, physical hourglass stabilization, bulk viscosity.
//
// One step of one element (T = double) or of eight (T = Lanes), from the same source:
//   1. nodal positions x^n and displacements of the step dx = dt v^{n-1/2} become modes
//   2. mean gradient C of the volume (Flanagan and Belytschko 1981), displacement gradient G
//   3. midpoint gradient L (Hughes and Winget 1980): strain increment and rotation
//   4. stress: rotated, then the material law
//   5. hourglass: the part of dx that is not linear in x, as strains along the element's own axes
//   6. forces from stress, bulk viscosity and hourglass; energies; stable-step figure
// Derivations are in docs/theory_fem.md.

#include "fem_solver/elements/element_law.hpp"
#include "fem_solver/elements/hourglass_limit.hpp"
#include "fem_solver/elements/modes.hpp"
#include "fem_solver/elements/tensor.hpp"
#include "fem_solver/materials/plastic_flow.hpp"

namespace undertow::fem {

/// What an element keeps from step to step.
template <class T>
struct HexahedronState {
    static constexpr int points = 1;
    Symmetric<T> stress;  // [Pa] Cauchy, without bulk viscosity
    T viscous;            // [Pa] bulk-viscosity stress of the last step (tension positive)
    T hourglass[3][4];    // [N] generalized hourglass stresses along the element's axes
};

/// What stays constant for an element.
template <class T>
struct HexahedronConstants {
    T mass;              // [kg]
    T length;            // [m] 2 c / omega of the reference, for the bulk viscosity
    T axis_weight[3];    // [1/m2] 1 / |linear mode k|^2 at the start
    T omega2_reference;  // [1/s2] eigenvalue bound when the largest frequency was last found
};

/// Six vectors C_m = dD/dX_m for D = 64 V: the mean gradient in modes. The fourth hourglass mode
/// does not enter the volume.
///   V = (1/64) ( [X0 X1 X2] + ([X0 H2 H1] + [H2 X1 H0] + [H1 H0 X2])/3 )   [m3]
/// with [a b c] = a . (b x c), X_k the linear and H_a the hourglass modes of the positions. This is
/// the exact volume of the trilinear hexahedron, so C is Flanagan and Belytschko's gradient.
template <class T>
UNDERTOW_KERNEL void mean_gradient(const Modes<T> (&x)[3], T (&C)[6][3], T& D) {
    T X[3][3], H[3][3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
            X[k][i] = x[i].linear[k];
            H[k][i] = x[i].hourglass[k];
        }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
        const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        T xx[3], hh[3], a[3], b[3];
        cross(X[k1], X[k2], xx);
        cross(H[k2], H[k1], hh);
        cross(H[k2], X[k1], a);
        cross(X[k2], H[k1], b);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
            C[k][i] = xx[i] + (1.0 / 3) * hh[i];
            C[3 + k][i] = (1.0 / 3) * (a[i] + b[i]);
        }
    }
    // the volume is linear in the x components alone
    D = X[0][0] * C[0][0] + X[1][0] * C[1][0] + X[2][0] * C[2][0] + H[0][0] * C[3][0] +
        H[1][0] * C[4][0] + H[2][0] * C[5][0];
}

/// omega^2 <= (8/rho) (lambda tr g + 2 mu |g|), g_ij = b_iI b_jI / V^2, lambda >= 0   [1/s2]
/// The largest eigenvalue of g is bounded by the row sums of the Gram matrix of the three face
/// vectors: exact for a box in any orientation.  [after Flanagan and Belytschko 1984]
template <class T, class M>
UNDERTOW_KERNEL T eigenvalue_bound(const T (&C)[6][3], const T& D, const T& mass, const M& lambda,
                                   const M& mu) {
    const T c00 = dot(C[0], C[0]), c11 = dot(C[1], C[1]), c22 = dot(C[2], C[2]);
    const T c01 = magnitude(dot(C[0], C[1])), c12 = magnitude(dot(C[1], C[2])),
            c20 = magnitude(dot(C[2], C[0]));
    const T twist = dot(C[3], C[3]) + dot(C[4], C[4]) + dot(C[5], C[5]);
    const T row = larger(larger(c00 + c01 + c20, c01 + c11 + c12), c20 + c12 + c22);
    const M volumetric = larger(lambda, M(0.0 * lambda));  // below 0 (nu < 0) it only softens
    return (volumetric * (c00 + c11 + c22 + twist) + 2 * mu * (row + twist)) / (mass * D);
}

/// Displacement gradient of the step with respect to its end, G_ij = dx_iI b_jI / V.
template <class T>
UNDERTOW_KERNEL void displacement_gradient(const Modes<T> (&dx)[3], const T (&C)[6][3],
                                           const T& inverse_D, T (&G)[3][3]) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j)
            G[i][j] = inverse_D * ((dx[i].linear[0] * C[0][j] + dx[i].linear[1] * C[1][j] +
                                    dx[i].linear[2] * C[2][j]) +
                                   (dx[i].hourglass[0] * C[3][j] + dx[i].hourglass[1] * C[4][j] +
                                    dx[i].hourglass[2] * C[5][j]));
}

/// Hourglass displacements of the step without their linear part, on the element's axes at the
/// midpoint: p_ka = X_k . (dH_a - L H_a)   [m2]
template <class T>
UNDERTOW_KERNEL void hourglass_displacements(const Modes<T> (&x)[3], const Modes<T> (&dx)[3],
                                             const T (&L)[3][3], T (&p)[3][4]) {
    T axis[3][3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k)
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) axis[k][i] = x[i].linear[k] - 0.5 * dx[i].linear[k];
#pragma GCC unroll 4
    for (int a = 0; a < 4; ++a) {
        T h[3], d[3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) h[i] = x[i].hourglass[a] - 0.5 * dx[i].hourglass[a];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
            d[i] = dx[i].hourglass[a] - (L[i][0] * h[0] + L[i][1] * h[1] + L[i][2] * h[2]);
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) p[k][a] = dot(axis[k], d);
    }
}

/// Physical stabilization: the strains that vary linearly over the element, without the shear that
/// bending modes would bring and without change of volume (plane stress across each bending plane),
/// so that a beam one element deep bends right. Adds to Q, returns the work [J].
///   [assumed strain: Belytschko and Bindeman 1993, Puso 2000; weights in docs/theory_fem.md]
template <class T, class M>
UNDERTOW_KERNEL T update_hourglass(const ElementLawOf<M>& law, const T& volume_start,
                                   const T (&w)[3],
                                   const T (&p)[3][4], T (&Q)[3][4]) {
    const T bending = (law.bending_modulus / 3) * volume_start;
    const T torsion = (law.mu / 3) * volume_start;
    const T warping = (law.young_modulus / 9) * volume_start;
    T dQ[3][4];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const T e_ij = w[i] * p[i][j], e_ji = w[j] * p[j][i];
        dQ[i][j] = bending * w[i] * (e_ij + law.poisson_ratio * e_ji);
        dQ[j][i] = bending * w[j] * (e_ji + law.poisson_ratio * e_ij);
        dQ[i][i] = torsion * w[i] * (w[j] * (p[i][i] + p[j][j]) + w[k] * (p[i][i] + p[k][k]));
        dQ[i][3] = warping * w[i] * (w[i] * p[i][3]);
    }
    T work = 0.0 * volume_start;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a) {
            work += (Q[i][a] + 0.5 * dQ[i][a]) * p[i][a];
            Q[i][a] += dQ[i][a];
        }
    return work;
}

/// Nodal forces. The power is V sigma:L + Q_a.(dH_a - L H_a), Q_a = sum_k X_k Q_ka, so the modal
/// force is F_m = T C_m (+ Q_m) with T = sigma/64 - Q_a H_a^T / D.   [N]
template <class T>
UNDERTOW_KERNEL void nodal_forces(const Modes<T> (&x)[3], const T (&C)[6][3], const T& inverse_D,
                                  const Symmetric<T>& s, const T (&Q)[3][4], T (&f)[3][8]) {
    const T sigma[3][3] = {{s.xx, s.xy, s.zx}, {s.xy, s.yy, s.yz}, {s.zx, s.yz, s.zz}};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        T hourglass[4], t[3];
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a)
            hourglass[a] =
                x[i].linear[0] * Q[0][a] + x[i].linear[1] * Q[1][a] + x[i].linear[2] * Q[2][a];
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j)
            t[j] =
                (1.0 / 64) * sigma[i][j] -
                inverse_D * ((hourglass[0] * x[j].hourglass[0] + hourglass[1] * x[j].hourglass[1]) +
                             (hourglass[2] * x[j].hourglass[2] + hourglass[3] * x[j].hourglass[3]));
        Modes<T> force;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            force.linear[k] = dot(t, C[k]);
            force.hourglass[k] = dot(t, C[3 + k]) + hourglass[k];
        }
        force.hourglass[3] = hourglass[3];
        from_modes(force, f[i]);
    }
}

/// One step. x [m] positions at n, dx [m] displacements from n-1 to n, f [N] internal forces at n.
/// plastic_strain: the equivalent one so far, of plastic materials alone.
template <class T, class Material, class M>
UNDERTOW_KERNEL void step_hexahedron(const T (&x_nodes)[3][8], const T (&dx_nodes)[3][8], double dt,
                                     const HexahedronConstants<T>& element,
                                     const Material& material, const ElementLawOf<M>& law,
                                     HexahedronState<T>& state, T* plastic_strain, T (&f)[3][8],
                                     ElementReport<T>& report) {
    const Modes<T> x[3] = {to_modes(x_nodes[0]), to_modes(x_nodes[1]), to_modes(x_nodes[2])};
    const Modes<T> dx[3] = {to_modes(dx_nodes[0]), to_modes(dx_nodes[1]), to_modes(dx_nodes[2])};
    T C[6][3], D;
    mean_gradient(x, C, D);
    const T inverse_D = 1.0 / D, volume = D * (1.0 / 64);
    const T volume_start = element.mass * law.inverse_density;

    T G[3][3], L[3][3];
    displacement_gradient(dx, C, inverse_D, G);
    to_midpoint(G, L);
    const Symmetric<T> d_eps = symmetric_part(L);
    const T dilatation = d_eps.xx + d_eps.yy + d_eps.zz;
    const T half_volume = 0.5 * volume * (1.0 - 0.5 * dilatation);  // of the midpoint

    Symmetric<T> s = state.stress;
    rotate_with_spin(L, s);
    const Symmetric<T> before = s;
    PlasticFlow<T> flow;  // set and read for plastic materials alone
    const auto& here = at_point(material, 0);
    update_stress(here, d_eps, dt, plastic_strain, s, flow);
    state.stress = s;
    report.strain_work = half_volume * work_of_sum(before, s, d_eps);

    const double inverse_dt = dt > 0 ? 1 / dt : 0;  // dt = 0: the state at the start, at rest
    const T closing = -inverse_dt * (element.length * dilatation);
    const T q = bulk_viscosity(law, T(element.mass * 64.0 * inverse_D), closing);
    report.viscous_work = half_volume * (state.viscous + q) * dilatation;
    state.viscous = q;

    T p[3][4];
    hourglass_displacements(x, dx, L, p);
    if constexpr (Material::plastic) {
        T Q[3][4];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
#pragma GCC unroll 4
            for (int a = 0; a < 4; ++a) Q[i][a] = state.hourglass[i][a];
        update_hourglass(law, volume_start, element.axis_weight, p, state.hourglass);
        if (any(flow.strain > 0.0)) return_hourglass(law.mu, flow, state.hourglass);
        *plastic_strain += flow.strain;
        report.hourglass_work = limit_hourglass(here.shear_limit(s, *plastic_strain),
                                                volume_start, element.axis_weight, p, Q,
                                                state.hourglass);
        report.plastic_work = (2.0 * half_volume) * flow.work;
        report.yielding = flow.yielding;
    } else {
        report.hourglass_work =
            update_hourglass(law, volume_start, element.axis_weight, p, state.hourglass);
    }

    s.xx += q;
    s.yy += q;
    s.zz += q;
    nodal_forces(x, C, inverse_D, s, state.hourglass, f);

    report.omega2 = eigenvalue_bound(C, D, element.mass, law.lambda, law.mu);
    report.relative_volume = volume / volume_start;
    report.compression = closing * (1 / law.sound_speed);
}

}  // namespace undertow::fem
