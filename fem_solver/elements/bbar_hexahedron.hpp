#pragma once
// The 8-point hexahedron with mean dilatation (B-bar): 2 x 2 x 2 Gauss points carry shear, the mean
// of the element carries the change of volume, so that it does not lock near incompressibility and
// needs no hourglass control.
//   [Nagtegaal, Parks and Rice 1974; Hughes 1980; finite strain: Simo, Taylor and Pister 1985]
//
// One step of one element (T = double) or of eight (T = Lanes), from the same source. In modes (see
// modes.hpp) the gradient at a point is a product of two 3 x 3 matrices, and nodal sums never
// appear:
//   1. x^n and dx = dt v^{n-1/2} become modes; mean gradient as in the one-point element
//   2. at each point: displacement gradient, its midpoint form L; strain with the mean's dilatation
//   3. stress there: rotated, then the material law
//   4. forces: deviatoric part by the point's gradient, mean stress by the mean gradient
// Derivations are in docs/theory_fem.md.

#include "fem_solver/elements/hexahedron.hpp"

namespace undertow::fem {

inline constexpr int n_gauss = 8;
inline constexpr double gauss = 0.57735026918962576;  // 1/sqrt 3
/// Signs of xi, eta, zeta at the points, in the order of the corners.
inline constexpr double gauss_sign[n_gauss][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1},
                                                  {-1, 1, -1},  {-1, -1, 1}, {1, -1, 1},
                                                  {1, 1, 1},    {-1, 1, 1}};

/// What an element keeps from step to step.
template <class T>
struct BbarState {
    static constexpr int points = n_gauss;
    Symmetric<T> stress[n_gauss];  // [Pa] Cauchy, without bulk viscosity
    T viscous;                     // [Pa] bulk-viscosity stress of the last step
};

/// What stays constant for an element.
template <class T>
struct BbarConstants {
    T mass;              // [kg]
    T length;            // [m] 2 c / omega of the reference, for the bulk viscosity
    T omega2_reference;  // [1/s2] eigenvalue bound when the largest frequency was last found
};

/// Place of a point, as factors of the hourglass modes.
struct GaussPoint {
    double xi, eta, zeta;
    explicit GaussPoint(int q)
        : xi(gauss * gauss_sign[q][0]),
          eta(gauss * gauss_sign[q][1]),
          zeta(gauss * gauss_sign[q][2]) {}
};

/// A_k = 8 d(field)/d(xi_k) at a point, from the field's modes: X_0 + zeta H_1 + eta H_2 + eta zeta
/// H_3 and its rotations.
template <class T>
UNDERTOW_KERNEL void gradient_at(const Modes<T>& m, const GaussPoint& at, T (&A)[3]) {
    const T &h0 = m.hourglass[0], &h1 = m.hourglass[1], &h2 = m.hourglass[2], &h3 = m.hourglass[3];
    A[0] = m.linear[0] + at.zeta * h1 + at.eta * (h2 + at.zeta * h3);
    A[1] = m.linear[1] + at.xi * h2 + at.zeta * (h0 + at.xi * h3);
    A[2] = m.linear[2] + at.eta * h0 + at.xi * (h1 + at.eta * h3);
}

/// The transpose: adds a point's modal forces.
template <class T>
UNDERTOW_KERNEL void add_at(const T (&P)[3], const GaussPoint& at, Modes<T>& f) {
    f.linear[0] += P[0];
    f.linear[1] += P[1];
    f.linear[2] += P[2];
    f.hourglass[0] += at.zeta * P[1] + at.eta * P[2];
    f.hourglass[1] += at.zeta * P[0] + at.xi * P[2];
    f.hourglass[2] += at.eta * P[0] + at.xi * P[1];
    f.hourglass[3] += at.eta * (at.zeta * P[0]) + at.xi * (at.zeta * P[1] + at.eta * P[2]);
}

/// Largest eigenvalue of the Gram matrix of c_0, c_1, c_2, bounded by its row sums: exact where
/// they are perpendicular.
template <class T>
UNDERTOW_KERNEL T gram_bound(const T (&c)[3][3]) {
    const T c01 = magnitude(dot(c[0], c[1])), c12 = magnitude(dot(c[1], c[2])),
            c20 = magnitude(dot(c[2], c[0]));
    return larger(larger(dot(c[0], c[0]) + c01 + c20, c01 + dot(c[1], c[1]) + c12),
                  c20 + c12 + dot(c[2], c[2]));
}

/// omega^2 <= (8/m) (lambda V tr g + 2 mu max_q |W_q|), lambda >= 0, g of the mean gradient and
/// W = V_q J_q^-1 J_q^-T of a point: in the orthonormal modes the reference gradients of all points
/// add up to at most 1, so the shear part cannot exceed the worst point.   [1/s2]
/// `shear` = max_q |W_q|. Exact for a box whose faces are free.
template <class T, class M>
UNDERTOW_KERNEL T bbar_eigenvalue_bound(const T (&C)[6][3], const T& D, const T& mass,
                                        const T& shear, const M& lambda, const M& mu) {
    T trace = dot(C[0], C[0]) + dot(C[1], C[1]) + dot(C[2], C[2]);
    trace += dot(C[3], C[3]) + dot(C[4], C[4]) + dot(C[5], C[5]);
    return (larger(lambda, M(0.0 * lambda)) * trace / D + (16 * mu) * shear) / mass;
}

/// Largest |W_q| of the points, for positions in modes.   [m]
template <class T>
UNDERTOW_KERNEL T largest_metric(const Modes<T> (&x)[3]) {
    T largest = 0.0 * x[0].linear[0];
    for (int q = 0; q < n_gauss; ++q) {
        const GaussPoint at(q);
        T A[3][3], c[3][3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) gradient_at(x[i], at, A[i]);
        const T det = cofactors(A, c);
        largest = larger(T(gram_bound(c) / (8.0 * det)), largest);
    }
    return largest;
}

/// One step. x [m] positions at n, dx [m] displacements from n-1 to n, f [N] internal forces at n.
/// plastic_strain: the equivalent one so far, of materials that harden at each point, of others
/// the mean of the points.
template <class T, class Material, class M>
UNDERTOW_KERNEL void step_bbar(const T (&x_nodes)[3][8], const T (&dx_nodes)[3][8], double dt,
                               const BbarConstants<T>& element, const Material& material,
                               const ElementLawOf<M>& law, BbarState<T>& state, T* plastic_strain,
                               T (&f)[3][8], ElementReport<T>& report) {
    const Modes<T> x[3] = {to_modes(x_nodes[0]), to_modes(x_nodes[1]), to_modes(x_nodes[2])};
    const Modes<T> dx[3] = {to_modes(dx_nodes[0]), to_modes(dx_nodes[1]), to_modes(dx_nodes[2])};
    T C[6][3], D;
    mean_gradient(x, C, D);
    const T inverse_D = 1.0 / D;
    T G0[3][3], L0[3][3];
    displacement_gradient(dx, C, inverse_D, G0);
    to_midpoint(G0, L0);
    const T dilatation = L0[0][0] + L0[1][1] + L0[2][2];
    const T of_midpoint = 1.0 - 0.5 * dilatation;  // volume there over that at n

    Modes<T> force[3];
    const T zero = 0.0 * D;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) force[i].linear[k] = zero;
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a) force[i].hourglass[a] = zero;
    }
    T mean_stress = zero;  // sum of V_q p_q, times 512
    T strain_work = zero, plastic_work = zero, mean_plastic_strain = zero, yielding = zero;
    T shear = zero, smallest = 1e300 + zero;
#pragma GCC unroll 1
    for (int q = 0; q < n_gauss; ++q) {
        const GaussPoint at(q);
        T A[3][3], dA[3][3], c[3][3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
            gradient_at(x[i], at, A[i]);
            gradient_at(dx[i], at, dA[i]);
        }
        const T det = cofactors(A, c);  // 512 V_q
        const T inverse_det = 1.0 / det;
        T G[3][3], L[3][3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
            for (int j = 0; j < 3; ++j)
                G[i][j] =
                    inverse_det * (dA[i][0] * c[0][j] + dA[i][1] * c[1][j] + dA[i][2] * c[2][j]);
        to_midpoint(G, L);
        const Symmetric<T> d_eps = strain_with_dilatation(L, dilatation);
        Symmetric<T> s = state.stress[q];
        rotate_with_spin(L, s);
        const Symmetric<T> before = s;
        PlasticFlow<T> flow;  // set and read for plastic materials alone
        update_stress(at_point(material, q), d_eps, dt, plastic_strain + q, s, flow);
        if constexpr (Material::plastic) {
            plastic_work += det * flow.work;
            if constexpr (Material::hardens)
                plastic_strain[q] += flow.strain;
            else
                mean_plastic_strain += 0.125 * flow.strain;
            yielding = larger(flow.yielding, yielding);
        }
        state.stress[q] = s;
        strain_work += det * work_of_sum(before, s, d_eps);

        const T p = (1.0 / 3) * (s.xx + s.yy + s.zz);
        mean_stress += det * p;
        const T xx = s.xx - p, yy = s.yy - p, zz = s.zz - p;
        T P[3][3];  // deviator times cofactors: 512 times the modal forces
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            P[0][k] = xx * c[k][0] + s.xy * c[k][1] + s.zx * c[k][2];
            P[1][k] = s.xy * c[k][0] + yy * c[k][1] + s.yz * c[k][2];
            P[2][k] = s.zx * c[k][0] + s.yz * c[k][1] + zz * c[k][2];
        }
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) add_at(P[i], at, force[i]);
        shear = larger(T(gram_bound(c) * (0.125 * inverse_det)), shear);
        smallest = smaller(det, smallest);
    }
    const T volume_share = (1.0 / 512) * of_midpoint;
    report.strain_work = 0.5 * volume_share * strain_work;
    report.hourglass_work = zero;
    if constexpr (Material::plastic) {
        report.plastic_work = volume_share * plastic_work;
        if constexpr (!Material::hardens) *plastic_strain += mean_plastic_strain;
        report.yielding = yielding;
    }

    const double inverse_dt = dt > 0 ? 1 / dt : 0;  // dt = 0: the state at the start, at rest
    const T closing = -inverse_dt * (element.length * dilatation);
    const T viscous = bulk_viscosity(law, T(element.mass * 64.0 * inverse_D), closing);
    report.viscous_work = (0.5 / 64) * D * of_midpoint * (state.viscous + viscous) * dilatation;
    state.viscous = viscous;

    // D = 64 V: the mean stress times dV/dmodes = C/64
    const T p = (1.0 / 64) * ((0.125 * inverse_D) * mean_stress + viscous);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            force[i].linear[k] = (1.0 / 512) * force[i].linear[k] + p * C[k][i];
            force[i].hourglass[k] = (1.0 / 512) * force[i].hourglass[k] + p * C[3 + k][i];
        }
        force[i].hourglass[3] *= 1.0 / 512;
        from_modes(force[i], f[i]);
    }

    report.omega2 = bbar_eigenvalue_bound(C, D, element.mass, shear, law.lambda, law.mu);
    // 8 V_q of the worst point: a corner that folds is seen
    report.relative_volume = (1.0 / 64) * smallest / (element.mass * law.inverse_density);
    report.compression = closing * (1 / law.sound_speed);
}

}  // namespace undertow::fem
