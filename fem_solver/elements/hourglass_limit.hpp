#pragma once
// Hourglass stresses of a plastic element: bounded, so that they carry no load beyond s_u.

#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// What is left of the hourglass strength where the mean stress flows, over s_u: enough to keep the
/// mesh from wrinkling, little enough not to be felt in a limit load (docs/theory_fem.md, 9).
inline constexpr double least_hourglass_strength = 0.05;

/// Largest amplitude of a stress that varies linearly over the element around a mean stress which
/// uses the share N^2 = J2/s_u^2 of the strength: a section under such a mean stress still carries
/// 1 - N^2 of its plastic moment, and that is 1.5 times the moment at which its outer fiber yields.
///   2 s_u max(1.5 (1 - N^2), least)   [Pa] in uniaxial stress; half of it in shear
template <class T>
UNDERTOW_KERNEL T hourglass_strength(double shear_strength, const T& utilization) {
    const T least = least_hourglass_strength + 0.0 * utilization;
    return (2 * shear_strength) * larger(T(1.5 * (1.0 - utilization)), least);
}

/// Bounds the hourglass stresses Q, which are amplitudes times V0/3 and the modes' weights, by
/// `strength` [Pa]; `before` are Q before update_hourglass(). Returns the work of the step [J].
template <class T>
UNDERTOW_KERNEL T limit_hourglass(const T& strength, const T& volume_start, const T (&w)[3],
                                  const T (&p)[3][4], const T (&before)[3][4], T (&Q)[3][4]) {
    const T third = (1.0 / 3) * volume_start * strength;
    const T root[3] = {square_root(w[0]), square_root(w[1]), square_root(w[2])};
    T work = 0.0 * volume_start;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const T bending = third * w[i], torsion = (0.5 * third) * root[i] * (root[j] + root[k]);
        const T warping = (1.0 / 3) * bending;
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
