#pragma once
// What elements of any shape have in common: the figures of their part, what they report of a step,
// bulk viscosity.

#include "fem_solver/simd.hpp"

namespace undertow::fem {

/// Scalars that all elements of a part share.
struct ElementLaw {
    double inverse_density;  // [m3/kg] of the undeformed material
    double lambda, mu;       // [Pa] moduli of the eigenvalue bound
    double sound_speed;      // [m/s] sqrt((lambda + 2 mu)/rho)
    double bending_modulus;  // [Pa] E/(1 - nu^2): plane stress, = 2 mu/(1 - nu)
    double poisson_ratio;
    double young_modulus;             // [Pa]
    double bulk_viscosity_linear;     // b1
    double bulk_viscosity_quadratic;  // b2
};

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
template <class T>
UNDERTOW_KERNEL T bulk_viscosity(const ElementLaw& law, const T& density, const T& closing) {
    const T squeeze = law.bulk_viscosity_quadratic * larger(closing, T(closing * 0.0));
    return -density * (law.bulk_viscosity_linear * law.sound_speed * closing + squeeze * squeeze);
}

}  // namespace undertow::fem
