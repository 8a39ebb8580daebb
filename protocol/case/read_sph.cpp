// [sph] with its fluids, fills, walls and gauges.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "case/nearest.hpp"
#include "case/sections.hpp"

namespace undertow {

namespace {

const std::vector<std::pair<std::string, Slip>> slip_names{
    {"free", Slip::free_slip}, {"free_slip", Slip::free_slip}, {"no_slip", Slip::no_slip}};

/// The axes in which a box has an extent that matters.
std::string axes_of(const CaseInfo& info) {
    return info.dimension == 2 ? "xz" : "xyz";
}

void require_in_plane(TableReader& reader, const char* key, const Vec3& v, const CaseInfo& info) {
    if (info.dimension == 2 && v[1] != 0)
        reader.reject(key, "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
}

/// A box must hold at least one particle across; round-off of decimal numbers is forgiven.
void require_one_spacing(TableReader& reader, const Box& box, double spacing,
                         const CaseInfo& info) {
    if (!reader.has("box") || spacing <= 0) return;
    for (const char axis : axes_of(info)) {
        const auto k = static_cast<std::size_t>(axis - 'x');
        const double extent = box.max[k] - box.min[k];
        if (extent >= spacing * (1 - 1e-9)) continue;
        char text[160];
        std::snprintf(
            text, sizeof text,
            "is %.6g m thin in %c: it must be at least one spacing, sph.spacing = %.6g m; "
            "use a finer spacing or a thicker box.",
            extent, axis, spacing);
        reader.reject("box", text);
    }
}

void read_fluid(TableReader& reader, Fluid& fluid) {
    reader.require("name", "a word that fills refer to");
    reader.require("density", "the density in kg/m3 at zero pressure");
    reader.text("name", fluid.name);
    reader.number("density", fluid.density, positive("kg/m3"));
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
    require_one_spacing(reader, fill.box, sph.spacing, info);
    reader.polygon("profile", fill.profile);
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

void read_obstacle(TableReader& reader, Obstacle& obstacle, const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.text("name", obstacle.name);
    Box box;
    reader.box("box", box, axes_of(info));
    if (reader.has_table("box")) {
        obstacle.box = box;
    } else {
        reader.require("from", "one end [x, y, z] of a cylinder's axis, or a box { min, max }");
        reader.require("to", "the other end of the axis");
        reader.require("radius", "the cylinder's radius in m");
    }
    reader.vector("from", obstacle.from, "m");
    reader.vector("to", obstacle.to, "m");
    reader.number("radius", obstacle.radius, positive("m"));
    if (obstacle.box && (reader.has("from") || reader.has("to") || reader.has("radius")))
        reader.reject("box", "is one shape too many: from, to and radius give a cylinder.");
    if (reader.has("from") && obstacle.from == obstacle.to)
        reader.reject("to", "is not allowed: the axis has no length.");
}

void read_plane(TableReader& reader, PlaneWall& plane, const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.require("point", "a point [x, y, z] of the plane");
    reader.require("normal", "the direction [x, y, z] that points into the fluid");
    reader.text("name", plane.name);
    reader.vector("point", plane.point, "m");
    reader.direction("normal", plane.normal);
    require_in_plane(reader, "normal", plane.normal, info);
    auto names = slip_names;   // a plane of symmetry is a mirror without friction
    names.emplace_back("symmetry", Slip::free_slip);
    reader.choice<Slip>("slip", plane.slip, names);
    std::string slip;
    reader.text("slip", slip);
    plane.symmetry = slip == "symmetry";
    reader.vector("velocity", plane.velocity, "m/s");
    require_in_plane(reader, "velocity", plane.velocity, info);
    if (!reader.has("velocity")) return;
    const Vec3 &n = plane.normal, &v = plane.velocity;
    const double across = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    if (std::abs(across) > 1e-9 * std::hypot(n[0], n[1], n[2]) * std::hypot(v[0], v[1], v[2]))
        reader.reject("velocity",
                      "is not allowed: a plane moves only along itself; a wall that pushes is an "
                      "[[sph.plate]].");
    if (plane.slip != Slip::no_slip)
        reader.reject("velocity", "has no effect on a free-slip plane: set slip = \"no_slip\".");
}

void read_plate(TableReader& reader, PlateWall& plate, const SphSettings& sph,
                const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.require("box", "the box { min, max } of the plate");
    reader.text("name", plate.name);
    reader.box("box", plate.box, axes_of(info));
    require_one_spacing(reader, plate.box, sph.spacing, info);
    reader.vector("velocity", plate.velocity, "m/s");
    require_in_plane(reader, "velocity", plate.velocity, info);
    reader.number("start", plate.start, at_least(0, "s"));
    Range stop = at_least(0, "s");
    stop.infinite = true;
    reader.number("stop", plate.stop, stop);
    if (plate.stop < plate.start)
        reader.reject("stop", "is not allowed: the motion must not end before it starts.");
    reader.choice<Slip>("slip", plate.slip, slip_names);
}

void read_gauge(TableReader& reader, SphGauge& gauge) {
    reader.require("name", "a word for the column of gauges.csv");
    reader.require("kind", "one of front, pressure, water_level");
    reader.text("name", gauge.name);
    reader.choice<SphGaugeKind>("kind", gauge.kind,
                                {{"front", SphGaugeKind::front},
                                 {"pressure", SphGaugeKind::pressure},
                                 {"water_level", SphGaugeKind::water_level}});
    if (gauge.kind != SphGaugeKind::front) reader.require("point", "where it measures, [x, y, z]");
    reader.vector("point", gauge.point, "m");
    reader.direction("direction", gauge.direction);
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
    reader.number("smoothing_ratio", sph.smoothing_ratio, closed(0.8, 3));
    reader.number("density_diffusion", sph.density_diffusion, closed(0, 1));
    reader.number("artificial_viscosity", sph.artificial_viscosity, closed(0, 2));
    reader.choice<ViscositySolver>("viscosity_solver", sph.viscosity_solver,
                                   {{"auto", ViscositySolver::automatic},
                                    {"explicit", ViscositySolver::explicit_sums},
                                    {"implicit", ViscositySolver::implicit}});
    // Above a tenth the force that is left out is no longer small; below 1e-6 float32 ends it.
    reader.number("viscosity_tolerance", sph.viscosity_tolerance, closed(1e-6, 0.1));
    reader.choice<ViscousForm>(
        "viscous_form", sph.viscous_form,
        {{"laplacian", ViscousForm::laplacian}, {"strain", ViscousForm::strain}});
    reader.number("shifting", sph.shifting, closed(0, 30));
    reader.choice<TensionControl>("tension_control", sph.tension_control,
                                  {{"none", TensionControl::none},
                                   {"spray", TensionControl::spray},
                                   {"switched", TensionControl::switched}});
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
    reader.tables("plate", [&](TableReader& entry) {
        read_plate(entry, sph.plate.emplace_back(), sph, info);
    });
    read_sph_ends(reader, sph, info);
    reader.tables("gauge",
                  [&](TableReader& entry) { read_gauge(entry, sph.gauge.emplace_back()); });
}

}  // namespace undertow
