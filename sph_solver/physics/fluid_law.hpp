#pragma once
// The constants of each fluid, resolved from the case.

#include <vector>

#include "case/case.hpp"
#include "sph_solver/physics/equation_of_state.hpp"
#include "sph_solver/physics/herschel_bulkley.hpp"

namespace undertow::sph {

struct FluidLaw {
    double rho0 = 1000;  // [kg/m3]
    double c0 = 1;       // [m/s]
    double mu = 0;       // [Pa s] Newtonian; of a viscoplastic fluid its Newtonian part
    double spacing = 0;  // dx of its particles [m]
    double h = 0;        // their smoothing length at rho0 [m]
    double volume = 0;   // of a particle at rho0 [m^d]
    double mass = 0;     // of a particle, true mass also in 2D [kg]
    EquationOfState equation_of_state = EquationOfState::us_up;
    MieGrueneisen us_up{};
    Tait tait{};
    HerschelBulkley rheology{};
    bool resolves_walls = false;   // the layer at a no-slip wall is laminar at the first particle,
                                   // see plan_viscosity

    double pressure(double drho, double energy) const {
        return equation_of_state == EquationOfState::us_up ? us_up(drho, energy)
                                                           : tait(drho, energy);
    }
    /// Internal energy gained while the density deviation rises by `step`: -p dV by the trapezoidal
    /// rule, the pressure at the end by the energy that the pressure p of the start gives.  [J/kg]
    double compression_work(double p, double drho, double energy, double step) const {
        const double volumes = step / ((rho0 + drho) * (rho0 + drho + step));   // [m3/kg]
        const double p_end = pressure(drho + step, energy + p * volumes);
        return 0.5 * (p + p_end) * volumes;
    }
    double deviation_at(double p) const {
        return equation_of_state == EquationOfState::us_up ? density_deviation(us_up, p)
                                                           : density_deviation(tait, p);
    }
    bool viscoplastic() const { return rheology.yield_stress > 0 || rheology.consistency > 0; }
    /// Viscosity at rest: the largest there is.  [Pa s]
    double viscosity_at_rest() const { return viscoplastic() ? rheology(0.0) : mu; }
};

/// Largest expected speed [m/s]: sph.max_speed, or 2 sqrt(g H) of the fills' total height plus the
/// largest initial speed (the tip of a dam break on a dry bed, Ritter 1892).
double expected_speed(const Case& input);

/// Constants of all fluids, in the order of [[sph.fluid]], but for what plan_viscosity settles; throws InputError when there is none, or
/// more than the packed records can tell apart.
std::vector<FluidLaw> resolve_fluids(const Case& input);

}  // namespace undertow::sph
