#pragma once
// How a shell's section turns strains and curvatures into resultants.
//
// A section is a noun with a call operator, like a material: it updates what it keeps and gives
//   N [N/m] = int sigma dz,  M [N] = int sigma z dz,  xx, yy, xy along the element's axes.

#include "fem_solver/simd.hpp"

namespace undertow::fem {

template <class T>
struct Resultants {
    T N[3], M[3];
};

/// [N/m] work of a step per area
template <class T>
struct SectionWork {
    T total, plastic;
    // of plastic sections alone:
    T yielding;                     // 1 where a point flowed, else 0
    T membrane_left, bending_left;  // shares of the trial's resultants that the flow leaves
    T strength;                     // [Pa] present yield stress at the faces
};

/// Turns a plane tensor (xx, yy, xy) by a small angle [rad].
template <class T>
UNDERTOW_KERNEL void turn_in_plane(const T& angle, T (&s)[3]) {
    const T d = 2.0 * angle * s[2], e = angle * (s[0] - s[1]);
    s[0] -= d;
    s[1] += d;
    s[2] += e;
}

/// Plane stress, integrated through the thickness exactly: N = t C eps, M = t^3/12 C kappa.
struct ElasticSection {
    double thickness;      // [m]
    double plane_modulus;  // [Pa] E/(1 - nu^2)
    double poisson_ratio;

    static constexpr bool plastic = false;
    template <class T>
    using State = Resultants<T>;

    template <class T>
    UNDERTOW_KERNEL SectionWork<T> operator()(Resultants<T>& kept, const T& turn, const T (&eps)[3],
                                              const T (&kappa)[3], Resultants<T>& out) const {
        turn_in_plane(turn, kept.N);
        turn_in_plane(turn, kept.M);
        const double membrane = plane_modulus * thickness;
        const double bending = membrane * thickness * thickness / 12;
        const T work = add(membrane, eps, kept.N) + add(bending, kappa, kept.M);
        out = kept;
        SectionWork<T> report;  // of the rest nothing is read
        report.total = work;
        return report;
    }

 private:
    template <class T>
    UNDERTOW_KERNEL T add(double modulus, const T (&e)[3], T (&s)[3]) const {
        const T d[3] = {modulus * (e[0] + poisson_ratio * e[1]),
                        modulus * (e[1] + poisson_ratio * e[0]),
                        (0.5 * (1 - poisson_ratio) * modulus) * e[2]};
        const T work =
            (s[0] + 0.5 * d[0]) * e[0] + (s[1] + 0.5 * d[1]) * e[1] + (s[2] + 0.5 * d[2]) * e[2];
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) s[k] += d[k];
        return work;
    }
};

}  // namespace undertow::fem
