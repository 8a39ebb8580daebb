#pragma once
// Laws with depth as the kernels see them: constants of eight elements side by side, packed for
// each batch as sound speed, moduli, then the strengths of each integration point.

#include "fem_solver/elements/bbar_hexahedron.hpp"
#include "fem_solver/elements/element_law.hpp"
#include "fem_solver/materials/material.hpp"

namespace undertow::fem {

namespace packed {
inline constexpr int sound_speed = 0, lambda = 1, mu = 2, strengths = 3;
}

/// Strengths of a point in lanes, how many there are and where they lie.
inline constexpr int n_strengths(const Tresca*) {
    return 1;
}
inline constexpr int n_strengths(const MohrCoulomb*) {
    return 2;
}
inline void put_strength(const Tresca& law, Lanes* at, int lane) {
    at[0][lane] = law.shear_strength;
}
inline void put_strength(const MohrCoulomb& law, Lanes* at, int lane) {
    at[0][lane] = law.cohesion;
    at[1][lane] = law.tension;
}

/// A material of step_hexahedron() and the others: at_point() gives the law of an integration
/// point.
template <class Law>
struct LocalLaw {
    const WithDepth<Law>& of_part;
    const Lanes* figure;  // of the batch

    static constexpr bool plastic = Law::plastic, hardens = Law::hardens;
    static constexpr bool dilates = WithDepth<Law>::dilates;

    UNDERTOW_KERNEL LinearElasticOf<Lanes> moduli() const {
        return {figure[packed::lambda], figure[packed::mu]};
    }
};

UNDERTOW_KERNEL TrescaOf<Lanes> at_point(const LocalLaw<Tresca>& local, int q) {
    return {local.moduli(), local.figure[packed::strengths + q]};
}
UNDERTOW_KERNEL MohrCoulombOf<Lanes> at_point(const LocalLaw<MohrCoulomb>& local, int q) {
    const MohrCoulomb& form = local.of_part.form;
    return {local.moduli(), form.sin_friction, form.sin_dilation,
            local.figure[packed::strengths + 2 * q], local.figure[packed::strengths + 2 * q + 1]};
}

/// The part's figures with the moduli of the batch.
UNDERTOW_KERNEL ElementLawOf<Lanes> local_element_law(const ElementLaw& of_part,
                                                      const Lanes* figure) {
    const double nu = of_part.poisson_ratio;
    const Lanes lambda = figure[packed::lambda], mu = figure[packed::mu];
    return {of_part.inverse_density,
            lambda,
            mu,
            figure[packed::sound_speed],
            2 * mu / (1 - nu),
            nu,
            2 * mu * (1 + nu),
            of_part.bulk_viscosity_linear,
            of_part.bulk_viscosity_quadratic};
}

/// Heights [m] of the integration points: the mean of the corners, or the eight Gauss points.
template <int points, int n_corners>
void heights_of_points(const double (&corner)[n_corners], double (&z)[points]) {
    for (double& height : z) height = 0;
    for (int q = 0; q < points; ++q)
        for (int c = 0; c < n_corners; ++c) {
            double share = 1.0 / n_corners;
            if constexpr (points == n_gauss)
                for (int d = 0; d < 3; ++d)
                    share *= 1 + gauss * gauss_sign[q][d] * gauss_sign[c][d];
            z[q] += share * corner[c];
        }
}

}  // namespace undertow::fem
