#include "fem_solver/setup/rigid_shell_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

// Of the sum of areas around a node: below this the shells there look against each other. A corner
// of three faces at right angles has 0.58.
constexpr double least_agreement = 0.3;

/// Half of the diagonals' product: area times normal [m2].
Vec3 area_of(const Mesh& mesh, const Quad& q) {
    Vec3 a, b, n;
    for (int d = 0; d < 3; ++d) {
        a[d] = mesh.x[q[2]][d] - mesh.x[q[0]][d];
        b[d] = mesh.x[q[3]][d] - mesh.x[q[1]][d];
    }
    for (int d = 0; d < 3; ++d)
        n[d] = 0.5 * (a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3]);
    return n;
}
double length(const Vec3& a) {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

struct RigidShell {
    int body;
    double thickness;  // [m]
};

/// The shells of rigid bodies, by sorted nodes.
std::map<Quad, RigidShell> rigid_shells(const Case& c, const Mesh& mesh,
                                        const std::vector<RigidSet>& bodies) {
    std::vector<double> thickness(mesh.n_elements(), 0.0);
    for (const FemPart& part : c.fem.part)
        for (std::int32_t e : mesh.elements_of(part.set, "fem.part")) thickness[e] = part.thickness;
    std::map<Quad, RigidShell> shells;
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::int32_t e : bodies[b].elements) {
            if (mesh.shape_of(e) != ElementShape::shell) continue;
            const std::span<const std::int32_t> n = mesh.corners(e);
            shells[sorted_facet({n[0], n[1], n[2], n[3]})] = {int(b), thickness[e]};
        }
    return shells;
}

/// A node of the middle surface, as the shells of one set around it see it.
struct Middle {
    int body = -1;
    Vec3 normal{};                       // [m2] sum of area vectors
    double area = 0;                     // [m2]
    double thickness = 0;                // [m] the largest
    std::array<std::int32_t, 2> face{};  // nodes of its + and - face
};

}  // namespace

RigidShellFaces::RigidShellFaces(const Case& c, Mesh& mesh, std::vector<RigidSet>& bodies) {
    if (mesh.shells.empty() || bodies.empty()) return;
    const std::map<Quad, RigidShell> shells = rigid_shells(c, mesh, bodies);
    if (shells.empty()) return;
    std::map<std::string, std::string> wanted;  // sets, and the key that names them
    for (const FemContact& contact : c.fem.contact) wanted[contact.surface] = "fem.contact surface";
    for (const FemSurface& surface : c.fem.surface) wanted[surface.set] = "fem.surface";

    std::map<std::string, std::map<std::int32_t, Middle>> middles;
    std::map<std::int32_t, int> pairs;  // of faces at a node of a middle surface
    for (const auto& [set, key] : wanted)
        for (const Quad& q : mesh.facets_of(set, key)) {
            const auto shell = shells.find(sorted_facet(q));
            if (shell == shells.end()) continue;
            if (c.fem.water && key == "fem.surface")
                throw InputError("fem.surface: set = \"" + set +
                                 "\" is of shells, which have water on both faces; [fem.water] is "
                                 "for solids with submerged weights: take it out.");
            const Vec3 area = area_of(mesh, q);
            for (std::int32_t n : q) {
                Middle& middle = middles[set][n];
                if (middle.body < 0) ++pairs[n];
                middle.body = shell->second.body;
                middle.thickness = std::max(middle.thickness, shell->second.thickness);
                middle.area += length(area);
                for (int d = 0; d < 3; ++d) middle.normal[d] += area[d];
            }
        }

    for (auto& [set, of_set] : middles)
        for (auto& [n, middle] : of_set) {
            const double agreement = length(middle.normal);
            if (!(agreement > least_agreement * middle.area))
                throw InputError(wanted[set] + ": shells of \"" + set +
                                 "\" look against each other at " + point_text(mesh.x[n]) +
                                 "; turn them alike in the mesh, or make sets of those that do.");
            RigidSet& body = bodies[middle.body];
            const std::size_t at = std::size_t(
                std::lower_bound(body.nodes.begin(), body.nodes.end(), n) - body.nodes.begin());
            const double share = 0.5 * body.shell_mass[at] / pairs[n];
            for (int side = 0; side < 2; ++side) {
                Vec3 x = mesh.x[n];
                for (int d = 0; d < 3; ++d)
                    x[d] +=
                        (side == 0 ? 0.5 : -0.5) * middle.thickness * middle.normal[d] / agreement;
                middle.face[side] = std::int32_t(mesh.x.size());
                mesh.x.push_back(x);
                body.nodes.push_back(middle.face[side]);
                body.mass.push_back(share);
                body.mass[at] -= share;
            }
        }

    for (const auto& [set, of_set] : middles) {
        std::vector<Quad>& facets = facets_[set];
        std::vector<std::int32_t>& opposite = opposite_[set];
        for (const Quad& q : mesh.facets_of(set, wanted[set])) {
            if (shells.count(sorted_facet(q)) == 0) {
                facets.push_back(q);
                opposite.push_back(-1);
                continue;
            }
            Quad above, below;
            for (int k = 0; k < 4; ++k) {
                above[k] = of_set.at(q[k]).face[0];
                below[k] = of_set.at(q[(4 - k) % 4]).face[1];
            }
            opposite.push_back(std::int32_t(facets.size() + 1));
            opposite.push_back(std::int32_t(facets.size()));
            facets.push_back(above);
            facets.push_back(below);
        }
    }
}

const std::vector<Quad>& RigidShellFaces::facets_of(const Mesh& mesh, const std::string& set,
                                                    const std::string& key) const {
    const auto found = facets_.find(set);
    return found == facets_.end() ? mesh.facets_of(set, key) : found->second;
}

std::vector<std::int32_t> RigidShellFaces::opposites_of(const std::string& set) const {
    const auto found = opposite_.find(set);
    return found == opposite_.end() ? std::vector<std::int32_t>{} : found->second;
}

}  // namespace undertow::fem
