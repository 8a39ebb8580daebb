#pragma once
// J2 plasticity with linear isotropic hardening, in plane stress.
//
//     sigma_eq^2 = s_xx^2 + s_yy^2 - s_xx s_yy + 3 s_xy^2 <= (yield_stress + hardening eps_p)^2
//
// Return map in plane stress [Simo and Taylor 1986]: the flow matrix and the elastic one have the
// same principal directions, s_xx + s_yy, s_xx - s_yy and s_xy, which shrink by
//     1/(1 + E g/(3 (1 - nu))),  1/(1 + 2 mu g)  and the same,   d_eps_p = (2/3) g sigma_eq,
// so that one scalar equation for g remains. Left of its root the yield function falls and is
// convex: Newton's steps from g = 0 stay left and double their digits.

#include "fem_solver/materials/linear_elastic.hpp"
#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// What a step of plastic flow did at a point.
template <class T>
struct PlaneFlow {
    T work;      // [J/m3] dissipated
    T left;      // equivalent stress over that of the elastic trial; 1 where nothing flowed
    T yielding;  // 1 where it flowed, else 0
};

struct J2 {
    LinearElastic elastic;
    double yield_stress;  // [Pa]
    double hardening;     // [Pa] rise of the yield stress per equivalent plastic strain

    static constexpr bool plastic = true;

    template <class T>
    UNDERTOW_KERNEL T strength(const T& plastic_strain) const {
        return yield_stress + hardening * plastic_strain;
    }

    /// Updates a plane stress (xx, yy, xy) [Pa] by a strain increment (xx, yy, 2 xy), and the
    /// equivalent plastic strain.
    template <class T>
    UNDERTOW_KERNEL PlaneFlow<T> operator()(T (&s)[3], const T (&d)[3], T& plastic_strain) const {
        const double nu = elastic.poisson_ratio(), mu = elastic.mu, E = 2 * mu * (1 + nu);
        const double plane = E / (1 - nu * nu);
        const T zero = 0.0 * s[0], one = 1.0 + zero;
        const T before[3] = {s[0], s[1], s[2]};
        s[0] += plane * (d[0] + nu * d[1]);
        s[1] += plane * (d[1] + nu * d[0]);
        s[2] += mu * d[2];
        const T sum = s[0] + s[1], difference = s[0] - s[1];
        const T a = 0.25 * (sum * sum);
        const T b = 0.75 * (difference * difference) + 3.0 * (s[2] * s[2]);
        const T limit = strength(plastic_strain);
        if (!any(a + b > limit * limit)) return {zero, one, zero};

        const double p = E / (3 * (1 - nu)), q = 2 * mu, h = 2.0 / 3 * hardening;
        const T trial = square_root(larger(a + b, T(limit * limit)));
        T g = zero;
        constexpr int newton_steps = 5;
        for (int k = 0; k < newton_steps; ++k) {
            const T u = 1.0 / (1.0 + p * g), v = 1.0 / (1.0 + q * g);
            const T au = a * (u * u), bv = b * (v * v);
            const T equivalent = square_root(au + bv);
            const T slope = -(p * u * au + q * v * bv) / larger(equivalent, T(1e-300 * one));
            const T value = equivalent * (1.0 - h * g) - limit;
            g = larger(zero, T(g - value / (slope * (1.0 - h * g) - h * equivalent)));
        }
        const T flowed = a + b > limit * limit ? one : zero;
        g *= flowed;
        const T u = 1.0 / (1.0 + p * g), v = 1.0 / (1.0 + q * g);
        const T new_sum = u * sum, new_difference = v * difference;
        s[0] = 0.5 * (new_sum + new_difference);
        s[1] = 0.5 * (new_sum - new_difference);
        s[2] *= v;
        const T equivalent = square_root(a * (u * u) + b * (v * v));
        plastic_strain += (2.0 / 3) * (g * equivalent);
        // mean stress of the step on the plastic strain g P s, so that the rest is elastic energy
        const T m_sum = before[0] + before[1] + new_sum, m_xy = before[2] + s[2];
        const T m_difference = before[0] - before[1] + new_difference;
        const T work = (0.5 * g) * ((1.0 / 6) * (m_sum * new_sum) +
                                    0.5 * (m_difference * new_difference) + 2.0 * (m_xy * s[2]));
        return {work, flowed > 0.5 ? T(equivalent / trial) : one, flowed};
    }
};

}  // namespace undertow::fem
