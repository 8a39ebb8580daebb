#pragma once
// Isotropic linear elasticity, as a law: constants in, stress updated in place. Every material has
// this shape: operator()(state, strain increment, dt), a template over the number type; the
// rotation of the stress (objective rate) has been done by the element before.
//
// M is the type of the constants: double where a part has one value, Lanes where each of eight
// elements has its own.

#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// Symmetric second-order tensor; shear components are those of the tensor (not engineering).
template <class T>
struct Symmetric {
    T xx, yy, zz, xy, yz, zx;
};

/// sigma += lambda tr(d_eps) I + 2 mu d_eps   [Pa]
template <class M>
struct LinearElasticOf {
    M lambda;  // [Pa] first Lame constant
    M mu;      // [Pa] shear modulus

    static constexpr bool plastic = false, dilates = false;

    static LinearElasticOf from_young(M young_modulus, double poisson_ratio) {
        const M E = young_modulus;
        const double nu = poisson_ratio;
        return {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))};
    }
    M poisson_ratio() const { return lambda / (2 * (lambda + mu)); }

    template <class T>
    UNDERTOW_KERNEL void operator()(Symmetric<T>& s, const Symmetric<T>& d_eps,
                                    double /*dt: rate-independent*/) const {
        const T pressure_part = lambda * (d_eps.xx + d_eps.yy + d_eps.zz);
        s.xx += pressure_part + 2 * mu * d_eps.xx;
        s.yy += pressure_part + 2 * mu * d_eps.yy;
        s.zz += pressure_part + 2 * mu * d_eps.zz;
        s.xy += 2 * mu * d_eps.xy;
        s.yz += 2 * mu * d_eps.yz;
        s.zx += 2 * mu * d_eps.zx;
    }
};
using LinearElastic = LinearElasticOf<double>;

}  // namespace undertow::fem
