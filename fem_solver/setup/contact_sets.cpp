#include "fem_solver/setup/contact_sets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

double area_of(const Mesh& mesh, const Quad& q) {
    double a[3], b[3];
    for (int d = 0; d < 3; ++d) {
        a[d] = mesh.x[q[2]][d] - mesh.x[q[0]][d];
        b[d] = mesh.x[q[3]][d] - mesh.x[q[1]][d];
    }
    return 0.5 * std::sqrt(std::pow(a[1] * b[2] - a[2] * b[1], 2) +
                           std::pow(a[2] * b[0] - a[0] * b[2], 2) +
                           std::pow(a[0] * b[1] - a[1] * b[0], 2));
}

/// The element of each facet: by its sorted nodes.
class Backers {
 public:
    Backers(const Mesh& mesh, const std::vector<Quad>& facets) {
        for (const Quad& q : facets) element_[sorted_facet(q)] = -1;
        for_each_face(mesh, [&](std::size_t e, const Quad& face) {
            const auto found = element_.find(sorted_facet(face));
            if (found != element_.end()) found->second = std::int32_t(e);
        });
    }
    std::int32_t of(const Quad& q) const {  // -1: of no element
        return element_.at(sorted_facet(q));
    }

 private:
    std::map<Quad, std::int32_t> element_;
};

/// Distance [m] from the facet to what lies opposite in its element, between the means of corners.
double depth_of(const Mesh& mesh, const Quad& facet, std::span<const std::int32_t> element) {
    const std::span<const std::int32_t> corners = corners_of(facet);
    const double on = double(corners.size()), off = double(element.size()) - on;
    Vec3 of_facet{}, of_rest{};
    for (std::int32_t n : element) {
        const bool on_facet = std::find(corners.begin(), corners.end(), n) != corners.end();
        for (int d = 0; d < 3; ++d)
            (on_facet ? of_facet : of_rest)[d] += mesh.x[n][d] / (on_facet ? on : off);
    }
    double squared = 0;
    for (int d = 0; d < 3; ++d) squared += std::pow(of_facet[d] - of_rest[d], 2);
    return std::sqrt(squared);
}

/// What contact has to know of the soil.
struct Soil {
    std::vector<double> modulus;  // [Pa] Young's, of each element
    std::vector<int> part;        // of each element, index into `parts`; -1: none
    const std::vector<Part>& parts;

    Soil(const FemSettings& fem, const Mesh& mesh, const std::vector<Part>& all)
        : modulus(mesh.n_elements(), 0.0), part(mesh.n_elements(), -1), parts(all) {
        for (std::size_t p = 0; p < parts.size(); ++p) {
            const FemMaterial& material =
                *std::find_if(fem.material.begin(), fem.material.end(),
                              [&](const auto& m) { return m.name == fem.part[p].material; });
            for (std::int32_t e : parts[p].elements) {
                part[e] = int(p);
                modulus[e] = material.modulus_ratio > 0
                                 ? material.modulus_ratio *
                                       strength_at(parts[p].material, height_of(mesh, e))
                                 : material.young_modulus;
            }
        }
    }
};

/// [Pa] adhesion_factor s_u behind a facet, at the facet's own height.
double adhesion(const FemContact& contact, const Mesh& mesh, const Soil& soil, const Quad& facet,
                std::int32_t element) {
    const Part& part = soil.parts[soil.part[element]];
    const std::span<const std::int32_t> corners = corners_of(facet);
    double z = 0;
    for (std::int32_t n : corners) z += mesh.x[n][2] / double(corners.size());
    const Material law = law_at(part.material, z);
    const Tresca* clay = std::get_if<Tresca>(&law);
    if (!clay)
        throw InputError("fem.contact \"" + contact.name +
                         "\": adhesion_factor is a share of the shear strength of the soil, but part \"" +
                         part.name + "\" behind nodes = \"" + contact.nodes +
                         "\" is not of kind = \"tresca\"; give max_shear instead.");
    return contact.adhesion_factor * clay->shear_strength;
}

int body_of_surface(const FemContact& contact, const Mesh& mesh, const std::vector<Quad>& facets,
                    const std::vector<int>& body_of_node, const std::vector<RigidSet>& bodies) {
    const int body = body_of_node[facets.front()[0]];
    for (const Quad& q : facets)
        for (std::int32_t n : q)
            if (body_of_node[n] != body) {
                const int named = std::max(body, body_of_node[n]);
                throw InputError("fem.contact \"" + contact.name + "\": surface \"" +
                                 contact.surface + "\" lies only partly on the rigid body \"" +
                                 bodies[named].name + "\" (see the node at " +
                                 point_text(mesh.x[n]) + "); make one contact per body.");
            }
    return body;
}

ContactSet make_contact_set(const FemContact& contact, const Mesh& mesh,
                            const std::vector<RigidSet>& bodies, const RigidShellFaces& faces,
                            const std::vector<int>& body_of_node, const Soil& soil) {
    const std::string name = "fem.contact \"" + contact.name + "\"";
    ContactSet set;
    set.name = contact.name;
    set.friction = contact.friction;
    set.gap = contact.gap;
    set.near = contact.near;
    set.surface = faces.facets_of(mesh, contact.surface, "fem.contact surface");
    const std::vector<Quad>& facets = mesh.facets_of(contact.nodes, "fem.contact nodes");
    if (set.surface.empty() || facets.empty())
        throw InputError(name + ": the facet set \"" +
                         (facets.empty() ? contact.nodes : contact.surface) + "\" is empty.");
    for (const Quad& q : set.surface)
        if (q[2] == q[3])
            throw InputError(name + ": surface \"" + contact.surface + "\" has a triangle at " +
                             point_text(mesh.x[q[0]]) +
                             "; contact inside the mesh needs quads there: let the tetrahedra be "
                             "\"nodes\", or mesh that body with hexahedra.");
    set.body = body_of_surface(contact, mesh, set.surface, body_of_node, bodies);

    set.nodes = mesh.nodes_of(contact.nodes, "fem.contact nodes");
    set.area.resize(set.nodes.size());
    set.stiffness.resize(set.nodes.size());
    if (contact.adhesion_factor > 0) set.max_friction.resize(set.nodes.size());
    const auto index = [&](std::int32_t n) {
        return std::size_t(std::lower_bound(set.nodes.begin(), set.nodes.end(), n) -
                           set.nodes.begin());
    };
    const Backers backers(mesh, facets);
    for (const Quad& q : facets) {
        const std::int32_t e = backers.of(q);
        if (e < 0 || body_of_node[q[0]] >= 0)
            throw InputError(name + ": the facet at " + point_text(mesh.x[q[0]]) +
                             " of nodes = \"" + contact.nodes +
                             "\" belongs to no deformable element; let the soil's facets be "
                             "\"nodes\" and the rigid body's \"surface\".");
        const double area = area_of(mesh, q), depth = depth_of(mesh, q, mesh.corners(e));
        const std::span<const std::int32_t> corners = corners_of(q);
        const double share = area / double(corners.size());
        for (std::int32_t n : corners) {
            set.area[index(n)] += share;
            set.stiffness[index(n)] += soil.modulus[e] * share / depth;
        }
        if (contact.adhesion_factor > 0) {
            const double shear = adhesion(contact, mesh, soil, q, e);
            for (std::int32_t n : corners) set.max_friction[index(n)] += shear * share;
        }
    }
    if (contact.max_shear > 0)
        for (double area : set.area) set.max_friction.push_back(contact.max_shear * area);
    std::set<Quad> shells;
    for (const Quad& shell : mesh.shells) shells.insert(sorted_facet(shell));
    for (const Quad& q : set.surface)
        if (shells.count(sorted_facet(q)) > 0)
                throw InputError(name + ": surface = \"" + contact.surface +
                                 "\" is of shells that deform; contact inside the mesh is between faces "
                                 "of solids and rigid bodies: make the shells a [[fem.rigid]], or "
                                 "mesh that part with hexahedra.");
    for (const Quad& q : set.surface)
        for (std::int32_t n : q)
            if (std::binary_search(set.nodes.begin(), set.nodes.end(), n))
                throw InputError(name + ": \"" + contact.nodes + "\" and \"" + contact.surface +
                                 "\" share the node at " + point_text(mesh.x[n]) +
                                 "; the mesh must leave the gap of " + number_text(contact.gap) +
                                 " m between them.");
    return set;
}

}  // namespace

std::vector<ContactSet> make_contact_sets(const Case& c, const Mesh& mesh,
                                          const std::vector<Part>& parts,
                                          const std::vector<RigidSet>& bodies,
                                          const RigidShellFaces& faces) {
    std::vector<ContactSet> sets;
    if (c.fem.contact.empty()) return sets;
    std::vector<int> body_of_node(mesh.x.size(), -1);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::int32_t n : bodies[b].nodes) body_of_node[n] = int(b);
    const Soil soil(c.fem, mesh, parts);
    for (const FemContact& contact : c.fem.contact)
        sets.push_back(make_contact_set(contact, mesh, bodies, faces, body_of_node, soil));
    return sets;
}

}  // namespace undertow::fem
