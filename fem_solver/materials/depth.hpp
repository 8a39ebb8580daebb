#pragma once
// Strength that grows with depth, and stiffness with it, as in clay that its own weight has
// consolidated.
//
//     s(z) = s_0 + k max(0, level - z)   [Pa]      E(z) = (E/s) s(z), or one E for all
//
// z [m] is the height of the undeformed place: the strength travels with the material. s is s_u of
// Tresca, the cohesion c of Mohr-Coulomb.

#include <algorithm>
#include <cmath>

#include "fem_solver/materials/mohr_coulomb.hpp"
#include "fem_solver/materials/tresca.hpp"

namespace undertow::fem {

inline Tresca with_strength(Tresca law, double s) {
    law.shear_strength = s;
    return law;
}
/// `law.tension` is the cut-off; the tip of the cone lies at c cot phi.
inline MohrCoulomb with_strength(MohrCoulomb law, double c) {
    law.cohesion = c * std::sqrt(1 - law.sin_friction * law.sin_friction);
    if (law.sin_friction > 0) law.tension = std::min(law.tension, law.cohesion / law.sin_friction);
    return law;
}

template <class Law>
struct WithDepth {
    Law form;              // its constants, but for the strength
    double strength;       // [Pa] s_0
    double gradient;       // [Pa/m] k
    double level;          // [m]
    double modulus_ratio;  // E/s; 0: E is that of `form` everywhere

    static constexpr bool plastic = Law::plastic, hardens = Law::hardens;
    /// Stiffness differs from element to element, so that one change of volume does not give one
    /// mean stress.
    static constexpr bool dilates = true;

    double strength_at(double z) const { return strength + gradient * std::max(0.0, level - z); }
    Law at(double z) const {
        const double s = strength_at(z);
        Law law = with_strength(form, s);
        if (modulus_ratio > 0)
            law.elastic =
                LinearElastic::from_young(modulus_ratio * s, form.elastic.poisson_ratio());
        return law;
    }
};

}  // namespace undertow::fem
