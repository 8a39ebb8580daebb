#include "sph_solver/physics/equation_of_state.hpp"

#include <catch2/catch.hpp>

#include "sph_solver/physics/stable_step.hpp"
#include "sph_solver/physics/wall_friction.hpp"

using namespace undertow;
using namespace undertow::sph;

TEST_CASE("Us-Up pressure satisfies the jump conditions on its Hugoniot") {
    // Behind a shock of particle speed up: Us = c0 + s up, eta = up/Us, p = rho0 Us up; the energy
    // p eta/(2 rho0) makes the Gamma0 terms cancel exactly.
    const MieGrueneisen water{1000, 1450, 1.92, 0.28};
    for (const double up : {1.0, 50.0, 400.0}) {
        const double us = water.c0 + water.s * up, eta = up / us;
        const double drho = water.rho0 * eta / (1 - eta);
        const double p = water.rho0 * us * up;
        CHECK(water(drho, p * eta / (2 * water.rho0)) == Approx(p).epsilon(1e-12));
    }
}

TEST_CASE("the density deviation of a pressure gives that pressure back") {
    const MieGrueneisen us_up{997, 34.3, 0, 0};
    const Tait tait{1000, 40, 7};
    for (const double p : {-50.0, 0.0, 10.0, 3000.0}) {
        CHECK(us_up(density_deviation(us_up, p), 0) == Approx(p).epsilon(1e-10).margin(1e-9));
        CHECK(tait(density_deviation(tait, p), 0) == Approx(p).epsilon(1e-10).margin(1e-9));
    }
}

TEST_CASE("both laws have the sound speed they were given") {
    const MieGrueneisen us_up{1000, 40, 1.5, 0};
    const Tait tait{1000, 40, 7};
    const double d = 1e-4;
    CHECK((us_up(d, 0) - us_up(-d, 0)) / (2 * d) == Approx(1600).epsilon(1e-6));
    CHECK((tait(d, 0) - tait(-d, 0)) / (2 * d) == Approx(1600).epsilon(1e-6));
}

TEST_CASE("the stable step names the strictest of sound, force and viscosity") {
    const double h = 0.012, c0 = 34, nu = 1e-6;
    CHECK(std::string(stable_step({h, c0, 0, 0, nu}, 1, 0.25).limiter) == "sound");
    CHECK(stable_step({h, c0, 6, 0, nu}, 1, 0.25).dt == Approx(0.012 / 40));
    CHECK(std::string(stable_step({h, c0, 0, 1e6, nu}, 1, 0.25).limiter) == "force");
    CHECK(stable_step({h, c0, 0, 1e6, nu}, 1, 0.25).dt == Approx(0.25 * std::sqrt(0.012 / 1e6)));
    CHECK(std::string(stable_step({h, c0, 0, 0, 1}, 1, 0.25).limiter) == "viscosity");
    CHECK(stable_step({h, c0, 0, 0, 1}, 1, 0.25).dt == Approx(h * h / 8));
}

TEST_CASE("the law of the wall is laminar close to the wall, turbulent far from it, and continuous") {
    const LawOfTheWall water{1000, 1e-3};
    CHECK(water(0.01, 1e-3) == Approx(1e-3 * 0.01 / 1e-3));
    // z+ = u+ = 11.81 is where the branches meet: the power law gives 8.3 * 11.81^(1/7) = 11.81
    const double z = 1e-3, u = 11.81 * 11.81 * 1e-3 / (1000 * z);
    CHECK(water(u * 1.0001, z) == Approx(water(u * 0.9999, z)).epsilon(2e-3));
    // the logarithmic law u+ = ln(z+)/0.41 + 5.2 solved for u = 2.5 m/s at 5 mm: tau = 14.4 Pa; the
    // power law follows it within 5 % in this range (Werner & Wengle 1991)
    CHECK(water(2.5, 5e-3) == Approx(14.4).epsilon(0.05));
}
