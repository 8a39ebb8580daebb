#pragma once
// Pressure from density, and back for the hydrostatic start.

#include <cmath>

namespace undertow::sph {

/// Us-Up Mie-Grueneisen, linear Hugoniot Us = c0 + s Up.  [Wang 2024, Eq. 7]
/// p = rho0 c0^2 eta/(1 - s eta)^2 (1 - Gamma0 eta/2) + Gamma0 rho0 E,  eta = 1 - rho0/rho  [Pa]
struct MieGrueneisen {
    double rho0;     // [kg/m3]
    double c0;       // [m/s]
    double s;        // [-]
    double gamma0;   // [-]

    double operator()(double drho, double energy) const {
        const double eta = drho / (rho0 + drho);
        if (s == 0 && gamma0 == 0) return rho0 * c0 * c0 * eta;   // the usual water
        const double d = 1 - s * eta;
        return rho0 * c0 * c0 * eta / (d * d) * (1 - 0.5 * gamma0 * eta) + gamma0 * rho0 * energy;
    }
};

/// Tait.  p = rho0 c0^2/g [(rho/rho0)^g - 1]  [Pa]
struct Tait {
    double rho0;       // [kg/m3]
    double c0;         // [m/s]
    double exponent;   // [-]

    double operator()(double drho, double) const {
        return rho0 * c0 * c0 / exponent * std::expm1(exponent * std::log1p(drho / rho0));
    }
};

/// Density deviation that gives pressure p at zero energy, by Newton's method [kg/m3].
template <class Law>
double density_deviation(const Law& law, double p) {
    double drho = p / (law.c0 * law.c0);
    for (int k = 0; k < 20; ++k) {
        const double step = 1e-6 * law.rho0;
        const double slope = (law(drho + step, 0) - law(drho - step, 0)) / (2 * step);
        const double correction = (p - law(drho, 0)) / slope;
        drho += correction;
        if (std::abs(correction) < 1e-14 * law.rho0) break;
    }
    return drho;
}

}  // namespace undertow::sph
