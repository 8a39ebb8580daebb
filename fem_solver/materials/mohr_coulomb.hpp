#pragma once
// Mohr-Coulomb with a tension cut-off: linear elastic until a plane slides or opens. Sand and rock;
// soil under drained loads.

#include "fem_solver/materials/plastic_flow.hpp"
#include "fem_solver/materials/principal.hpp"

namespace undertow::fem {

/// s1 >= s2 >= s3 principal stresses, tension positive:
///   f = (1 + sin phi) s1 - (1 - sin phi) s3 - 2 c cos phi <= 0   sliding, flow by the same with
///   psi s1 <= T <= c cot phi                                           opening, associated flow
///
/// Both surfaces are planes in principal space and elasticity is isotropic, so a return is a sum of
/// flows off the planes that are active in the end, each in closed form: face, edge s1 = s2, edge
/// s2 = s3; opened along one, two or three directions; sliding and open, where s1 = T and s3 is
/// what f = 0 then leaves. With 0 <= psi <= phi and T <= c cot phi one and only one set of planes
/// is consistent, and the apex of the pyramid belongs to the cut-off.
///   [Clausen, Damkilde and Andersen 2006, 2007; de Souza Neto, Peric and Owen 2008, ch. 8;
///    the cut-off: derived in docs/theory_fem.md, 9]
template <class M>
struct MohrCoulombOf {
    LinearElasticOf<M> elastic;
    double sin_friction;  // sin phi
    double sin_dilation;  // sin psi
    M cohesion;           // [Pa] c cos phi
    M tension;            // [Pa] T

    /// T where neither cohesion nor the case sets an end.   [Pa]
    static constexpr double no_cutoff = 1e100;

    static constexpr bool plastic = true, hardens = false, dilates = true;

    /// Radius of the largest Mohr circle around the mean stress; bounds hourglass stresses.   [Pa]
    template <class T>
    UNDERTOW_KERNEL T shear_limit(const Symmetric<T>& s, const T& /*eps_p*/) const {
        const T p = (1.0 / 3) * (s.xx + s.yy + s.zz);
        return larger(T(cohesion - sin_friction * p), T(0.0 * p));
    }

    /// Principal stresses r1 >= r2 >= r3 [Pa] return to where they may be. Returns where they
    /// moved.
    template <class T>
    UNDERTOW_KERNEL auto return_principal(T& r1, T& r2, T& r3) const {
        const M lambda = elastic.lambda, mu = elastic.mu;
        const double a = 1 + sin_friction, b = 1 - sin_friction;
        const double open = 1 + sin_dilation, close = 1 - sin_dilation;
        // stress relaxed by a unit of slip on (1, 3): by volume, along s1, along s3
        const M volume = 2 * lambda * sin_dilation;
        const M drop = 2 * mu * open + volume, rise = 2 * mu * close - volume;
        const M both = 2 * volume * sin_friction;
        const M of_face = 4 * mu * (1 + sin_friction * sin_dilation) + both;
        const M of_upper = mu * (a * open + 2 * b * close) + both;
        const M of_lower = mu * (2 * a * open + b * close) + both;
        const T t1 = r1, t2 = r2, t3 = r3, zero = 0.0 * r1;
        const T limit = 2 * cohesion + zero, T_max = tension + zero;

        const T f = a * t1 - b * t3 - limit;
        const auto yields = (f > 0.0) | (t1 > tension);
        const T slip = (1.0 / of_face) * larger(f, zero);
        const T face1 = t1 - drop * slip, face2 = t2 - volume * slip, face3 = t3 + rise * slip;
        // where the slip would take two principal stresses past each other both planes slide
        const T mean12 = 0.5 * (t1 + t2), mean23 = 0.5 * (t2 + t3);
        const T upper = (1.0 / of_upper) * (a * mean12 - b * t3 - limit);
        const T lower = (1.0 / of_lower) * (a * t1 - b * mean23 - limit);
        const T upper12 = mean12 - (mu * open + volume) * upper, upper3 = t3 + rise * upper;
        const T lower1 = t1 - drop * lower, lower23 = mean23 + (mu * close - volume) * lower;
        const auto on_upper = face2 > face1, on_lower = face3 > face2;
        r1 = on_upper ? upper12 : on_lower ? lower1 : face1;
        r2 = on_upper ? upper12 : on_lower ? lower23 : face2;
        r3 = on_upper ? upper3 : on_lower ? lower23 : face3;

        // beyond the apex s1 = s2 > c cot phi >= T, so that this finds what belongs there
        const auto opens = r1 > tension;
        if (!any(opens)) return yields;
        const T one_open = (lambda / (lambda + 2 * mu)) * (t1 - T_max);
        const T two_open = (lambda / (2 * (lambda + mu))) * (t1 + t2 - 2.0 * T_max);
        const auto second = t2 - one_open > tension;
        T open2 = second ? T_max : T(t2 - one_open);
        T open3 = smaller(T_max, second ? T(t3 - two_open) : T(t3 - one_open));
        // s1 = T and f = 0: the flow has no part along s2, so that both others give its volume
        const T least = smaller(T_max, T((1 / b) * (a * T_max - limit)));
        const T sliding2 = t2 - (lambda / (2 * (lambda + mu))) * (t1 - T_max + t3 - least);
        const auto slides = open3 < least;
        open2 = slides ? larger(least, smaller(T_max, sliding2)) : open2;
        open3 = slides ? least : open3;
        r1 = opens ? T_max : r1;
        r2 = opens ? open2 : r2;
        r3 = opens ? open3 : r3;
        return yields;
    }

    template <class T>
    UNDERTOW_KERNEL void operator()(Symmetric<T>& s, const Symmetric<T>& d_eps, double dt,
                                    PlasticFlow<T>& flow) const {
        const Symmetric<T> before = s;
        elastic(s, d_eps, dt);
        const T p = (1.0 / 3) * (s.xx + s.yy + s.zz);
        const T xx = s.xx - p, yy = s.yy - p, zz = s.zz - p;
        const T J2 =
            0.5 * (xx * xx + yy * yy + zz * zz) + (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx);
        flow.strain = flow.work = flow.yielding = 0.0 * J2;
        flow.trial_J2 = J2;
        // f/2 is at most p sin phi + sqrt(J2 (1 + sin^2 phi/3)) - c cos phi, over all Lode angles;
        // s1 is at most p + sqrt(4/3 J2). Most batches end here.
        const T strength = cohesion - sin_friction * p, room = tension - p;
        const double of_slip = 1 + sin_friction * sin_friction / 3;
        if (any((of_slip * J2 > strength * strength) | (4.0 / 3 * J2 > room * room) | (room < 0.0)))
            flow_back(before, p, {xx, yy, zz, s.xy, s.yz, s.zx}, s, flow);
    }

 private:
    /// Returns the lanes that yield; `s` holds the trial stress, p its mean, D its deviator.
    template <class T>
    UNDERTOW_KERNEL void flow_back(const Symmetric<T>& before, const T& p, const Symmetric<T>& D,
                                   Symmetric<T>& s, PlasticFlow<T>& flow) const {
        const Symmetric<T> trial = s;
        const Principal<T> principal(p, D, flow.trial_J2);
        T r1 = principal.value[0], r2 = principal.value[1], r3 = principal.value[2];
        const auto yields = return_principal(r1, r2, r3);
        const Symmetric<T> r = principal.with_values(r1, r2, r3);
        s.xx = yields ? r.xx : trial.xx;
        s.yy = yields ? r.yy : trial.yy;
        s.zz = yields ? r.zz : trial.zz;
        s.xy = yields ? r.xy : trial.xy;
        s.yz = yields ? r.yz : trial.yz;
        s.zx = yields ? r.zx : trial.zx;

        // d_eps_p from the drop of the stress
        const M lambda = elastic.lambda, compliance = 0.5 / elastic.mu;
        const M of_trace = lambda / (3 * lambda + 2 * elastic.mu);
        const T trace = trial.xx - s.xx + (trial.yy - s.yy) + (trial.zz - s.zz);
        const T exx = compliance * (trial.xx - s.xx - of_trace * trace),
                eyy = compliance * (trial.yy - s.yy - of_trace * trace),
                ezz = compliance * (trial.zz - s.zz - of_trace * trace),
                exy = compliance * (trial.xy - s.xy), eyz = compliance * (trial.yz - s.yz),
                ezx = compliance * (trial.zx - s.zx);
        const T third = (1.0 / 3) * (exx + eyy + ezz);
        const T dxx = exx - third, dyy = eyy - third, dzz = ezz - third;
        flow.strain = square_root(T((2.0 / 3) * (dxx * dxx + dyy * dyy + dzz * dzz) +
                                    (4.0 / 3) * (exy * exy + eyz * eyz + ezx * ezx)));
        flow.work =
            0.5 * ((before.xx + s.xx) * exx + (before.yy + s.yy) * eyy + (before.zz + s.zz) * ezz) +
            ((before.xy + s.xy) * exy + (before.yz + s.yz) * eyz + (before.zx + s.zx) * ezx);
        const T one = 1.0 + 0.0 * p;
        flow.yielding = yields ? one : T(0.0 * one);
    }
};
using MohrCoulomb = MohrCoulombOf<double>;

}  // namespace undertow::fem
