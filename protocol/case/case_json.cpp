// A resolved case as JSON, for scripts: they never re-implement the rules of the reader.

#include <cmath>
#include <nlohmann/json.hpp>

#include "case/resolved_case.hpp"

namespace undertow {

using Json = nlohmann::ordered_json;

namespace {

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::vector<std::string> texts(const std::vector<Expression>& formulas) {
    std::vector<std::string> all;
    for (const Expression& formula : formulas) all.push_back(formula.text());
    return all;
}

const char* name(Kernel v) {
    return v == Kernel::cubic_spline  ? "cubic_spline"
           : v == Kernel::wendland_c2 ? "wendland_c2"
                                      : "wendland_c4";
}
const char* name(TensionControl v) {
    return v == TensionControl::none    ? "none"
           : v == TensionControl::spray ? "spray"
                                        : "switched";
}
const char* name(EquationOfState v) {
    return v == EquationOfState::us_up ? "us_up" : "tait";
}
const char* name(Slip v) {
    return v == Slip::free_slip ? "free" : v == Slip::no_slip ? "no_slip" : "friction";
}
const char* name(ElementFormulation v) {
    return v == ElementFormulation::one_point           ? "one_point"
           : v == ElementFormulation::b_bar             ? "b_bar"
           : v == ElementFormulation::averaged_pressure ? "averaged_pressure"
           : v == ElementFormulation::shell             ? "shell"
                                                        : "auto";
}
const char* name(StiffnessLaw v) {
    return v == StiffnessLaw::fluid ? "fluid" : "eq11";
}
const char* name(FrictionLaw v) {
    return v == FrictionLaw::coulomb ? "coulomb" : "viscous";
}
const char* name(Precision v) {
    return v == Precision::float32 ? "float" : "double";
}
const char* name(Integrator v) {
    return v == Integrator::automatic  ? "auto"
           : v == Integrator::one_pass ? "one_pass"
                                       : "two_pass";
}
const char* name(ViscositySolver v) {
    return v == ViscositySolver::automatic  ? "auto"
           : v == ViscositySolver::implicit ? "implicit"
                                            : "explicit";
}
const char* name(ViscousForm v) {
    return v == ViscousForm::laplacian ? "laplacian" : "strain";
}
const char* name(FillLattice v) {
    return v == FillLattice::square ? "square" : "relaxed";
}
const char* name(SphGaugeKind v) {
    return v == SphGaugeKind::front         ? "front"
           : v == SphGaugeKind::pressure    ? "pressure"
           : v == SphGaugeKind::water_level ? "water_level"
           : v == SphGaugeKind::flux        ? "flux"
                                            : "force";
}

}  // namespace

// Found by argument-dependent lookup: nlohmann turns vectors of these into arrays by itself.
void to_json(Json& j, const Box& v) {
    j = {{"min", v.min}, {"max", v.max}};
}

/// The table with the keys of its shape.
Json with_shape(Json j, const Shape& v) {
    if (v.box) j["box"] = *v.box;
    if (!v.profile.empty()) j["profile"] = v.profile;
    if (v.radius > 0) j["from"] = v.from, j["to"] = v.to, j["radius"] = v.radius;
    if (!v.stl.empty()) j["stl"] = v.stl, j["scale"] = v.scale, j["at"] = v.at;
    return j;
}

void to_json(Json& j, const Fluid& v) {
    j = {{"name", v.name},
         {"density", v.density},
         {"spacing", v.spacing > 0 ? Json(v.spacing) : Json("sph.spacing")},
         {"viscosity", v.viscosity},
         {"yield_stress", v.yield_stress},
         {"consistency", v.consistency},
         {"flow_index", v.flow_index},
         {"max_viscosity", v.max_viscosity},
         {"equation_of_state", name(v.equation_of_state)},
         {"sound_speed", v.sound_speed ? Json(*v.sound_speed) : Json("auto")},
         {"hugoniot_slope", v.hugoniot_slope},
         {"gruneisen", v.gruneisen},
         {"tait_exponent", v.tait_exponent}};
}

void to_json(Json& j, const Fill& v) {
    j = {{"fluid", v.fluid},
         {"box", v.box},
         {"profile", v.profile},
         {"velocity", v.velocity},
         {"velocity_field", texts(v.velocity_field)},
         {"pressure", v.pressure ? Json(v.pressure->text()) : Json(nullptr)},
         {"ramp", v.ramp},
         {"surface_level", v.surface_level ? Json(*v.surface_level) : Json(nullptr)}};
    j = with_shape(std::move(j), v.within);
}

void to_json(Json& j, const Obstacle& v) {
    j = with_shape({{"name", v.name}}, v.shape);
}

void to_json(Json& j, const PlaneWall& v) {
    j = {{"name", v.name},
         {"point", v.point},
         {"normal", v.normal},
         {"slip", v.symmetry ? "symmetry" : name(v.slip)},
         {"friction", v.friction},
         {"velocity", v.velocity}};
}

void to_json(Json& j, const Body& v) {
    j = with_shape({{"name", v.name},
                    {"inside", v.inside},
                    {"velocity", v.velocity},
                    {"start", v.start},
                    {"stop", number(v.stop)},
                    {"slip", name(v.slip)},
                    {"friction", v.friction}},
                   v.shape);
    if (!v.displacement.empty()) j["displacement"] = texts(v.displacement);
    if (!v.motion.empty()) j["motion"] = v.motion;
    if (v.angle) j["angle"] = v.angle->text();
    if (v.angle || !v.motion.empty()) j["axis"] = v.axis, j["center"] = v.center;
}

void to_json(Json& j, const Inflow& v) {
    j = {{"name", v.name},
         {"fluid", v.fluid},
         {"box", v.box},
         {"normal", v.normal},
         {"velocity", v.velocity ? Json(v.velocity->text()) : Json(nullptr)},
         {"level", v.level ? Json(*v.level) : Json(nullptr)}};
}

void to_json(Json& j, const Outflow& v) {
    j = {{"name", v.name},
         {"box", v.box},
         {"normal", v.normal},
         {"pressure", v.pressure ? Json(*v.pressure) : Json(nullptr)},
         {"level", v.level ? Json(*v.level) : Json(nullptr)}};
}

void to_json(Json& j, const AbsorbingLayer& v) {
    j = {{"name", v.name},
         {"box", v.box},
         {"direction", v.direction},
         {"velocity", v.velocity},
         {"strength", v.strength},
         {"wave_speed", v.wave_speed}};
}

void to_json(Json& j, const SphGauge& v) {
    j = {{"name", v.name},
         {"kind", name(v.kind)},
         {"point", v.point},
         {"direction", v.direction},
         {"every", v.every}};
    if (v.kind == SphGaugeKind::flux) j["box"] = v.box;
    if (v.kind == SphGaugeKind::force) j["wall"] = v.wall;
}

void to_json(Json& j, const SphSettings& v) {
    j = {{"spacing", v.spacing},
         {"kernel", name(v.kernel)},
         {"smoothing_ratio", v.smoothing_ratio},
         {"variable_smoothing", v.variable_smoothing},
         {"density_diffusion", v.density_diffusion},
         {"artificial_viscosity", v.artificial_viscosity},
         {"viscosity_solver", name(v.viscosity_solver)},
         {"viscosity_tolerance", v.viscosity_tolerance},
         {"viscous_form", name(v.viscous_form)},
         {"tension_control", name(v.tension_control)},
         {"shifting", v.shifting},
         {"gradient_correction", v.gradient_correction},
         {"precision", name(v.precision)},
         {"lattice", name(v.lattice)},
         {"surface_images", v.surface_images},
         {"integrator", name(v.integrator)},
         {"cfl", v.cfl},
         {"force_cfl", v.force_cfl},
         {"max_speed", v.max_speed},
         {"domain", v.domain ? Json(*v.domain) : Json(nullptr)},
         {"periodic", v.periodic},
         {"fluid", v.fluid},
         {"fill", v.fill},
         {"obstacle", v.obstacle},
         {"plane", v.plane},
         {"body", v.body},
         {"inflow", v.inflow},
         {"outflow", v.outflow},
         {"absorbing", v.absorbing},
         {"gauge", v.gauge}};
}

void to_json(Json& j, const FemBlock& v) {
    j = {{"box", v.box},
         {"divisions", v.divisions},
         {"corners", v.corners},
         {"cells", v.cells == BlockCells::shells       ? "shells"
                   : v.cells == BlockCells::tetrahedra ? "tetrahedra"
                                                       : "hexahedra"}};
}
void to_json(Json& j, const FemMaterial& v) {
    j = {{"name", v.name},
         {"kind", name_of(v.kind)},
         {"density", v.density},
         {"weight_density", v.weight_density.value_or(v.density)},
         {"young_modulus", v.young_modulus},
         {"poisson_ratio", v.poisson_ratio},
         {"shear_strength", v.shear_strength},
         {"yield_stress", v.yield_stress},
         {"hardening", v.hardening},
         {"hardening_table", v.hardening_table},
         {"cohesion", v.cohesion},
         {"friction_angle", v.friction_angle},
         {"dilation_angle", v.dilation_angle},
         {"tension_cutoff", v.tension_cutoff ? Json(*v.tension_cutoff) : Json()}};
    if (v.strength_gradient)
        j["strength_gradient"] = *v.strength_gradient, j["strength_level"] = v.strength_level;
    if (v.modulus_ratio > 0) j["modulus_ratio"] = v.modulus_ratio;
}
void to_json(Json& j, const FemPart& v) {
    j = {{"set", v.set}, {"material", v.material}, {"element", name(v.element)},
         {"thickness", v.thickness}, {"implicit", v.implicit}, {"mass_factor", v.mass_factor}};
}
void to_json(Json& j, const FemSupport& v) {
    j = {{"set", v.set}, {"fix", v.fix}};
}
void to_json(Json& j, const FemPressure& v) {
    j = {{"set", v.set}, {"value", v.value}, {"ramp", v.ramp}};
}
void to_json(Json& j, const FemTraction& v) {
    j = {{"set", v.set}, {"value", v.value}, {"ramp", v.ramp}};
}
void to_json(Json& j, const FemSurface& v) {
    j = {{"name", v.name}, {"set", v.set}, {"immobile", v.immobile}};
}
void to_json(Json& j, const FemWater& v) {
    j = {{"level", v.level}, {"density", v.density}};
}
void to_json(Json& j, const FemGeostatic& v) {
    j = {{"set", v.set}, {"surface", v.surface}, {"earth_pressure", v.earth_pressure}};
}
void to_json(Json& j, const FemSettle& v) {
    j = {{"tolerance", v.tolerance}, {"max_steps", v.max_steps}};
}
void to_json(Json& j, const FemAbsorbing& v) {
    j = {{"set", v.set}, {"center", v.center ? Json(*v.center) : Json(nullptr)}};
}
void to_json(Json& j, const FemRigid& v) {
    j = {{"name", v.name},
         {"set", v.set},
         {"free", v.free},
         {"added_mass", v.added_mass},
         {"added_at", v.added_at}};
}
void to_json(Json& j, const FemContact& v) {
    j = {{"name", v.name},         {"nodes", v.nodes},         {"surface", v.surface},
         {"friction", v.friction}, {"max_shear", v.max_shear}, {"gap", v.gap}};
    if (v.adhesion_factor > 0) j["adhesion_factor"] = v.adhesion_factor;
}
void to_json(Json& j, const FemMotion& v) {
    j = {{"name", v.name},         {"set", v.set},     {"rigid", v.rigid},
         {"directions", v.directions}, {"ramp", v.ramp}};
    if (!v.displacement.empty()) {
        j["displacement"] = texts(v.displacement);
    } else if (!v.motion.empty()) {
        j["motion"] = v.motion;
    } else {
        j["velocity"] = v.velocity, j["start"] = v.start, j["stop"] = number(v.stop);
    }
    if (v.angle) j["angle"] = v.angle->text();
    if (v.angle || !v.motion.empty()) j["axis"] = v.axis, j["center"] = v.center;
}
void to_json(Json& j, const FemInitialVelocity& v) {
    j = {{"set", v.set}, {"rigid", v.rigid}, {"spin", v.spin}, {"center", v.center}};
    j["velocity"] = v.formulas.empty() ? Json(v.velocity) : Json(texts(v.formulas));
}
void to_json(Json& j, const FemMass& v) {
    j = {{"set", v.set}, {"point", v.point}, {"mass", v.mass}};
}
void to_json(Json& j, const FemProbe& v) {
    j = {{"name", v.name}, {"point", v.point}};
}

void to_json(Json& j, const FemHistory& v) {
    const char* const kinds[] = {"point", "set", "section", "contact"};
    j = {{"name", v.name},       {"kind", kinds[int(v.kind)]},
         {"point", v.point},     {"set", v.set},
         {"contact", v.contact}, {"every", v.every},
         {"normal", v.normal ? Json(*v.normal) : Json(nullptr)}};
}

void to_json(Json& j, const FemSettings& v) {
    j = {{"mesh", v.mesh},
         {"block", v.block ? Json(*v.block) : Json(nullptr)},
         {"cfl", v.cfl},
         {"damping_alpha", v.damping_alpha},
         {"damping_beta", v.damping_beta},
         {"mass_scaling", v.mass_scaling ? Json(*v.mass_scaling) : Json(nullptr)},
         {"bulk_viscosity_linear", v.bulk_viscosity_linear},
         {"bulk_viscosity_quadratic", v.bulk_viscosity_quadratic},
         {"implicit_damping", v.implicit_damping},
         {"material", v.material},
         {"part", v.part},
         {"support", v.support},
         {"mass", v.mass},
         {"pressure", v.pressure},
         {"traction", v.traction},
         {"surface", v.surface},
         {"water", v.water ? Json(*v.water) : Json(nullptr)},
         {"geostatic", v.geostatic ? Json(*v.geostatic) : Json(nullptr)},
         {"settle", v.settle ? Json(*v.settle) : Json(nullptr)},
         {"absorbing", v.absorbing},
         {"rigid", v.rigid},
         {"motion", v.motion},
         {"initial_velocity", v.initial_velocity},
         {"contact", v.contact},
         {"probe", v.probe},
         {"history", v.history}};
}

void to_json(Json& j, const PressurePatch& v) {
    j = {{"name", v.name}, {"box", v.box}, {"area", v.area}, {"window", v.window}};
}

void to_json(Json& j, const CouplingSettings& v) {
    j = {{"law", name(v.law)},
         {"stiffness_factor", v.stiffness_factor},
         {"beta", v.beta},
         {"damping", v.damping},
         {"friction", v.friction},
         {"friction_law", name(v.friction_law)},
         {"viscous_coefficient", v.viscous_coefficient},
         {"skin", v.skin},
         {"transport", v.transport},
         {"deadline", v.deadline},
         {"join_timeout", v.join_timeout},
         {"patch", v.patch}};
}

void to_json(Json& j, const Node& v) {
    switch (v.kind) {
        case Node::Kind::table:
            j = Json::object();
            for (const auto& [key, value] : v.members) j[key] = value;
            break;
        case Node::Kind::array:
            j = v.items;
            break;
        case Node::Kind::text:
            j = v.text;
            break;
        case Node::Kind::integer:
            j = v.integer;
            break;
        case Node::Kind::number:
            j = number(v.number);
            break;
        case Node::Kind::flag:
            j = v.flag;
            break;
    }
}

std::string case_json(const ResolvedCase& resolved) {
    const Case& c = resolved.values;
    Json j;
    j["file"] = c.file;
    j["folder"] = c.folder;
    j["coupled"] = resolved.coupled;
    j["known_levels"] = resolved.levels;
    j["known_variants"] = resolved.variants;
    j["case"] = {{"name", c.info.name},
                 {"title", c.info.title},
                 {"dimension", c.info.dimension},
                 {"thickness", c.info.thickness},
                 {"gravity", c.info.gravity}};
    j["time"] = {{"end", c.time.end},
                 {"max_step", number(c.time.max_step)},
                 {"min_step", c.time.min_step},
                 {"growth", c.time.growth}};
    j["start"] = {{"settle", c.start.settle}, {"damping", c.start.damping}};
    j["output"] = {{"fields_every", c.output.fields_every},
                   {"history_every", c.output.history_every},
                   {"contact_fields", c.output.contact_fields},
                   {"contact_every", c.output.contact_every}};
    j["checkpoint"] = nullptr;
    if (c.checkpoint.present)
        j["checkpoint"] = {{"every", c.checkpoint.every},
                           {"every_wall", c.checkpoint.every_wall},
                           {"on_interrupt", c.checkpoint.on_interrupt},
                           {"at_end", c.checkpoint.at_end},
                           {"keep", c.checkpoint.keep}};
    j["sph"] = c.sph.present ? Json(c.sph) : Json(nullptr);
    j["fem"] = c.fem.present ? Json(c.fem) : Json(nullptr);
    j["coupling"] = resolved.coupled ? Json(c.coupling) : Json(nullptr);
    j["backend"] = resolved.backend;
    j["report"] = resolved.report;
    return j.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace undertow
