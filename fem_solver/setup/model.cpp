#include "fem_solver/setup/model.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "fem_solver/setup/abaqus_mesh.hpp"
#include "fem_solver/setup/block_mesh.hpp"
#include "fem_solver/setup/contact_sets.hpp"
#include "fem_solver/setup/coupled_surface.hpp"
#include "fem_solver/setup/doubts.hpp"
#include "fem_solver/setup/gmsh_mesh.hpp"
#include "fem_solver/setup/immobile.hpp"
#include "fem_solver/setup/implicit_check.hpp"
#include "fem_solver/setup/motions.hpp"
#include "fem_solver/setup/rigid_sets.hpp"
#include "fem_solver/setup/rigid_shell_faces.hpp"
#include "fem_solver/setup/sheet_mesh.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

Mesh read_mesh(const std::string& path, SetsOfCase of_case) {
    return std::filesystem::path(path).extension() == ".inp"
               ? read_abaqus(path, std::move(of_case))
               : read_gmsh(path, std::move(of_case));
}

Mesh make_mesh(const Case& c) {
    if (c.fem.block && !c.fem.mesh.empty())
        throw InputError("fem: give either fem.block or fem.mesh, not both.");
    const std::vector<std::string> immobile = immobile_sets(c.fem);
    if (c.fem.block && !immobile.empty())
        throw InputError("fem.surface \"" + immobile.front() +
                         "\": immobile facets belong to no element, but all facets of [fem.block] "
                         "do; remove immobile, or bring them in a fem.mesh.");
    if (c.fem.block)
        return c.fem.block->cells == BlockCells::shells ? make_sheet(*c.fem.block)
                                                        : make_block(*c.fem.block);
    if (c.fem.mesh.empty())
        throw InputError("fem: there is no mesh; give [fem.block] or fem.mesh = \"FILE.msh\" or \"FILE.inp\".");
    SetsOfCase of_case{immobile, {}};
    for (const FemPart& part : c.fem.part)
        if (part.element == ElementFormulation::shell) of_case.shells.push_back(part.set);
    return read_mesh((std::filesystem::path(c.folder) / c.fem.mesh).string(), std::move(of_case));
}

Hardening make_hardening(const FemMaterial& m) {
    if (m.hardening_table.empty()) {
        if (!(m.yield_stress > 0))
            throw InputError("fem.material \"" + m.name + "\": yield_stress must be > 0.");
        return Hardening::line(m.yield_stress, m.hardening);
    }
    if (m.hardening_table.size() > Hardening::most_pieces)
        throw InputError("fem.material \"" + m.name + "\": hardening_table may have " +
                         std::to_string(Hardening::most_pieces) + " rows at most.");
    return Hardening::table(m.hardening_table);
}

MohrCoulomb make_mohr_coulomb(const FemMaterial& m, const LinearElastic& moduli) {
    const double degree = std::acos(-1.0) / 180, phi = m.friction_angle * degree;
    if (!(m.cohesion > 0 || m.friction_angle > 0))
        throw InputError("fem.material \"" + m.name +
                         "\": cohesion or friction_angle must be > 0.");
    const double tip = phi > 0 ? m.cohesion / std::tan(phi) : MohrCoulomb::no_cutoff;
    return {moduli, std::sin(phi), std::sin(m.dilation_angle * degree), m.cohesion * std::cos(phi),
            std::min(tip, m.tension_cutoff.value_or(tip))};
}

/// The same with its cut-off in `tension`, wherever the tip of the cone is (see with_strength()).
MohrCoulomb make_cutoff_form(const FemMaterial& m, const LinearElastic& moduli) {
    const double degree = std::acos(-1.0) / 180;
    return {moduli, std::sin(m.friction_angle * degree), std::sin(m.dilation_angle * degree), 0,
            m.tension_cutoff.value_or(MohrCoulomb::no_cutoff)};
}

/// Of a strength that grows with depth.
Material make_material_of_depth(const FemMaterial& m) {
    const double ratio = m.modulus_ratio;
    const LinearElastic moduli =
        LinearElastic::from_young(ratio > 0 ? ratio : m.young_modulus, m.poisson_ratio);
    if (m.kind == MaterialKind::mohr_coulomb)
        return WithDepth<MohrCoulomb>{make_cutoff_form(m, moduli), m.cohesion, *m.strength_gradient,
                                      m.strength_level, 0};
    return WithDepth<Tresca>{Tresca{moduli, 0}, m.shear_strength, *m.strength_gradient,
                             m.strength_level, ratio};
}

Material make_material(const FemMaterial& m) {
    const bool with_depth = m.strength_gradient && *m.strength_gradient != 0;
    if (!(m.density > 0) || !(m.young_modulus > 0 || (with_depth && m.modulus_ratio > 0)))
        throw InputError("fem.material \"" + m.name + "\": density and young_modulus must be > 0.");
    if (!(m.poisson_ratio > -1 && m.poisson_ratio < 0.5))
        throw InputError("fem.material \"" + m.name +
                         "\": poisson_ratio = " + std::to_string(m.poisson_ratio) +
                         " must be > -1 and < 0.5 (0.49 is a good stand-in for 0.5).");
    if (with_depth) return make_material_of_depth(m);
    const LinearElastic moduli = LinearElastic::from_young(m.young_modulus, m.poisson_ratio);
    switch (m.kind) {
        case MaterialKind::linear_elastic:
            return moduli;
        case MaterialKind::j2:
            return J2{moduli, make_hardening(m)};
        case MaterialKind::mohr_coulomb:
            return make_mohr_coulomb(m, moduli);
        case MaterialKind::tresca:
            break;
    }
    if (!(m.shear_strength > 0))
        throw InputError("fem.material \"" + m.name + "\": shear_strength must be > 0.");
    return Tresca{moduli, m.shear_strength};
}

/// InputError where nothing is left of the strength.
void check_strength(const FemMaterial& m, const Mesh& mesh, const Part& part) {
    if (!varies_with_depth(part.material)) return;
    const bool frictional = m.kind == MaterialKind::mohr_coulomb && m.friction_angle > 0;
    for (std::int32_t e : part.elements)
        for (std::int32_t n : mesh.corners(e)) {
            const double z = height_of(mesh, e), s = strength_at(part.material, z);
            const double at_corner = strength_at(part.material, mesh.x[n][2]);
            if (s > 0 && at_corner >= 0) continue;
            if (frictional && s >= 0 && at_corner >= 0) continue;
            throw InputError("fem.material \"" + m.name + "\": strength_gradient = " +
                             number_text(*m.strength_gradient) + " Pa/m leaves a strength of " +
                             number_text(std::min(s, at_corner)) + " Pa at z = " +
                             number_text(at_corner < s ? mesh.x[n][2] : z) + " m (" +
                             mesh.element_name(e) + " of \"" + part.name +
                             "\"); it must stay > 0: raise the strength at strength_level = " +
                             number_text(m.strength_level) + " m, or move that level.");
        }
}

/// InputError where material and element do not meet.
void check_shell(const FemMaterial& m, const FemPart& part) {
    if (part.element != ElementFormulation::shell) return;
    if (!(part.thickness > 0))
        throw InputError("fem.part \"" + part.set + "\": a shell needs thickness > 0.");
    if (m.kind != MaterialKind::linear_elastic && m.kind != MaterialKind::j2)
        throw InputError("fem.part \"" + part.set + "\": a shell cannot be of kind = \"" +
                         name_of(m.kind) + "\" (fem.material \"" + m.name +
                         "\"); use \"j2\" with yield_stress, or \"linear_elastic\".");
}

std::vector<Part> make_parts(const FemSettings& fem, const Mesh& mesh) {
    std::vector<Part> parts;
    std::vector<int> part_of(mesh.n_elements(), -1);
    for (const FemPart& p : fem.part) {
        const auto material = std::find_if(fem.material.begin(), fem.material.end(),
                                           [&](const auto& m) { return m.name == p.material; });
        if (material == fem.material.end())
            throw InputError("fem.part \"" + p.set + "\": there is no fem.material \"" +
                             p.material + "\".");
        check_shell(*material, p);
        Part part{p.set,
                  mesh.elements_of(p.set, "fem.part"),
                  material->density,
                  make_material(*material),
                  material->weight_density,
                  p.element,
                  p.thickness,
                  p.implicit};
        for (std::int32_t e : part.elements) {
            if (part_of[e] >= 0)
                throw InputError("fem.part: " + mesh.element_name(e) + " belongs to both \"" +
                                 parts[part_of[e]].name + "\" and \"" + p.set + "\".");
            part_of[e] = int(parts.size());
        }
        check_strength(*material, mesh, part);
        parts.push_back(std::move(part));
    }
    for (std::size_t e = 0; e < part_of.size(); ++e)
        if (part_of[e] < 0)
            throw InputError("fem.part: " + mesh.element_name(e) + " of " + mesh.source +
                             " belongs to no part; give its volume set a material.");
    return parts;
}

/// Rotations can be held at nodes of shells alone.
void check_turned(const Support& support, const Mesh& mesh) {
    if (support.turned == std::array<bool, 3>{}) return;
    for (const Quad& shell : mesh.shells)
        for (std::int32_t n : shell)
            if (std::binary_search(support.nodes.begin(), support.nodes.end(), n)) return;
    throw InputError("fem.support \"" + support.name +
                     "\": fix names rotations, but no node of the set belongs to a shell; nodes of "
                     "solids do not turn, so take \"rx\", \"ry\", \"rz\" and \"clamp\" out.");
}

std::vector<Support> make_supports(const FemSettings& fem, const Mesh& mesh) {
    std::vector<Support> supports;
    for (const FemSupport& s : fem.support) {
        Support support{s.set, mesh.nodes_of(s.set, "fem.support"), {}};
        for (const std::string& direction : s.fix) {
            if (direction == "clamp") {
                support.fixed = support.turned = {true, true, true};
                continue;
            }
            const char axis = direction.empty() ? ' ' : direction.back();
            const std::string turn = std::string("r") + axis, move(1, axis);
            if (axis < 'x' || axis > 'z' || (direction != turn && direction != move))
                throw InputError("fem.support \"" + s.set + "\": fix = \"" + direction +
                                 "\" must be of \"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\", "
                                 "\"clamp\".");
            (direction == turn ? support.turned : support.fixed)[axis - 'x'] = true;
        }
        check_turned(support, mesh);
        supports.push_back(std::move(support));
    }
    return supports;
}

void check_slab(const Mesh& mesh, double thickness) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& x : mesh.x) {
        low = std::min(low, x[1]);
        high = std::max(high, x[1]);
    }
    if (std::abs((high - low) - thickness) > 1e-6 * thickness)
        throw InputError(
            "fem: a 2D case is a slab of case.thickness = " + std::to_string(thickness) +
            " m in y, but the mesh is " + std::to_string(high - low) + " m thick.");
}

/// Elements whose centers lie on the side of the plane that its normal points to.
std::vector<std::int32_t> beyond_plane(const Mesh& mesh, const Vec3& point, const Vec3& normal) {
    std::vector<std::int32_t> beyond;
    for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
        double height = 0;
        for (std::int32_t n : mesh.corners(e))
            for (int d = 0; d < 3; ++d) height += (mesh.x[n][d] - point[d]) * normal[d];
        if (height > 0) beyond.push_back(std::int32_t(e));
    }
    return beyond;
}

/// [Pa] of each element; empty when it is one value in every part.
std::vector<double> strengths(const Mesh& mesh, const std::vector<Part>& parts) {
    std::vector<double> strength;
    if (std::none_of(parts.begin(), parts.end(),
                     [](const Part& part) { return varies_with_depth(part.material); }))
        return strength;
    strength.resize(mesh.n_elements());
    for (const Part& part : parts)
        for (std::int32_t e : part.elements)
            strength[e] = strength_at(part.material, height_of(mesh, e));
    return strength;
}

/// A probe far from every node is a slip of the pen, or a mesh in other units.
void remark_far_probes(const Case& c, const std::vector<Probe>& probes, Mesh& mesh) {
    Vec3 low = mesh.x.front(), high = low;
    for (const Vec3& x : mesh.x)
        for (std::size_t d = 0; d < 3; ++d) {
            low[d] = std::min(low[d], x[d]);
            high[d] = std::max(high[d], x[d]);
        }
    const double size = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    constexpr double far = 0.01;  // of the mesh's size: beyond what rounding and fillets explain
    for (std::size_t k = 0; k < probes.size(); ++k) {
        double squared = 0;
        for (std::size_t d = 0; d < 3; ++d) {
            if (c.info.dimension == 2 && d == 1) continue;
            const double at = c.fem.probe[k].point[d];
            squared += std::pow(std::max({0.0, low[d] - at, at - high[d]}), 2);
        }
        if (std::sqrt(squared) <= far * size) continue;
        const Vec3& x = mesh.x[std::size_t(probes[k].node)];
        mesh.remarks.push_back(
            "fem.probe \"" + probes[k].name + "\" lies " + number_text(std::sqrt(squared), 3) +
            " m outside of the mesh; the node nearest to it is taken, at (" + number_text(x[0], 6) +
            ", " + number_text(x[1], 6) + ", " + number_text(x[2], 6) + ") m");
    }
}

}  // namespace

std::int32_t nearest_node(const Mesh& mesh, const Vec3& point) {
    std::int32_t best = 0;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < mesh.x.size(); ++n) {
        double squared = 0;
        for (int d = 0; d < 3; ++d) squared += std::pow(mesh.x[n][d] - point[d], 2);
        if (squared < smallest) {
            smallest = squared;
            best = std::int32_t(n);
        }
    }
    return best;
}

Model build_model(const Case& c) {
    return build_model(c, make_mesh(c));
}

Model build_model(const Case& c, Mesh mesh) {
    Model model;
    model.mesh = std::move(mesh);
    model.parts = make_parts(c.fem, model.mesh);
    model.rigid = take_rigid_sets(c, model.mesh, model.parts);
    model.bulk_viscosity = {c.fem.bulk_viscosity_linear, c.fem.bulk_viscosity_quadratic};
    model.point_masses = make_point_masses(c, model.mesh, model.rigid);
    const RigidShellFaces faces(c, model.mesh, model.rigid);
    model.motions = make_motions(c, model.mesh, model.rigid);
    model.initial_velocities = make_initial_velocities(c, model.mesh, model.rigid);
    model.contacts = make_contact_sets(c, model.mesh, model.parts, model.rigid, faces);
    if (!c.fem.surface.empty()) model.coupled_share = c.coupling.beta + 2 * c.coupling.damping;
    model.max_step = c.time.max_step;
    model.supports = make_supports(c.fem, model.mesh);
    if (c.info.dimension == 2) {
        check_slab(model.mesh, c.info.thickness);
        Support plane{"plane strain", {}, {false, true, false}, {}};
        if (!model.mesh.shells.empty()) plane.turned = {true, false, true};
        for (std::size_t n = 0; n < model.mesh.x.size(); ++n)
            plane.nodes.push_back(std::int32_t(n));
        model.supports.push_back(std::move(plane));
    }
    leave_rigid_nodes(model.supports, model.rigid);
    check_motions(c, model);
    check_immobile(c.fem, model.mesh);
    for (const FemPressure& p : c.fem.pressure)
        model.pressures.emplace_back(model.mesh.facets_of(p.set, "fem.pressure"), p.value, p.ramp);
    for (const FemTraction& t : c.fem.traction)
        model.tractions.emplace_back(model.mesh.facets_of(t.set, "fem.traction"), model.mesh.x,
                                     t.value, t.ramp);
    model.surface = make_coupled_surface(c, model.mesh, model.parts, faces);
    model.strength = strengths(model.mesh, model.parts);
    model.initial_stress = geostatic_stress(c, model.mesh, model.parts);
    model.far_field = make_far_field(c.fem, model.mesh, model.parts);
    model.water = make_static_water(c, model.mesh);
    for (const FemProbe& p : c.fem.probe)
        model.probes.push_back({p.name, nearest_node(model.mesh, p.point)});
    remark_far_probes(c, model.probes, model.mesh);
    for (std::string& doubt : doubts(c)) model.mesh.remarks.push_back(std::move(doubt));
    for (const FemHistory& h : c.fem.history)
        if (h.kind == FemHistoryKind::section)
            model.sections.emplace_back(
                model.mesh,
                h.normal ? beyond_plane(model.mesh, h.point, *h.normal)
                         : model.mesh.elements_of(h.set, "fem.history"),
                h.point, "fem.history \"" + h.name + "\": the section");
    model.gravity = c.info.gravity;
    model.damping = c.fem.damping_alpha;
    model.cfl = c.fem.cfl;
    model.implicit_damping = c.fem.implicit_damping;
    model.damping_beta = c.fem.damping_beta;
    check_implicit_parts(c, model);
    // last: contact and dashpots at the edge are of the material as it is
    model.mass_scaling = scale_masses(c, model.mesh, model.parts, model.bulk_viscosity);
    return model;
}

}  // namespace undertow::fem
