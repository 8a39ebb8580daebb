#pragma once
// Hourglass stresses of a plastic element: they are variations of the stress around its mean, and
// flow with it.
//
// Bounding them by what the mean stress leaves of the strength alone makes a mesh that flows
// wrinkle: an alternating load finds nothing to resist it. Measured in
// tests/unit/fem/mud_line.test.cpp and docs/theory_fem.md, 9.

#include "fem_solver/materials/tresca.hpp"
#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// Full plastic load of a section over the one at which its outer fiber yields: of a stress that
/// varies linearly, as in bending, and of one that varies as a product, as in warping.
inline constexpr double plastic_section = 1.5, plastic_warping = 2.25;

/// Share of the elastic trial deviator that is left after its return, 1 where nothing flows. A
/// stress that varies around the mean returns by the same share: in a plastic flow at the rate
/// gammadot it decays within (s_u/mu)/gammadot, so what remains of it is s_u times the share of the
/// varying strain rate in the whole, and nothing where all of the element flows alike.
///   1 - sqrt(3) mu strain/sqrt(J2)   [linearized radial return]
template <class T>
UNDERTOW_KERNEL T returned_share(double mu, double shear_strength, const PlasticFlow<T>& flow) {
    const T one = 1.0 + 0.0 * flow.strain;
    // no stress flows below J2 = s_u^2
    const T root = square_root(larger(flow.utilization, one));
    const T left = 1.0 - (1.7320508075688772 * mu / shear_strength) * flow.strain / root;
    return larger(left, T(0.0 * one));
}

/// Scales the hourglass stresses Q, which are amplitudes times V0/3 and the modes' weights, by
/// `share`, and bounds them by the full plastic load of a section without any mean stress; `before`
/// are Q before update_hourglass(). Returns the work of the step [J].
template <class T>
UNDERTOW_KERNEL T limit_hourglass(double shear_strength, const T& share, const T& volume_start,
                                  const T (&w)[3], const T (&p)[3][4], const T (&before)[3][4],
                                  T (&Q)[3][4]) {
    const T third = (2 * shear_strength / 3) * volume_start;
    const T root[3] = {square_root(w[0]), square_root(w[1]), square_root(w[2])};
    T work = 0.0 * volume_start;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const T bending = plastic_section * third * w[i];
        const T torsion = (0.5 * plastic_section) * third * root[i] * (root[j] + root[k]);
        const T warping = (plastic_warping / 3) * third * w[i];
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a) {
            const T limit = a == 3 ? warping : a == i ? torsion : bending;
            Q[i][a] = larger(T(-limit), smaller(limit, T(share * Q[i][a])));
            work += 0.5 * (before[i][a] + Q[i][a]) * p[i][a];
        }
    }
    return work;
}

}  // namespace undertow::fem
