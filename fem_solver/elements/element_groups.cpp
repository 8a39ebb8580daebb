#include "fem_solver/elements/element_groups.hpp"

#include <algorithm>
#include <cmath>

#include "fem_solver/elements/bbar_hexahedra.hpp"
#include "fem_solver/elements/hexahedra.hpp"
#include "fem_solver/elements/tetrahedra.hpp"
#include "fem_solver/shells/shells.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

/// A kind of elements: the shape it is for, and how a case calls it. The first of a shape is its
/// default.
struct Kind {
    ElementFormulation formulation;
    ElementShape shape;
    const char* name;
};
constexpr Kind kinds[] = {
    {ElementFormulation::one_point, ElementShape::hexahedron, "one_point"},
    {ElementFormulation::b_bar, ElementShape::hexahedron, "b_bar"},
    {ElementFormulation::averaged_pressure, ElementShape::tetrahedron, "averaged_pressure"},
    {ElementFormulation::shell, ElementShape::shell, "shell"},
};

std::unique_ptr<ElementGroup> make_group(const Kind& kind, const Mesh& mesh,
                                         const std::vector<Part>& parts,
                                         const BulkViscosity& viscosity) {
    switch (kind.formulation) {
        case ElementFormulation::b_bar:
            return std::make_unique<BbarHexahedra>(mesh, parts, viscosity);
        case ElementFormulation::averaged_pressure:
            return std::make_unique<Tetrahedra>(mesh, parts, viscosity);
        case ElementFormulation::shell:
            return std::make_unique<Shells>(mesh, parts);
        default:
            return std::make_unique<Hexahedra>(mesh, parts, viscosity);
    }
}

/// Index into kinds: what the part asks for, or the default of the element's shape.
std::size_t kind_of(const Mesh& mesh, const Part& part, std::int32_t element) {
    const ElementShape shape = mesh.shape_of(element);
    for (std::size_t k = 0; k < std::size(kinds); ++k) {
        if (part.element == ElementFormulation::automatic) {
            if (kinds[k].shape == shape) return k;
        } else if (kinds[k].formulation == part.element) {
            if (kinds[k].shape == shape) return k;
            throw InputError("fem.part \"" + part.name + "\": element = \"" + kinds[k].name +
                             "\" is for a " + name_of(kinds[k].shape) + ", but the set holds " +
                             mesh.element_name(element) +
                             "; leave element out, or split the set by shape.");
        }
    }
    throw InputError("fem.part \"" + part.name + "\" holds " + mesh.element_name(element) +
                     ", but there is no such element to compute with; mesh the set with "
                     "hexahedra.");
}

}  // namespace

Elements::Elements(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity)
    : part_of_(mesh.n_elements(), -1), group_of_(mesh.n_elements(), -1) {
    std::vector<std::vector<Part>> of_kind(std::size(kinds));
    std::vector<Part> implicit;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Part& part = parts[p];
        name_.push_back(part.name);
        const auto include_moduli = [&](double z) {
            const LinearElastic moduli = elastic_moduli(part.material, z);
            wave_speed_ =
                std::max(wave_speed_, std::sqrt((moduli.lambda + 2 * moduli.mu) / part.density));
        };
        if (varies_with_depth(part.material))
            for (std::int32_t e : part.elements) include_moduli(height_of(mesh, e));
        else
            include_moduli(0);
        any_plastic_ |= is_plastic(part.material);
        std::vector<std::vector<std::int32_t>> split(std::size(kinds));
        for (std::int32_t e : part.elements) {
            part_of_[e] = std::int32_t(p);
            split[kind_of(mesh, part, e)].push_back(e);
        }
        deformable_ += part.elements.size();
        if (part.implicit) {  // one-point hexahedra, see check_implicit_parts()
            if (!part.elements.empty()) implicit.push_back(part);
            continue;
        }
        for (std::size_t k = 0; k < std::size(kinds); ++k) {
            if (split[k].empty()) continue;
            of_kind[k].push_back(part);
            of_kind[k].back().elements = std::move(split[k]);
        }
    }
    const auto add = [&](const std::vector<Part>& of_group, std::unique_ptr<ElementGroup> group) {
        for (const Part& part : of_group)
            for (std::int32_t e : part.elements) group_of_[e] = std::int32_t(groups_.size());
        groups_.push_back(std::move(group));
    };
    for (std::size_t k = 0; k < std::size(kinds); ++k)
        if (!of_kind[k].empty()) add(of_kind[k], make_group(kinds[k], mesh, of_kind[k], viscosity));
    if (implicit.empty()) return;
    auto group = std::make_unique<Hexahedra>(mesh, implicit, viscosity);
    implicit_ = group.get();
    add(implicit, std::move(group));
}

bool Elements::limits_step(const std::unique_ptr<ElementGroup>& group) const {
    return group.get() != implicit_;
}

std::vector<double> Elements::nodal_masses(std::size_t n_nodes) const {
    std::vector<double> mass(n_nodes, 0.0);
    for (const auto& group : groups_) group->add_nodal_masses(mass);
    return mass;
}

std::vector<double> Elements::nodal_weight_masses(std::size_t n_nodes) const {
    std::vector<double> mass(n_nodes, 0.0);
    for (const auto& group : groups_) group->add_nodal_weight_masses(mass);
    return mass;
}

void Elements::set_stress(std::int32_t element, const Symmetric<double>& stress) {
    groups_[group_of_[element]]->set_stress(element, stress);
}

double Elements::omega2_start() const {
    double largest = 0;
    for (const auto& group : groups_)
        if (limits_step(group)) largest = std::max(largest, group->omega2_start());
    return largest;
}

std::vector<double> Elements::omega2() const {
    std::vector<double> all(size(), 0.0);
    for (const auto& group : groups_) group->write_omega2(all);
    return all;
}

ElementsReport Elements::step(Nodes& nodes, double dt, int threads) {
    ElementsReport total;
    for (const auto& group : groups_) {
        ElementsReport report = group->step(nodes, dt, threads);
        if (!limits_step(group)) report.omega2 = report.stiffening = 0;
        total += report;
    }
    return total;
}

void Elements::subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const {
    for (const auto& group : groups_)
        if (limits_step(group)) group->subtract_tangent_forces(x, u, f);
}

void Elements::accept_shape() {
    for (const auto& group : groups_) group->accept_shape();
}

bool Elements::rotates() const {
    return std::any_of(groups_.begin(), groups_.end(),
                       [](const auto& group) { return group->rotates(); });
}

TurningNodes* Elements::turning_nodes() const {
    for (const auto& group : groups_)
        if (group->rotates()) return group->turning_nodes();
    return nullptr;
}

std::span<const NodeRow> Elements::inverse_inertia() const {
    for (const auto& group : groups_)
        if (group->rotates()) return group->inverse_inertia();
    return {};
}

KickReport Elements::kick(const Kick& step, int threads) {
    KickReport sum;
    for (const auto& group : groups_)
        if (group->rotates()) sum += group->kick(step, threads);
    return sum;
}

void Elements::drift(double dt, int threads) {
    for (const auto& group : groups_) group->drift(dt, threads);
}

void Elements::hold() {
    for (const auto& group : groups_) group->hold();
}

void Elements::hold_rotation(std::int32_t node, int axis) {
    for (const auto& group : groups_) group->hold_rotation(node, axis);
}

void Elements::stop() {
    for (const auto& group : groups_) group->stop();
}

std::size_t Elements::stiffest() const {
    ExtremeElement best;
    for (const auto& group : groups_) {
        if (!limits_step(group)) continue;
        if (const ExtremeElement one = group->stiffest(); one.value > best.value) best = one;
    }
    return best.element;
}

std::size_t Elements::most_compressed(const Nodes& nodes) const {
    ExtremeElement worst{0, 1e300};
    for (const auto& group : groups_) {
        const ExtremeElement one = group->most_compressed(nodes);
        if (one.value >= worst.value) continue;
        worst = one;
        if (!(one.value == one.value)) break;  // a NaN is the worst of all
    }
    return worst.element;
}

std::vector<double> Elements::stress() const {
    std::vector<double> all(6 * size(), 0.0);
    for (const auto& group : groups_) group->write_stress(all);
    return all;
}

Elements::FaceStress Elements::face_stress() const {
    FaceStress all;
    if (!rotates()) return all;
    all.top.resize(6 * size());
    all.bottom.resize(6 * size());
    for (const auto& group : groups_) group->write_face_stress(all.top, all.bottom);
    return all;
}

std::vector<double> Elements::plastic_strain() const {
    std::vector<double> all(size(), 0.0);
    for (const auto& group : groups_) group->write_plastic_strain(all);
    return all;
}

}  // namespace undertow::fem
