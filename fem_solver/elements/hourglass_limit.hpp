#pragma once
// Hourglass stresses of a plastic element: they are variations of the stress around its mean, and
// flow with it.
//
// Bounding them by what the mean stress leaves of the strength alone makes a mesh that flows
// wrinkle: an alternating load finds nothing to resist it. Measured in
// tests/unit/fem/mud_line.test.cpp and docs/theory_fem.md, 9.

#include "fem_solver/materials/plastic_flow.hpp"

namespace undertow::fem {

/// Full plastic load of a section over the one at which its outer fiber yields: of a stress that
/// varies linearly, as in bending, and of one that varies as a product, as in warping.
inline constexpr double plastic_section = 1.5, plastic_warping = 2.25;

/// Returns the hourglass stresses Q of elements whose mean stress has flowed by the share that is
/// left of their elastic trial deviator: a stress that varies around the mean returns with it. In a
/// plastic flow at the rate gammadot it decays within (s_u/mu)/gammadot, so what remains of it is
/// s_u times the share of the varying strain rate in the whole, and nothing where all of the
/// element flows alike.
///   1 - sqrt(3) mu strain/sqrt(J2)   [linearized radial return]
template <class T, class M>
UNDERTOW_KERNEL void return_hourglass(const M& mu, const PlasticFlow<T>& flow, T (&Q)[3][4]) {
    const T one = 1.0 + 0.0 * flow.strain;
    // lanes that do not flow may have no deviator at all
    const T root = square_root(larger(flow.trial_J2, T(1e-300 * one)));
    const T left = 1.0 - (1.7320508075688772 * mu) * flow.strain / root;
    const T share = larger(left, T(0.0 * one));
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a) Q[i][a] *= share;
}

/// Bounds the hourglass stresses Q, which are amplitudes times V0/3 and the modes' weights, by the
/// full plastic load of a section without any mean deviator: amplitudes of 2 s_u plastic_section in
/// bending, half of it in torsion. `before` are Q before update_hourglass(). Returns the work of
/// the step [J].
template <class T, class Strength>
UNDERTOW_KERNEL T limit_hourglass(const Strength& shear_strength, const T& volume_start, const T (&w)[3],
                                  const T (&p)[3][4], const T (&before)[3][4], T (&Q)[3][4]) {
    const T full = (plastic_section * 2 / 3 * shear_strength) * volume_start;
    const T root[3] = {square_root(w[0]), square_root(w[1]), square_root(w[2])};
    T work = 0.0 * volume_start;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const T bending = full * w[i], torsion = (0.5 * full) * root[i] * (root[j] + root[k]);
        const T warping = (plastic_warping / plastic_section / 3) * bending;
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a) {
            const T limit = a == 3 ? warping : a == i ? torsion : bending;
            Q[i][a] = larger(T(-limit), smaller(limit, Q[i][a]));
            work += 0.5 * (before[i][a] + Q[i][a]) * p[i][a];
        }
    }
    return work;
}

}  // namespace undertow::fem
