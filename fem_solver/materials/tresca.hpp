#pragma once
// Tresca: linear elastic until the largest shear stress reaches s_u, then plastic at that shear.
// The undrained strength of clay; at a friction angle of zero Mohr-Coulomb is the same.

#include "fem_solver/materials/plastic_flow.hpp"
#include "fem_solver/materials/principal.hpp"

namespace undertow::fem {

/// f = s1 - s3 - 2 s_u <= 0 with s1 >= s2 >= s3 the principal stresses; associated flow.   [Pa]
///
/// An isotropic elastic trial stress returns to the closest point of the hexagon in the deviatoric
/// plane; the mean stress stays. With the signs turned so that the middle principal value lies
/// nearer to the first (J3 <= 0), face and edge are one formula in the principal deviators d:
///   t2 = min(d2, 2 s_u/3),   t1 = s_u - t2/2,   t3 = -s_u - t2/2
/// (on a face d2 stays; on the edge t1 = t2). The tensor follows without eigenvectors as the
/// quadratic polynomial of the trial deviator that takes d to t.
///   [return: de Souza Neto, Peric, Owen 2008, ch. 8; Clausen, Damkilde, Andersen 2006]
template <class M>
struct TrescaOf {
    LinearElasticOf<M> elastic;
    M shear_strength;  // [Pa] s_u

    static constexpr bool plastic = true, hardens = false, dilates = false;

    /// Bounds hourglass stresses.   [Pa]
    template <class T>
    UNDERTOW_KERNEL M shear_limit(const Symmetric<T>& /*stress*/, const T& /*eps_p*/) const {
        return shear_strength;
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
        const M su2 = shear_strength * shear_strength;
        flow.strain = flow.work = flow.yielding = 0.0 * J2;
        flow.trial_J2 = J2;
        // the largest shear is at most sqrt(J2): most batches end here
        if (any(J2 > su2)) flow_back(before, p, J2, s, flow);
    }

 private:
    /// Returns the lanes that yield; `s` holds the trial stress, p its mean.
    template <class T>
    UNDERTOW_KERNEL void flow_back(const Symmetric<T>& before, const T& p, const T& trial_J2,
                                   Symmetric<T>& s, PlasticFlow<T>& flow) const {
        const M su = shear_strength;
        const T a = s.xx - p, b = s.yy - p, c = s.zz - p;
        const T J3 = a * (b * c - s.yz * s.yz) - s.xy * (s.xy * c - s.yz * s.zx) +
                     s.zx * (s.xy * s.yz - b * s.zx);
        const T one = 1.0 + 0.0 * J3;
        const T sign = J3 > 0.0 ? -one : one;
        const Symmetric<T> D{sign * a, sign * b, sign * c, sign * s.xy, sign * s.yz, sign * s.zx};
        const T J2 = larger(trial_J2, T(su * su * one));  // lanes below that do not yield
        const T root = square_root(J2);
        const T x = root * isolated_root(smaller(T(magnitude(J3) / (J2 * root)), T(largest_isolated_r * one)));
        // d3 = -x, d1 + d2 = x, d1 d2 = x^2 - J2
        const T delta = square_root(larger(T(J2 - 0.75 * x * x), T(0.0 * one)));
        const T d2 = 0.5 * x - delta;
        const auto yields = 1.5 * x + delta > 2 * su;

        const T t2 = smaller(d2, T((2.0 / 3 * su) * one));
        const T t1_t2 = su - 1.5 * t2, t3 = -su - 0.5 * t2;
        // slope between the near pair: 0 on the edge, at most 1; where d1 = d2 it has no effect
        const T m = smaller(T(t1_t2 / larger(T(2.0 * delta), T((1e-14 * su) * one))), one);
        const T k = (t3 - t2 + m * (x + d2)) / (3.0 * x * x - J2);
        // T = t2 + m (D - d2) + k (D - d1)(D - d2)
        const T c0 = t2 - m * d2 + k * (x * x - J2), c1 = m - k * x;
        const T DD_xx = D.xx * D.xx + D.xy * D.xy + D.zx * D.zx;
        const T DD_yy = D.xy * D.xy + D.yy * D.yy + D.yz * D.yz;
        const T DD_zz = D.zx * D.zx + D.yz * D.yz + D.zz * D.zz;
        const T DD_xy = D.xx * D.xy + D.xy * D.yy + D.zx * D.yz;
        const T DD_yz = D.xy * D.zx + D.yy * D.yz + D.yz * D.zz;
        const T DD_zx = D.xx * D.zx + D.xy * D.yz + D.zx * D.zz;
        const Symmetric<T> trial = s;
        s.xx = yields ? T(p + sign * (c0 + c1 * D.xx + k * DD_xx)) : trial.xx;
        s.yy = yields ? T(p + sign * (c0 + c1 * D.yy + k * DD_yy)) : trial.yy;
        s.zz = yields ? T(p + sign * (c0 + c1 * D.zz + k * DD_zz)) : trial.zz;
        s.xy = yields ? T(sign * (c1 * D.xy + k * DD_xy)) : trial.xy;
        s.yz = yields ? T(sign * (c1 * D.yz + k * DD_yz)) : trial.yz;
        s.zx = yields ? T(sign * (c1 * D.zx + k * DD_zx)) : trial.zx;

        const M compliance = 0.5 / elastic.mu;  // the drop is deviatoric: d_eps_p = drop/2 mu
        const T exx = compliance * (trial.xx - s.xx), eyy = compliance * (trial.yy - s.yy),
                ezz = compliance * (trial.zz - s.zz), exy = compliance * (trial.xy - s.xy),
                eyz = compliance * (trial.yz - s.yz), ezx = compliance * (trial.zx - s.zx);
        flow.strain = square_root(T((2.0 / 3) * (exx * exx + eyy * eyy + ezz * ezz) +
                                    (4.0 / 3) * (exy * exy + eyz * eyz + ezx * ezx)));
        flow.work =
            0.5 * ((before.xx + s.xx) * exx + (before.yy + s.yy) * eyy + (before.zz + s.zz) * ezz) +
            ((before.xy + s.xy) * exy + (before.yz + s.yz) * eyz + (before.zx + s.zx) * ezx);
        flow.yielding = yields ? one : T(0.0 * one);
    }
};
using Tresca = TrescaOf<double>;

}  // namespace undertow::fem
