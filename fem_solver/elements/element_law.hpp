#pragma once
// What elements of any shape have in common: the figures of their part, what they report of a step,
// bulk viscosity.

#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// Figures that all elements of a part share; M is Lanes where moduli differ from one to the next.
template <class M>
struct ElementLawOf {
    double inverse_density;  // [m3/kg] of the undeformed material
    M lambda, mu;            // [Pa] moduli of the eigenvalue bound
    M sound_speed;           // [m/s] sqrt((lambda + 2 mu)/rho)
    M bending_modulus;       // [Pa] E/(1 - nu^2): plane stress, = 2 mu/(1 - nu)
    double poisson_ratio;
    M young_modulus;                  // [Pa]
    double bulk_viscosity_linear;     // b1
    double bulk_viscosity_quadratic;  // b2
};
using ElementLaw = ElementLawOf<double>;

/// What an element reports of a step: energies to be summed, health figures to be reduced.
template <class T>
struct ElementReport {
    T strain_work;      // [J] of the step
    T hourglass_work;   // [J] of the step
    T viscous_work;     // [J] of the step
    T omega2;           // [1/s2] bound on the largest eigenvalue
    T relative_volume;  // V/V0; <= 0 is an inverted element
    T compression;      // -length tr(D)/c, Mach number of closing: enters the viscosity's limit
    // of plastic materials alone:
    T plastic_work;  // [J] of the step, a part of strain_work
    T yielding;      // 1 where the stress flowed, else 0
};

/// q = rho ( b1 c l tr(D) - (b2 l tr(D))^2 when compressed )   [Pa], tension positive; `closing`
/// = -l tr(D) [m/s]
template <class T, class M>
UNDERTOW_KERNEL T bulk_viscosity(const ElementLawOf<M>& law, const T& density, const T& closing) {
    const T squeeze = law.bulk_viscosity_quadratic * larger(closing, T(closing * 0.0));
    return -density * (law.bulk_viscosity_linear * law.sound_speed * closing + squeeze * squeeze);
}

}  // namespace undertow::fem
