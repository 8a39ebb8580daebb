#pragma once
// The mesh: nodes, elements and named sets, as they come from a block or a mesh file.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow::fem {

using Quad = std::array<std::int32_t, 4>;  // nodes, counter-clockwise seen from outside; a triangle
                                           // repeats its third
using Hexahedron = std::array<std::int32_t, 8>;   // nodes in the order of VTK and Gmsh
using Tetrahedron = std::array<std::int32_t, 4>;  // the same

enum class ElementShape { hexahedron, tetrahedron, shell };

struct Mesh {
    std::string source;    // "[fem.block]" or the file, for messages
    std::vector<Vec3> x;   // [m] undeformed, [n_nodes]
    // Elements are numbered in this order:
    std::vector<Hexahedron> hexahedra;
    std::vector<Tetrahedron> tetrahedra;
    std::vector<Quad> shells;               // four nodes each
    std::vector<std::int64_t> element_tag;  // the file's element numbers; a block counts from 1
    std::map<std::string, std::vector<std::int32_t>> volume_sets;  // elements
    std::map<std::string, std::vector<Quad>> facet_sets;           // outer skin, normals outward
    std::map<std::string, std::vector<std::int32_t>> node_sets;    // nodes of points and curves
    // Sets of the file that are not what their name is used for, and why: told when a case does.
    std::map<std::string, std::string> refused_sets;
    std::vector<std::string> remarks;  // of the file's reader and of the set-up, for the log

    /// Nodes of a node, facet or volume set, increasing. InputError if there is no such set; `key`
    /// says where the name was given ("fem.support").
    std::vector<std::int32_t> nodes_of(const std::string& set, const std::string& key) const;
    /// InputError if there is no such facet set, listing those there are.
    const std::vector<Quad>& facets_of(const std::string& set, const std::string& key) const;
    const std::vector<std::int32_t>& elements_of(const std::string& set,
                                                 const std::string& key) const;

    std::size_t n_elements() const { return hexahedra.size() + tetrahedra.size() + shells.size(); }
    ElementShape shape_of(std::size_t element) const;
    std::span<const std::int32_t> corners(std::size_t element) const;
    /// "hexahedron 17"
    std::string element_name(std::size_t element) const;
};

/// "hexahedron"
const char* name_of(ElementShape shape);

/// [m] z of an element's center, the mean of its corners
double height_of(const Mesh& mesh, std::size_t element);

/// "(0.1, 0, -2) m", for messages
std::string point_text(const Vec3& x);

/// Faces of a hexahedron, counter-clockwise seen from outside: xi-, xi+, eta-, eta+, zeta-, zeta+.
inline constexpr int hexahedron_face[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                              {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
/// Faces of a tetrahedron, each opposite to the corner of its number.
inline constexpr int tetrahedron_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/// Calls each(element, face) for the faces of all solid elements; a face between two comes twice.
template <class Each>
void for_each_face(const Mesh& mesh, Each&& each) {
    for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) {
        const Hexahedron& h = mesh.hexahedra[e];
        for (const auto& n : hexahedron_face) each(e, Quad{h[n[0]], h[n[1]], h[n[2]], h[n[3]]});
    }
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        const Tetrahedron& t = mesh.tetrahedra[e];
        for (const auto& n : tetrahedron_face)
            each(mesh.hexahedra.size() + e, Quad{t[n[0]], t[n[1]], t[n[2]], t[n[2]]});
    }
}

/// A facet's corners, each once: three of a triangle.
inline std::span<const std::int32_t> corners_of(const Quad& facet) {
    return {facet.data(), facet[2] == facet[3] ? 3u : 4u};
}
/// The same facet whichever way it was written: its nodes in order.
Quad sorted_facet(Quad facet);

}  // namespace undertow::fem
