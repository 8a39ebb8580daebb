#pragma once
// J2 plasticity (von Mises) with isotropic hardening, in solids and in plane stress.
//
//     sigma_eq^2 = 3 J2 <= k(eps_p)^2, in plane stress
//     sigma_eq^2 = s_xx^2 + s_yy^2 - s_xx s_yy + 3 s_xy^2
//
// Return map in solids [Wilkins 1964]: the elastic trial deviator shrinks along itself until
//     sigma_eq_trial - 3 mu d_eps_p = k(eps_p + d_eps_p)
//
// Return map in plane stress [Simo and Taylor 1986]: the flow matrix and the elastic one have the
// same principal directions, s_xx + s_yy, s_xx - s_yy and s_xy, which shrink by
//     1/(1 + E g/(3 (1 - nu))),  1/(1 + 2 mu g)  and the same,   d_eps_p = (2/3) g sigma_eq,
// so that one scalar equation for g remains. Left of its root the yield function falls and is
// convex: Newton's steps from g = 0 stay left and double their digits.

#include "fem_solver/materials/hardening.hpp"
#include "fem_solver/materials/plastic_flow.hpp"

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
    Hardening hardening;  // k(eps_p)

    static constexpr bool plastic = true, hardens = true, dilates = false;

    template <class T>
    UNDERTOW_KERNEL T strength(const T& plastic_strain) const {
        return hardening.strength(plastic_strain);
    }

    /// Half of what a fiber bears in tension: bounds hourglass stresses.   [Pa]
    template <class T>
    UNDERTOW_KERNEL T shear_limit(const Symmetric<T>& /*stress*/, const T& plastic_strain) const {
        return 0.5 * strength(plastic_strain);
    }

    /// Updates the stress of a solid [Pa]; the equivalent plastic strain so far grows by flow.strain.
    template <class T>
    UNDERTOW_KERNEL void operator()(Symmetric<T>& s, const Symmetric<T>& d_eps, double dt,
                                    const T& plastic_strain, PlasticFlow<T>& flow) const {
        const Symmetric<T> before = s;
        elastic(s, d_eps, dt);
        const T p = (1.0 / 3) * (s.xx + s.yy + s.zz);
        const T xx = s.xx - p, yy = s.yy - p, zz = s.zz - p;
        flow.trial_J2 =
            0.5 * (xx * xx + yy * yy + zz * zz) + (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx);
        flow.strain = flow.work = flow.yielding = 0.0 * p;
        const T limit = strength(plastic_strain);
        const auto yields = 3.0 * flow.trial_J2 > limit * limit;
        if (!any(yields)) return;

        const T one = 1.0 + 0.0 * p;
        flow.yielding = yields ? one : T(0.0 * one);
        const T trial = square_root(larger(T(3.0 * flow.trial_J2), T(limit * limit)));
        flow.strain = flow.yielding *
                      larger(hardening.flow(trial, 3 * elastic.mu, plastic_strain), T(0.0 * one));
        const T n = 1.5 * flow.strain / trial;  // d_eps_p = n times the trial deviator
        const T left = 1.0 - 2 * elastic.mu * n;
        const T xy = s.xy, yz = s.yz, zx = s.zx;
        s = {p + left * xx, p + left * yy, p + left * zz, left * xy, left * yz, left * zx};
        const T along = (before.xx + s.xx) * xx + (before.yy + s.yy) * yy + (before.zz + s.zz) * zz;
        const T across =
            2.0 * ((before.xy + s.xy) * xy + (before.yz + s.yz) * yz + (before.zx + s.zx) * zx);
        flow.work = (0.5 * n) * (along + across);
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

        const double p = E / (3 * (1 - nu)), q = 2 * mu;
        const T h = (2.0 / 3) * hardening.tangent(plastic_strain);  // corrected in the next step
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
