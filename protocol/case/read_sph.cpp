// [sph] with its fluids, fills, walls and gauges.

#include <algorithm>
#include <cmath>

#include "case/nearest.hpp"
#include "case/sections.hpp"
#include "case/sph_sections.hpp"

namespace undertow {

namespace {

void read_fluid(TableReader& reader, Fluid& fluid) {
    reader.require("name", "a word that fills refer to");
    reader.require("density", "the density in kg/m3 at zero pressure");
    reader.text("name", fluid.name);
    reader.number("density", fluid.density, positive("kg/m3"));
    reader.number("spacing", fluid.spacing, positive("m"));
    reader.number("viscosity", fluid.viscosity, at_least(0, "Pa s"));
    reader.number("yield_stress", fluid.yield_stress, at_least(0, "Pa"));
    reader.number("consistency", fluid.consistency, at_least(0, "Pa s^n"));
    reader.number("flow_index", fluid.flow_index, above_up_to(0, 3));
    reader.number("max_viscosity", fluid.max_viscosity, at_least(0, "Pa s"));
    reader.choice<EquationOfState>(
        "equation_of_state", fluid.equation_of_state,
        {{"us_up", EquationOfState::us_up}, {"tait", EquationOfState::tait}});
    if (reader.has_text("sound_speed")) {
        std::string automatic;
        reader.text("sound_speed", automatic);
        if (automatic != "auto")
            reader.reject("sound_speed",
                          "is not known: allowed are \"auto\" (ten times the largest expected "
                          "speed) or a speed > 0 m/s.");
    } else {
        double speed = 0;
        reader.number("sound_speed", speed, positive("m/s"));
        if (speed > 0) fluid.sound_speed = speed;
    }
    reader.number("hugoniot_slope", fluid.hugoniot_slope, at_least(0));
    reader.number("gruneisen", fluid.gruneisen, at_least(0));
    reader.number("tait_exponent", fluid.tait_exponent, above_up_to(0, 20));
}

void read_fill(TableReader& reader, Fill& fill, const SphSettings& sph, const CaseInfo& info) {
    reader.require("fluid", "the name of a [[sph.fluid]]");
    reader.require("box", "the box { min, max } to fill");
    std::vector<std::string> fluids;
    for (const Fluid& fluid : sph.fluid) fluids.push_back(fluid.name);
    reader.word("fluid", fill.fluid, fluids);
    reader.box("box", fill.box, axes_of(info));
    double spacing = sph.spacing;
    for (const Fluid& fluid : sph.fluid)
        if (fluid.name == fill.fluid && fluid.spacing > 0) spacing = fluid.spacing;
    require_one_spacing(reader, fill.box, spacing, info);
    require_whole_spacings(reader, fill.box, spacing, info);
    reader.polygon("profile", fill.profile);
    read_cylinder_or_stl(reader, fill.within, info);
    reader.vector("velocity", fill.velocity, fill.velocity_field, "xyz", "m/s");
    require_in_plane(reader, "velocity", fill.velocity, info);
    if (info.dimension == 2 && !fill.velocity_field.empty() && fill.velocity_field[1].text() != "0")
        reader.reject("velocity", "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
    reader.formula("pressure", fill.pressure, "xyz", "Pa");
    reader.number("ramp", fill.ramp, at_least(0, "s"));
    if (fill.ramp > 0 && !fill.velocity_field.empty())
        reader.reject("ramp", "is not allowed beside formulas: a block moves as one, give velocity "
                              "as three numbers.");
    double level = 0;
    reader.number("surface_level", level, any("m"));
    if (reader.has("surface_level")) fill.surface_level = level;
    if (fill.pressure && fill.surface_level)
        reader.reject("surface_level", "is one pressure too many: `pressure` gives it already.");
    if (!sph.domain || !reader.has("box")) return;
    for (const char axis : axes_of(info)) {
        const auto k = static_cast<std::size_t>(axis - 'x');
        if (fill.box.min[k] < sph.domain->min[k] || fill.box.max[k] > sph.domain->max[k])
            reader.reject("box", std::string("reaches out of sph.domain in ") + axis +
                                     ": particles there would be removed at once; enlarge "
                                     "sph.domain or shrink the box.");
    }
}

}  // namespace

void read_sph(TableReader& reader, SphSettings& sph, const CaseInfo& info) {
    sph.present = true;
    reader.require("spacing",
                   "the particle spacing in m, typically 1/20 of the smallest thickness");
    reader.require("fluid", "at least one [[sph.fluid]]");
    if (!reader.has("inflow")) reader.require("fill", "at least one [[sph.fill]]");
    reader.number("spacing", sph.spacing, positive("m"));
    reader.choice<Kernel>(
        "kernel", sph.kernel,
        {{"cubic_spline", Kernel::cubic_spline},
         {"wendland_c2", Kernel::wendland_c2},
         {"wendland_c4", Kernel::wendland_c4}});
    // In the plane 20 neighbors (1.2) do not hold a lattice; 45 cost a quarter more.
    if (info.dimension == 2) sph.smoothing_ratio = 1.5;
    reader.number("smoothing_ratio", sph.smoothing_ratio, closed(0.8, 3));
    reader.flag("variable_smoothing", sph.variable_smoothing);
    reader.number("density_diffusion", sph.density_diffusion, closed(0, 1));
    reader.number("artificial_viscosity", sph.artificial_viscosity, closed(0, 2));
    reader.choice<ViscositySolver>("viscosity_solver", sph.viscosity_solver,
                                   {{"auto", ViscositySolver::automatic},
                                    {"explicit", ViscositySolver::explicit_sums},
                                    {"implicit", ViscositySolver::implicit}});
    // Above a tenth the force that is left out is no longer small; below 1e-12 double ends it.
    reader.number("viscosity_tolerance", sph.viscosity_tolerance, closed(1e-12, 0.1));
    reader.choice<ViscousForm>(
        "viscous_form", sph.viscous_form,
        {{"laplacian", ViscousForm::laplacian}, {"strain", ViscousForm::strain}});
    reader.number("shifting", sph.shifting, closed(0, 30));
    reader.choice<TensionControl>("tension_control", sph.tension_control,
                                  {{"none", TensionControl::none},
                                   {"spray", TensionControl::spray},
                                   {"switched", TensionControl::switched}});
    reader.choice<Precision>("precision", sph.precision,
                             {{"float", Precision::float32}, {"double", Precision::float64}});
    if (sph.viscosity_tolerance < 1e-6 && sph.precision == Precision::float32)
        reader.reject("viscosity_tolerance",
                      "is less than float32 can solve for: at least 1e-6, or sph.precision = "
                      "\"double\".");
    reader.choice<FillLattice>("lattice", sph.lattice,
                               {{"square", FillLattice::square}, {"relaxed", FillLattice::relaxed}});
    reader.flag("gradient_correction", sph.gradient_correction);
    reader.flag("surface_images", sph.surface_images);
    reader.choice<Integrator>("integrator", sph.integrator,
                              {{"auto", Integrator::automatic},
                               {"one_pass", Integrator::one_pass},
                               {"two_pass", Integrator::two_pass}});
    // Up to the stability limit of the two-pass scheme, c0 dt/dx = 1.74, with h >= 0.8 dx.
    reader.number("cfl", sph.cfl, closed(0, 2));
    reader.number("force_cfl", sph.force_cfl, above_up_to(0, 1));
    reader.number("max_speed", sph.max_speed, at_least(0, "m/s"));
    Box domain;
    reader.box("domain", domain, axes_of(info));
    if (reader.has_table("domain")) sph.domain = domain;

    reader.tables("fluid",
                  [&](TableReader& entry) { read_fluid(entry, sph.fluid.emplace_back()); });
    reader.tables(
        "fill", [&](TableReader& entry) { read_fill(entry, sph.fill.emplace_back(), sph, info); });
    reader.tables("obstacle", [&](TableReader& entry) {
        read_obstacle(entry, sph.obstacle.emplace_back(), info);
    });
    reader.tables("plane",
                  [&](TableReader& entry) { read_plane(entry, sph.plane.emplace_back(), info); });
    if (reader.has("plate"))
        reader.reject("plate", "is not known: rigid bodies of any shape are [[sph.body]]; a plate "
                               "is one with a box, its other keys are the same.");
    reader.tables("body", [&](TableReader& entry) {
        read_body(entry, sph.body.emplace_back(), sph, info);
    });
    reader.tables("gauge", [&](TableReader& entry) {
        read_gauge(entry, sph.gauge.emplace_back(), sph, info);
    });
    read_sph_ends(reader, sph, info);
}

}  // namespace undertow
