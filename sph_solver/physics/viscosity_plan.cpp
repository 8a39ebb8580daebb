#include "sph_solver/physics/viscosity_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sph_solver/physics/stable_step.hpp"
#include "sph_solver/physics/wall_friction.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

double speed_of_flow(const Case& input, double c0) {
    const Vec3& g = input.info.gravity;
    bool moves = input.sph.max_speed > 0 || g[0] != 0 || g[1] != 0 || g[2] != 0;
    for (const Fill& f : input.sph.fill)
        moves = moves || f.velocity[0] != 0 || f.velocity[1] != 0 || f.velocity[2] != 0;
    return moves ? expected_speed(input) : 0.1 * c0;
}

/// Chooses the cap of the viscosity where the case leaves it open, and checks one that is given.
void cap_viscosity(const Case& input, const Fluid& f, double free, double wanted, bool implicit,
                   FluidLaw& law) {
    double& cap = law.rheology.max_viscosity;
    const double open = implicit ? std::max(wanted, 2 * law.mu) : free;
    if (cap == 0 && law.mu >= open)
        throw InputError(fmt::format(
            "{}: sph.fluid \"{}\": viscosity = {:.4g} Pa s alone shortens the step, so there is no "
            "max_viscosity that does not (the limit is {:.4g} Pa s); give max_viscosity, above "
            "viscosity, or sph.viscosity_solver = \"implicit\".",
            input.file, f.name, law.mu, free));
    if (cap == 0) cap = open;
    if (cap <= law.mu)
        throw InputError(fmt::format(
            "{}: sph.fluid \"{}\": max_viscosity = {:.4g} Pa s must be > viscosity = {:.4g} Pa s; "
            "leave it out for {:.4g} Pa s, {}.",
            input.file, f.name, cap, law.mu, open,
            implicit ? "which creeps at a thousandth of the flow's shear rate"
                     : "the largest that does not shorten the step"));
}

}  // namespace

double shear_rate_of_flow(const Case& input, double c0) {
    double low = 1e300, high = -1e300;
    for (const Fill& f : input.sph.fill) {
        low = std::min(low, f.box.min[2]);
        high = std::max(high, f.surface_level.value_or(f.box.max[2]));
    }
    return speed_of_flow(input, c0) / std::max(high - low, input.sph.spacing);
}

bool plan_viscosity(const Case& input, double c0, std::vector<FluidLaw>& laws) {
    const double slow = creep_share * shear_rate_of_flow(input, c0);
    std::vector<double> wanted;
    double ratio = 0;  // of the acoustic step to the viscous one
    for (std::size_t k = 0; k < laws.size(); ++k) {
        const FluidLaw& law = laws[k];
        HerschelBulkley exact = law.rheology;
        exact.max_viscosity = 1e300;
        const double free = largest_free_viscosity(input.sph, law.rho0, c0);
        wanted.push_back(law.viscoplastic() ? std::max(free, exact(slow)) : law.mu);
        const double given = input.sph.fluid[k].max_viscosity;
        ratio = std::max(ratio, (law.viscoplastic() && given > 0 ? given : wanted[k]) / free);
    }
    const ViscositySolver choice = input.sph.viscosity_solver;
    // the implicit update knows one smoothing length only
    const bool sized = input.sph.variable_smoothing ||
                       std::any_of(laws.begin(), laws.end(), [&](const FluidLaw& law) {
                           return law.spacing != input.sph.spacing;
                       });
    const bool implicit =
        choice == ViscositySolver::implicit ||
        (choice == ViscositySolver::automatic && !sized && ratio > implicit_from);
    const double speed = speed_of_flow(input, c0);
    for (std::size_t k = 0; k < laws.size(); ++k) {
        FluidLaw& law = laws[k];
        const double first = 0.5 * law.spacing;
        if (law.viscoplastic())
            cap_viscosity(input, input.sph.fluid[k],
                          largest_free_viscosity(input.sph, law.rho0, c0), wanted[k], implicit,
                          law);
        const double mu = law.viscoplastic() ? law.rheology(speed / first) : law.mu;
        law.resolves_walls = LawOfTheWall{law.rho0, mu}.laminar(speed, first);
    }
    return implicit;
}

Creep creep_of(const FluidLaw& law, int fluid, const Particles& particles) {
    Creep creep;
    const HerschelBulkley& r = law.rheology;
    creep.at_yield = 0.5 * r.yield_stress / r.max_viscosity;
    double all = 0, stiff = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
        if (particles.fluid[i] != fluid) continue;
        const double volume =
            1 / (law.rho0 + particles.drho[i]);  // times the mass, the same for all
        all += volume;
        if (!(particles.viscosity[i] > 0.5 * r.max_viscosity)) continue;
        stiff += volume;
        creep.rate = std::max(creep.rate, double(particles.shear_rate[i]));
    }
    creep.share_at_cap = all > 0 ? stiff / all : 0;
    return creep;
}

}  // namespace undertow::sph
