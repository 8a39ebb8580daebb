#include "fem_solver/setup/rigid_sets.hpp"

#include <algorithm>

#include "fem_solver/setup/element_volume.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

const char* const freedom[6] = {"x", "y", "z", "rx", "ry", "rz"};

const FemMaterial& material_of(const FemSettings& fem, std::size_t part) {
    return *std::find_if(fem.material.begin(), fem.material.end(),
                         [&](const auto& m) { return m.name == fem.part[part].material; });
}

/// Masses of the body's nodes and what weighs on it.
void weigh(const Case& c, const Mesh& mesh, const std::vector<int>& part_of, RigidSet& set) {
    std::vector<double> mass(mesh.x.size(), 0.0), of_shells(mesh.x.size(), 0.0);
    Vec3 moment{};
    for (std::int32_t e : set.elements) {
        const FemMaterial& material = material_of(c.fem, std::size_t(part_of[e]));
        const std::span<const std::int32_t> corners = mesh.corners(e);
        const double thickness = c.fem.part[std::size_t(part_of[e])].thickness;
        const double volume = element_volume(mesh, e, thickness), share = double(corners.size());
        const double weight = material.weight_density.value_or(material.density) * volume;
        set.weight_mass += weight;
        for (std::int32_t n : corners) {
            mass[n] += material.density * volume / share;
            if (mesh.shape_of(e) == ElementShape::shell)
                of_shells[n] += material.density * volume / share;
            set.nodes.push_back(n);
            for (int d = 0; d < 3; ++d) moment[d] += weight / share * mesh.x[n][d];
        }
    }
    std::sort(set.nodes.begin(), set.nodes.end());
    set.nodes.erase(std::unique(set.nodes.begin(), set.nodes.end()), set.nodes.end());
    for (std::int32_t n : set.nodes) {
        set.mass.push_back(mass[n]);
        set.shell_mass.push_back(of_shells[n]);
    }
    if (set.weight_mass != 0)
        for (int d = 0; d < 3; ++d) set.weight_center[d] = moment[d] / set.weight_mass;
}

/// Which body owns a node; InputError if two do, or a deformable element as well.
void check_owners(const Mesh& mesh, const std::vector<RigidSet>& bodies,
                  const std::vector<int>& body_of) {
    std::vector<int> owner(mesh.x.size(), -1);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::int32_t n : bodies[b].nodes) {
            if (owner[n] >= 0)
                throw InputError("fem.rigid: \"" + bodies[owner[n]].name + "\" and \"" +
                                 bodies[b].name + "\" share the node at " + point_text(mesh.x[n]) +
                                 "; make them one body or mesh them apart.");
            owner[n] = int(b);
        }
    for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
        if (body_of[e] >= 0) continue;
        for (std::int32_t n : mesh.corners(e))
            if (owner[n] >= 0)
                throw InputError("fem.rigid \"" + bodies[owner[n]].name + "\": its node at " +
                                 point_text(mesh.x[n]) + " also belongs to the deformable " +
                                 mesh.element_name(e) +
                                 "; mesh the two apart and join them by a [[fem.contact]].");
    }
}

}  // namespace

std::vector<RigidSet> take_rigid_sets(const Case& c, const Mesh& mesh, std::vector<Part>& parts) {
    std::vector<RigidSet> bodies;
    if (c.fem.rigid.empty()) return bodies;
    std::vector<int> part_of(mesh.n_elements(), -1), body_of(mesh.n_elements(), -1);
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::int32_t e : parts[p].elements) part_of[e] = int(p);

    for (const FemRigid& rigid : c.fem.rigid) {
        RigidSet set;
        set.name = rigid.name;
        set.elements = mesh.elements_of(rigid.set, "fem.rigid");
        set.added_mass = rigid.added_mass;
        set.added_at = rigid.added_at;
        for (int k = 0; k < 6; ++k)
            set.free[k] =
                std::find(rigid.free.begin(), rigid.free.end(), freedom[k]) != rigid.free.end();
        if (c.info.dimension == 2 && (set.free[1] || set.free[3] || set.free[5]))
            throw InputError("fem.rigid \"" + rigid.name +
                             "\": in a 2D case a body moves in the x-z plane only; set free = "
                             "[\"x\", \"z\", \"ry\"] or fewer.");
        for (std::int32_t e : set.elements) {
            if (body_of[e] >= 0)
                throw InputError("fem.rigid: " + mesh.element_name(e) + " belongs to both \"" +
                                 bodies[body_of[e]].name + "\" and \"" + rigid.name + "\".");
            body_of[e] = int(bodies.size());
        }
        weigh(c, mesh, part_of, set);
        bodies.push_back(std::move(set));
    }
    check_owners(mesh, bodies, body_of);
    for (Part& part : parts)
        part.elements.erase(std::remove_if(part.elements.begin(), part.elements.end(),
                                           [&](std::int32_t e) { return body_of[e] >= 0; }),
                            part.elements.end());
    return bodies;
}

void leave_rigid_nodes(std::vector<Support>& supports, const std::vector<RigidSet>& bodies) {
    for (const RigidSet& body : bodies)
        for (Support& support : supports) {
            std::vector<std::int32_t> others;
            std::set_difference(support.nodes.begin(), support.nodes.end(), body.nodes.begin(),
                                body.nodes.end(), std::back_inserter(others));
            if (others.size() == support.nodes.size()) continue;
            for (int d = 0; d < 3; ++d) {
                // turning about either of the other axes moves a node along d
                const bool moves =
                    body.free[d] || body.free[3 + (d + 1) % 3] || body.free[3 + (d + 2) % 3] ||
                    body.driven[d] || body.turn_driven;
                if (support.fixed[d] && moves)
                    throw InputError(
                        "fem.support \"" + support.name + "\" fixes " + freedom[d] +
                        " of nodes of the rigid body \"" + body.name +
                        "\", which can move there; take them out of the set, or hold the body by "
                        "fem.rigid's free (half a body at a plane of symmetry y = 0: [\"x\", "
                        "\"z\", \"ry\"]).");
            }
            support.nodes = std::move(others);
        }
}

}  // namespace undertow::fem
