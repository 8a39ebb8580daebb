#include "fem_solver/setup/coupled_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "fem_solver/boundary/facet_nodes.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

/// A node of the surface: of a solid (side 0), or on the + or - face of the shells of a surface.
/// Shells of different surfaces have faces of their own, so that edges where they meet stay apart.
using FaceNode = std::tuple<std::int32_t, int, std::int32_t>;  // node, side, surface

}  // namespace

std::map<Quad, double> shell_thicknesses(const Mesh& mesh, const std::vector<Part>& parts) {
    std::map<Quad, double> thickness;
    for (const Part& part : parts)
        for (std::int32_t e : part.elements) {
            if (mesh.shape_of(e) != ElementShape::shell) continue;
            const std::span<const std::int32_t> n = mesh.corners(e);
            thickness[sorted_facet({n[0], n[1], n[2], n[3]})] = part.thickness;
        }
    return thickness;
}

FaceLayout lay_out_faces(const std::vector<Quad>& facets, const std::vector<std::int32_t>& surface,
                         const std::map<Quad, double>& shells) {
    FaceLayout faces;
    std::vector<std::array<FaceNode, 4>> corners;
    std::map<FaceNode, double> offset;  // [m] the largest of the shells around a node
    for (std::size_t f = 0; f < facets.size(); ++f) {
        const Quad& q = facets[f];
        const auto shell = shells.find(sorted_facet(q));
        for (int side : {1, -1}) {
            std::array<FaceNode, 4> face;
            for (int k = 0; k < 4; ++k) {
                const std::int32_t n = q[side > 0 ? k : (4 - k) % 4];
                face[k] = shell == shells.end() ? FaceNode{n, 0, -1} : FaceNode{n, side, surface[f]};
                double& d = offset[face[k]];
                if (shell != shells.end()) d = side * std::max(std::abs(d), 0.5 * shell->second);
            }
            corners.push_back(face);
            if (shell == shells.end()) break;  // a solid has one face
        }
    }
    std::map<FaceNode, std::int32_t> index;
    for (const auto& [node, d] : offset) {  // by node of the mesh
        index[node] = std::int32_t(faces.node.size());
        faces.node.push_back(std::get<0>(node));
        faces.offset.push_back(d);
    }
    for (const auto& face : corners) {
        Quad q;
        for (int k = 0; k < 4; ++k) q[k] = index.at(face[k]);
        faces.quad.push_back(q);
    }
    for (const auto& [node, d] : offset)
        faces.twin.push_back(
            index.at({std::get<0>(node), std::abs(std::get<1>(node)), std::get<2>(node)}));
    if (std::all_of(faces.offset.begin(), faces.offset.end(), [](double d) { return d == 0; }))
        faces.offset = {}, faces.twin = {};
    return faces;
}

CoupledSurface make_coupled_surface(const Case& c, const Mesh& mesh,
                                    const std::vector<Part>& parts,
                                    const RigidShellFaces& faces) {
    CoupledSurface surface;
    const std::map<Quad, double> shells = shell_thicknesses(mesh, parts);
    std::vector<Quad> all;
    std::vector<std::int32_t> of;  // surface of each
    for (const FemSurface& s : c.fem.surface) {
        const std::int32_t number = std::int32_t(surface.names.size());
        std::size_t of_shells = 0;
        const std::vector<Quad>& facets = faces.facets_of(mesh, s.set, "fem.surface");
        for (const Quad& q : facets) {
            const bool is_shell = shells.count(sorted_facet(q)) > 0;
            of_shells += is_shell;
            all.push_back(q);
            of.push_back(number);
            surface.group.insert(surface.group.end(), is_shell ? 2 : 1, number);
        }
        if (of_shells > 0 && of_shells < facets.size())
            throw InputError(
                "fem.surface \"" + s.name + "\": set = \"" + s.set +
                "\" holds shells and faces of solids; give each a surface of its own.");
        if (of_shells > 0 && c.fem.water)
            throw InputError("fem.surface \"" + s.name +
                             "\" is of shells, which have water on both faces; [fem.water] is for "
                             "solids with submerged weights: take it out.");
        surface.names.push_back(s.name);
    }
    static_cast<FaceLayout&>(surface) = lay_out_faces(all, of, shells);
    return surface;
}

}  // namespace undertow::fem
