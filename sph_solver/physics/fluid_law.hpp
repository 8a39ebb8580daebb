#pragma once
// The constants of one fluid, resolved from the case.

#include "case/case.hpp"
#include "sph_solver/physics/equation_of_state.hpp"

namespace undertow::sph {

struct FluidLaw {
    double rho0 = 1000;      // [kg/m3]
    double c0 = 1;           // [m/s]
    double mu = 0;           // [Pa s]
    double volume = 0;       // of a particle at rho0 [m^d]
    double mass = 0;         // of a particle, true mass also in 2D [kg]
    EquationOfState equation_of_state = EquationOfState::us_up;
    MieGrueneisen us_up{};
    Tait tait{};

    double pressure(double drho, double energy) const {
        return equation_of_state == EquationOfState::us_up ? us_up(drho, energy)
                                                           : tait(drho, energy);
    }
    double deviation_at(double p) const {
        return equation_of_state == EquationOfState::us_up ? density_deviation(us_up, p)
                                                           : density_deviation(tait, p);
    }
};

}  // namespace undertow::sph
