#include "sph_solver/physics/resolve_physics.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "sph_solver/boundary/periodic.hpp"
#include "sph_solver/kernels/lattice_moment.hpp"
#include "sph_solver/kernels/strain_weight.hpp"
#include "sph_solver/physics/viscosity_plan.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

/// What knows one smoothing length only is not offered together with several.
void refuse_with_sizes(const Case& input, const PairPhysics& p) {
    const char* sizes = p.variable_smoothing ? "sph.variable_smoothing = true"
                                             : "a sph.fluid.spacing other than sph.spacing";
    const auto refuse = [&](const std::string& key, const char* instead) {
        throw InputError(fmt::format(
            "{}: {} does not go together with {}: it knows particles of one smoothing length "
            "only. {}", input.file, key, sizes, instead));
    };
    if (p.shifting > 0) refuse("sph.shifting", "Set sph.shifting = 0.");
    if (p.gradient_correction)
        refuse("sph.gradient_correction", "Set sph.gradient_correction = false.");
    if (p.implicit_viscosity)
        refuse("The implicit viscosity (sph.viscosity_solver)",
               "Set sph.viscosity_solver = \"explicit\", or lower the viscosity.");
    if (!input.sph.inflow.empty() || !input.sph.outflow.empty())
        refuse("An opening (sph.inflow, sph.outflow)", "Give all fluids the same spacing.");
    if (input.sph.lattice == FillLattice::relaxed)
        refuse("sph.lattice = \"relaxed\"", "Set sph.lattice = \"square\".");
    const bool resolved = std::any_of(p.fluids.begin(), p.fluids.end(),
                                      [](const FluidLaw& f) { return f.resolves_walls; });
    for (const PlaneWall& plane : input.sph.plane)
        if (resolved && plane.slip == Slip::no_slip)
            refuse("slip = \"no_slip\" of sph.plane \"" + plane.name +
                       "\" next to a fluid so viscous that the wall layer is resolved",
                   "Set slip = \"free\" or a lower viscosity.");
}

}  // namespace

PairPhysics resolve_physics(const Case& input) {
    PairPhysics p;
    p.kernel = input.sph.kernel;
    p.precision = input.sph.precision;
    p.h = input.sph.smoothing_ratio * input.sph.spacing;
    p.dimension = input.info.dimension;
    p.artificial_viscosity = input.sph.artificial_viscosity;
    p.density_diffusion = input.sph.density_diffusion;
    p.variable_smoothing = input.sph.variable_smoothing;
    p.gravity = balanced_gravity(input);
    p.shifting = input.sph.shifting;
    p.gradient_correction = input.sph.gradient_correction;
    p.tension_control = input.sph.tension_control;
    p.fluids = resolve_fluids(input);
    double c0 = 0;
    for (const FluidLaw& f : p.fluids) c0 = std::max(c0, f.c0);
    p.implicit_viscosity = plan_viscosity(input, c0, p.fluids);
    p.lattice_moment =
        lattice_moment(input.sph.kernel, p.h, input.sph.spacing, input.info.dimension);
    p.viscous_form = input.sph.viscous_form;
    p.strain_weight =
        strain_weight(input.sph.kernel, p.h, input.sph.spacing, input.info.dimension);
    if (p.sized()) refuse_with_sizes(input, p);
    return p;
}

}  // namespace undertow::sph
