#pragma once
// The 4-node tetrahedron with averaged pressure: shear by its own constant strain, change of volume
// by the mean over a patch of about eight neighbors, so that it can be used near incompressibility.
//   [F-bar-Patch: de Souza Neto, Andrade Pires and Owen 2005]
//
// A step has two passes. The first finds the volumes of all elements and their changes in the step;
// a patch adds them up: theta = sum dV/sum V. The second takes the patch's dilatation and
// everything else from the element's own shape. Forces are those of the element's own mean stress:
// elastically the energy is sum_p V_p kappa/2 theta_p^2, and the stiffness is symmetric. Averages
// over the elements around each node (Bonet and Burton 1998) were measured too:
// docs/theory_fem.md, 13. Where plastic flow changes the volume, mean stresses differ within a patch; a
// third pass then takes the patch's mean of them, so that what the dilatation does is what the forces do.
//
// T = double is the readable reference, T = Lanes eight elements side by side.

#include "fem_solver/elements/element_law.hpp"
#include "fem_solver/elements/tensor.hpp"
#include "fem_solver/materials/plastic_flow.hpp"

namespace undertow::fem {

/// What an element keeps from step to step.
template <class T>
struct TetrahedronState {
    static constexpr int points = 1;
    Symmetric<T> stress;  // [Pa] Cauchy, without bulk viscosity
    T viscous;            // [Pa] bulk-viscosity stress of the last step
};

/// What stays constant for an element.
template <class T>
struct TetrahedronConstants {
    T mass;              // [kg]
    T length;            // [m] 2 c / omega of the reference, for the bulk viscosity
    T omega2_reference;  // [1/s2] eigenvalue bound when the largest frequency was last found
};

/// Edges from node 0 as columns: A[i][k] = (x_{k+1} - x_0)_i.
template <class T>
UNDERTOW_KERNEL void edges_of(const T (&x)[3][4], T (&A)[3][3]) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) A[i][k] = x[i][k + 1] - x[i][0];
}

/// Displacement gradient of the step with respect to its end, G = dA A^-1; c are the cofactors of
/// A, 6 V its determinant.
template <class T>
UNDERTOW_KERNEL void edge_gradient(const T (&dA)[3][3], const T (&c)[3][3], const T& inverse_det,
                                   T (&G)[3][3]) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j)
            G[i][j] = inverse_det * (dA[i][0] * c[0][j] + dA[i][1] * c[1][j] + dA[i][2] * c[2][j]);
}

/// V at n and its change from n-1 to n: V (tr G - (second invariant) + det G), which keeps its
/// digits for small displacements.   [m3]
template <class T>
UNDERTOW_KERNEL void volume_and_change(const T (&x)[3][4], const T (&dx)[3][4], T& volume,
                                       T& change) {
    T A[3][3], dA[3][3], c[3][3], G[3][3];
    edges_of(x, A);
    edges_of(dx, dA);
    const T det = cofactors(A, c);
    edge_gradient(dA, c, T(1.0 / det), G);
    const T m0 = G[1][1] * G[2][2] - G[1][2] * G[2][1], m1 = G[1][0] * G[2][2] - G[1][2] * G[2][0],
            m2 = G[1][0] * G[2][1] - G[1][1] * G[2][0];
    const T second =
        m0 + (G[0][0] * G[2][2] - G[0][2] * G[2][0]) + (G[0][0] * G[1][1] - G[0][1] * G[1][0]);
    const T third = G[0][0] * m0 - G[0][1] * m1 + G[0][2] * m2;
    volume = (1.0 / 6) * det;
    change = volume * ((G[0][0] + G[1][1] + G[2][2]) - second + third);
}

/// omega^2 <= (4/m) V (lambda tr g + 2 mu |g|), lambda >= 0, g_ij = b_iI b_jI.   [1/s2]
/// The elements' own dilatations bound the averaged one, whose energy is smaller.
template <class T, class M>
UNDERTOW_KERNEL T tetrahedron_eigenvalue_bound(const T (&c)[3][3], const T& det, const T& mass,
                                               const M& lambda, const M& mu) {
    T sum[3];  // node 0: its gradient is minus the sum of the others'
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) sum[i] = c[0][i] + c[1][i] + c[2][i];
    T g[3][3];  // times det^2
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j)
            g[i][j] = c[0][i] * c[0][j] + c[1][i] * c[1][j] + c[2][i] * c[2][j] + sum[i] * sum[j];
    const T g01 = magnitude(g[0][1]), g12 = magnitude(g[1][2]), g20 = magnitude(g[2][0]);
    const T row = larger(larger(g[0][0] + g01 + g20, g01 + g[1][1] + g12), g20 + g12 + g[2][2]);
    const T trace = g[0][0] + g[1][1] + g[2][2];
    return (2.0 / 3) * (larger(lambda, M(0.0 * lambda)) * trace + (2 * mu) * smaller(row, trace)) /
           (mass * det);
}

/// One step. x [m] positions at n, dx [m] displacements from n-1 to n, dilatation: the patch's,
/// f [N] internal forces at n, plastic_strain: the equivalent one so far, of plastic materials alone.
template <class T, class Material, class M>
UNDERTOW_KERNEL void step_tetrahedron(const T (&x)[3][4], const T (&dx)[3][4], const T& dilatation,
                                      double dt, const TetrahedronConstants<T>& element,
                                      const Material& material, const ElementLawOf<M>& law,
                                      TetrahedronState<T>& state, T* plastic_strain, T (&f)[3][4],
                                      ElementReport<T>& report) {
    T A[3][3], dA[3][3], c[3][3], G[3][3], L[3][3];
    edges_of(x, A);
    edges_of(dx, dA);
    const T det = cofactors(A, c);  // 6 V
    const T inverse_det = 1.0 / det, volume = (1.0 / 6) * det;
    edge_gradient(dA, c, inverse_det, G);
    to_midpoint(G, L);
    const T own = L[0][0] + L[1][1] + L[2][2];
    const Symmetric<T> d_eps = strain_with_dilatation(L, dilatation);
    const T of_midpoint = volume * (1.0 - 0.5 * own);

    Symmetric<T> s = state.stress;
    rotate_with_spin(L, s);
    const Symmetric<T> before = s;
    PlasticFlow<T> flow;  // set and read for plastic materials alone
    update_stress(at_point(material, 0), d_eps, dt, plastic_strain, s, flow);
    state.stress = s;
    if constexpr (Material::dilates) {
        report.strain_work = (0.5 * of_midpoint) * work_of_sum(before, s, d_eps);
        const T p = (1.0 / 3) * (s.xx + s.yy + s.zz);
        s.xx -= p;  // its forces: press_tetrahedron()
        s.yy -= p;
        s.zz -= p;
    } else {
        // the mean stress works on the element's own dilatation, as the forces do
        const T mean = (1.0 / 3) * ((before.xx + s.xx) + (before.yy + s.yy) + (before.zz + s.zz));
        report.strain_work =
            (0.5 * of_midpoint) * (work_of_sum(before, s, d_eps) + mean * (own - dilatation));
    }
    report.hourglass_work = 0.0 * volume;
    if constexpr (Material::plastic) {
        report.plastic_work = of_midpoint * flow.work;
        *plastic_strain += flow.strain;
        report.yielding = flow.yielding;
    }

    const T volume_start = element.mass * law.inverse_density;
    const double inverse_dt = dt > 0 ? 1 / dt : 0;  // dt = 0: the state at the start, at rest
    const T closing = -inverse_dt * (element.length * dilatation);
    const T q = bulk_viscosity(law, T(element.mass / volume), closing);
    report.viscous_work = (0.5 * of_midpoint) * (state.viscous + q) * own;
    state.viscous = q;

    const T xx = s.xx + q, yy = s.yy + q, zz = s.zz + q;
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {  // V b_k = c_k/6
        f[0][k + 1] = (1.0 / 6) * (xx * c[k][0] + s.xy * c[k][1] + s.zx * c[k][2]);
        f[1][k + 1] = (1.0 / 6) * (s.xy * c[k][0] + yy * c[k][1] + s.yz * c[k][2]);
        f[2][k + 1] = (1.0 / 6) * (s.zx * c[k][0] + s.yz * c[k][1] + zz * c[k][2]);
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) f[i][0] = -(f[i][1] + f[i][2] + f[i][3]);

    report.omega2 = tetrahedron_eigenvalue_bound(c, det, element.mass, law.lambda, law.mu);
    report.relative_volume = volume / volume_start;
    report.compression = closing * (1 / law.sound_speed);
}

/// Forces of a mean stress p [Pa]: p V b_k, V b_k = c_k/6   [N]
template <class T>
UNDERTOW_KERNEL void press_tetrahedron(const T (&x)[3][4], const T& p, T (&f)[3][4]) {
    T A[3][3], c[3][3];
    edges_of(x, A);
    cofactors(A, c);
    const T share = (1.0 / 6) * p;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) f[i][k + 1] = share * c[k][i];
        f[i][0] = -(f[i][1] + f[i][2] + f[i][3]);
    }
}

}  // namespace undertow::fem
