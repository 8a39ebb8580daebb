#pragma once
// Shear stress of a no-slip wall on the particles next to it.

#include <cmath>

namespace undertow::sph {

/// Law of the wall in the closed form of Werner & Wengle (1991): u+ = z+ up to z+ = 11.81, then
/// u+ = 8.3 (z+)^(1/7), with u+ = u/u_tau, z+ = z u_tau/nu, tau = rho u_tau^2. Resolved laminar layers
/// get tau = mu u/z; a particle far larger than the layer (water at 1 m/s and a spacing of 10 mm:
/// z+ = 250) gets the turbulent stress, without a constant to tune.
struct LawOfTheWall {
    double rho;   // [kg/m3]
    double mu;    // [Pa s]

    /// u+ = z+ <= 11.81
    bool laminar(double u, double z) const { return u * z * rho <= 11.81 * 11.81 * mu; }

    /// Stress at distance z [m] from the wall, for the speed u [m/s] along it.  [Pa]
    double operator()(double u, double z) const {
        if (laminar(u, z)) return mu * u / z;
        const double a = u / 8.3, b = mu / (rho * z);
        const double root = std::sqrt(a);
        return rho * a * root * std::sqrt(root) * std::sqrt(std::sqrt(b));   // rho a^(7/4) b^(1/4)
    }
};

}  // namespace undertow::sph
