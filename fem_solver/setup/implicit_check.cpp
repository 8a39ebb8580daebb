#include "fem_solver/setup/implicit_check.hpp"

#include <algorithm>
#include <cmath>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

// xi^2 <= margin of fem_solver/implicit: the viscosity is lagged, and a step far beyond the
// elements' own leaves it what 4 kappa leaves beyond dt^2.
constexpr double largest_viscosity = 0.2;

std::string name_of(const Part& part) {
    return "fem.part \"" + part.name + "\": implicit = true ";
}

/// One entry per node of the mesh: the implicit part it belongs to, or -1.
std::vector<int> implicit_part_of(const Model& model) {
    std::vector<int> part_of(model.mesh.x.size(), -1);
    for (std::size_t p = 0; p < model.parts.size(); ++p)
        if (model.parts[p].implicit)
            for (std::int32_t e : model.parts[p].elements)
                for (std::int32_t n : model.mesh.corners(e)) part_of[n] = int(p);
    return part_of;
}

void check_elements(const Mesh& mesh, const Part& part) {
    const bool other = part.element != ElementFormulation::automatic &&
                       part.element != ElementFormulation::one_point;
    for (std::int32_t e : part.elements)
        if (other || mesh.shape_of(e) != ElementShape::hexahedron)
            throw InputError(
                name_of(part) +
                "is for hexahedra of element = \"one_point\" alone, but the set holds " +
                mesh.element_name(e) + (other ? " of another element" : "") +
                "; leave that part explicit.");
}

void check_neighbors(const Case& c, const Model& model) {
    const std::vector<int> part_of = implicit_part_of(model);
    for (const RigidSet& body : model.rigid)
        for (std::int32_t n : body.nodes)
            if (part_of[n] >= 0)
                throw InputError(name_of(model.parts[part_of[n]]) +
                                 "does not go together with the rigid body \"" + body.name +
                                 "\" on the same nodes; leave a part between them explicit.");
    for (const FemAbsorbing& a : c.fem.absorbing)
        for (const Quad& q : model.mesh.facets_of(a.set, "fem.absorbing"))
            for (std::int32_t n : q)
                if (part_of[n] >= 0)
                    throw InputError(name_of(model.parts[part_of[n]]) +
                                     "does not go together with fem.absorbing \"" + a.set +
                                     "\" on the same nodes; leave that part explicit.");
}

}  // namespace

bool only_implicit_parts(const Model& model) {
    return std::all_of(model.parts.begin(), model.parts.end(),
                       [](const Part& p) { return p.implicit || p.elements.empty(); });
}

void check_implicit_parts(const Case& c, const Model& model) {
    bool any = false;
    for (const Part& part : model.parts) {
        if (!part.implicit) continue;
        any = true;
        if (part.elements.empty())
            throw InputError(name_of(part) +
                             "has no effect: all its elements belong to a rigid body; remove it.");
        check_elements(model.mesh, part);
        if (is_plastic(part.material))
            throw InputError(name_of(part) +
                             "needs a material that stays elastic, but this one can yield; remove "
                             "implicit, or use kind = \"linear_elastic\".");
    }
    if (!any) return;
    if (model.bulk_viscosity.linear > largest_viscosity)
        throw InputError("fem.bulk_viscosity_linear = " + number_text(model.bulk_viscosity.linear) +
                         " is too much for implicit parts: it must be <= " +
                         number_text(largest_viscosity) + "; 0.06 is usual.");
    check_neighbors(c, model);
    if (only_implicit_parts(model) && c.fem.damping_beta > 0)
        throw InputError("fem.damping_beta has no effect: it damps explicit parts, and all that "
                         "deforms is implicit; use implicit_damping, or leave it out.");
    if (!only_implicit_parts(model) || std::isfinite(c.time.max_step)) return;
    const std::string rest =
        ": all that deforms is implicit, so that nothing limits the step; set time.max_step to "
        "what resolves the motion (a twentieth of the shortest period that matters).";
    if (c.fem.settle) throw InputError("fem.settle" + rest);
    if (!model.contacts.empty()) throw InputError("fem.contact" + rest);
    if (model.surface.quad.empty()) throw InputError("fem.part" + rest);
}

}  // namespace undertow::fem
