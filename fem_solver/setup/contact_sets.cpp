#include "fem_solver/setup/contact_sets.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "fem_solver/setup/coupled_surface.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

// Of the sum of areas around a node: below this the shells there look against each other. A corner
// of three faces at right angles has 0.58.
constexpr double least_agreement = 0.3;

/// Half of the diagonals' product: area times normal [m2].
Vec3 area_vector(const Mesh& mesh, const Quad& q) {
    double a[3], b[3];
    for (int d = 0; d < 3; ++d) {
        a[d] = mesh.x[q[2]][d] - mesh.x[q[0]][d];
        b[d] = mesh.x[q[3]][d] - mesh.x[q[1]][d];
    }
    return {0.5 * (a[1] * b[2] - a[2] * b[1]), 0.5 * (a[2] * b[0] - a[0] * b[2]),
            0.5 * (a[0] * b[1] - a[1] * b[0])};
}
double length(const Vec3& a) {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}
double area_of(const Mesh& mesh, const Quad& q) {
    return length(area_vector(mesh, q));
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

/// [Pa] adhesion_factor s_u behind a facet, at the facet's own height; element -1: of a shell.
double adhesion(const FemContact& contact, const Mesh& mesh, const Soil& soil, const Quad& facet,
                std::int32_t element) {
    const std::span<const std::int32_t> corners = corners_of(facet);
    double z = 0;
    for (std::int32_t n : corners) z += mesh.x[n][2] / double(corners.size());
    if (element >= 0) {
        const Material law = law_at(soil.parts[soil.part[element]].material, z);
        if (const Tresca* clay = std::get_if<Tresca>(&law))
            return contact.adhesion_factor * clay->shear_strength;
    }
    throw InputError("fem.contact \"" + contact.name +
                     "\": adhesion_factor is a share of the shear strength of the soil, but the "
                     "material behind nodes = \"" + contact.nodes + "\" at " + point_text(mesh.x[facet[0]]) +
                     " is not of kind = \"tresca\"; give max_shear instead.");
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

/// Whether the facets are shells that deform; InputError if only some of them are, or if they look
/// against each other.
bool are_shells(const std::vector<Quad>& facets, const std::map<Quad, double>& shells,
                const Mesh& mesh, const std::string& name, const std::string& set) {
    std::size_t count = 0;
    struct Sum {
        Vec3 normal{};    // [m2]
        double area = 0;  // [m2]
    };
    std::map<std::int32_t, Sum> at;
    for (const Quad& q : facets) {
        if (shells.count(sorted_facet(q)) == 0) continue;
        ++count;
        const Vec3 area = area_vector(mesh, q);
        for (std::int32_t n : q) {
            at[n].area += length(area);
            for (int d = 0; d < 3; ++d) at[n].normal[d] += area[d];
        }
    }
    if (count == 0) return false;
    if (count < facets.size())
        throw InputError(name + ": \"" + set +
                         "\" holds shells that deform and other facets; make one contact for the "
                         "shells and one for the others.");
    for (const auto& [n, sum] : at)
        if (!(length(sum.normal) > least_agreement * sum.area))
            throw InputError(name + ": shells of \"" + set + "\" look against each other at " +
                             point_text(mesh.x[n]) +
                             "; turn them alike in the mesh, or make one contact for each side.");
    return true;
}

/// Both faces of shells that deform in the place of each.
void put_faces(ContactSet& set, const std::map<Quad, double>& shells) {
    set.surface_faces =
        lay_out_faces(set.surface, std::vector<std::int32_t>(set.surface.size(), 0), shells);
    set.surface.clear();
    for (std::size_t f = 0; f < set.surface_faces.quad.size(); ++f) {
        Quad q = set.surface_faces.quad[f];
        for (std::int32_t& n : q) n = set.surface_faces.node[n];
        set.surface.push_back(q);
        set.opposite.push_back(std::int32_t(f % 2 == 0 ? f + 1 : f - 1));
    }
}

/// Largest area that belongs to a node of the surface over the smallest facet of the nodes.
double coverage_of(const Mesh& mesh, const std::vector<Quad>& surface,
                   const std::vector<Quad>& facets) {
    std::map<std::int32_t, double> at;
    double largest = 0, smallest = area_of(mesh, facets.front());
    for (const Quad& q : surface)
        for (std::int32_t n : q) largest = std::max(largest, at[n] += 0.25 * area_of(mesh, q));
    for (const Quad& q : facets) smallest = std::min(smallest, area_of(mesh, q));
    return largest / smallest;
}

ContactSet make_contact_set(const FemContact& contact, const Mesh& mesh,
                            const std::vector<RigidSet>& bodies, const RigidShellFaces& faces,
                            const std::vector<int>& body_of_node, const Soil& soil,
                            const std::map<Quad, double>& shells,
                            const std::map<Quad, double>& shell_modulus) {
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
    const bool shell_surface = are_shells(set.surface, shells, mesh, name, contact.surface);
    const bool shell_nodes = are_shells(facets, shells, mesh, name, contact.nodes);
    set.opposite = faces.opposites_of(contact.surface);
    if (shell_surface) put_faces(set, shells);
    for (const Quad& q : set.surface)
        if (q[2] == q[3])
            throw InputError(name + ": surface \"" + contact.surface + "\" has a triangle at " +
                             point_text(mesh.x[q[0]]) +
                             "; contact inside the mesh needs quads there: let the tetrahedra be "
                             "\"nodes\", or mesh that body with hexahedra.");
    set.body = body_of_surface(contact, mesh, set.surface, body_of_node, bodies);

    if (shell_nodes) {
        set.node_faces = lay_out_faces(facets, std::vector<std::int32_t>(facets.size(), 0), shells);
        set.nodes = set.node_faces.node;
    } else {
        set.nodes = mesh.nodes_of(contact.nodes, "fem.contact nodes");
    }
    set.area.resize(set.nodes.size());
    set.stiffness.resize(set.nodes.size());
    if (contact.adhesion_factor > 0) set.max_friction.resize(set.nodes.size());
    const Backers backers(mesh, facets);
    for (const Quad& q : facets) {
        const auto shell = shells.find(sorted_facet(q));
        const std::int32_t e = shell == shells.end() ? backers.of(q) : 0;
        if (e < 0 || body_of_node[q[0]] >= 0)
            throw InputError(name + ": the facet at " + point_text(mesh.x[q[0]]) +
                             " of nodes = \"" + contact.nodes +
                             "\" belongs to no deformable element; let the soil's facets be "
                             "\"nodes\" and the rigid body's \"surface\".");
        const std::span<const std::int32_t> corners = corners_of(q);
        const double share = area_of(mesh, q) / double(corners.size());
        // a shell's springs yield a tenth of what its thickness would
        const double depth = shell == shells.end() ? depth_of(mesh, q, mesh.corners(e))
                                                   : shell->second;
        const double E =
            shell == shells.end() ? soil.modulus[e] : shell_modulus.at(sorted_facet(q));
        const double shear =
            contact.adhesion_factor > 0
                ? adhesion(contact, mesh, soil, q, shell == shells.end() ? e : -1)
                : 0;
        for (std::int32_t n : corners) {
            const auto [from, to] = std::equal_range(set.nodes.begin(), set.nodes.end(), n);
            for (auto i = from; i < to; ++i) {
                set.area[std::size_t(i - set.nodes.begin())] += share;
                set.stiffness[std::size_t(i - set.nodes.begin())] += E * share / depth;
                if (contact.adhesion_factor > 0)
                    set.max_friction[std::size_t(i - set.nodes.begin())] += shear * share;
            }
        }
    }
    if (contact.max_shear > 0)
        for (double area : set.area) set.max_friction.push_back(contact.max_shear * area);
    set.coverage = coverage_of(mesh, set.surface, facets);
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
    const std::map<Quad, double> shells = shell_thicknesses(mesh, parts);
    std::map<Quad, double> shell_modulus;
    for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
        if (mesh.shape_of(std::int32_t(e)) != ElementShape::shell) continue;
        const std::span<const std::int32_t> n = mesh.corners(std::int32_t(e));
        shell_modulus[sorted_facet({n[0], n[1], n[2], n[3]})] = soil.modulus[e];
    }
    for (const FemContact& contact : c.fem.contact)
        sets.push_back(make_contact_set(contact, mesh, bodies, faces, body_of_node, soil, shells,
                                        shell_modulus));
    return sets;
}

}  // namespace undertow::fem
