#pragma once
// Viscosity of a viscoplastic fluid from its shear rate.

#include <algorithm>
#include <cmath>

namespace undertow::sph {

/// mu = mu_N + [tau_y (1 - exp(-m gd)) + K gd^n]/gd, at most mu_max  [Pa s]
/// Herschel & Bulkley (1926), the yield stress regularized as by Papanastasiou (1987). Power law and
/// Bingham are its special cases. m = mu_max/tau_y lets the yield part end at mu_max at rest: it
/// departs from tau_y/gd only where that would exceed a third of mu_max.
struct HerschelBulkley {
    double yield_stress = 0;   // tau_y [Pa]
    double consistency = 0;    // K [Pa s^n]
    double flow_index = 1;     // n
    double newtonian = 0;      // mu_N [Pa s]
    double max_viscosity = 0;  // mu_max [Pa s]

    /// gd [1/s] shear rate sqrt(2 D:D), >= 0; on float for the fast sums, on double for the reference.
    template <class Real>
    Real operator()(Real gd) const {
        const Real m = yield_stress > 0 ? Real(max_viscosity / yield_stress) : Real(0);
        const Real x = m * gd;
        // the exact limit, tau_y m, where the quotient would be 0/0
        const Real yield = x > Real(1e-4) ? Real(yield_stress) * -std::expm1(-x) / gd
                                          : Real(yield_stress) * m * (1 - Real(0.5) * x);
        // gd^(n-1): infinite at rest for n < 1, 1 for n = 1, 0 for n > 1
        const Real flow =
            consistency > 0 ? Real(consistency) * std::pow(gd, Real(flow_index) - 1) : Real(0);
        return std::min(Real(newtonian) + yield + flow, Real(max_viscosity));
    }
};

}  // namespace undertow::sph
