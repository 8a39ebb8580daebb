#pragma once
// The mesh: nodes, hexahedra and named sets, as they come from a block or a mesh file.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow::fem {

using Quad = std::array<std::int32_t, 4>;        // nodes, counter-clockwise seen from outside
using Hexahedron = std::array<std::int32_t, 8>;  // nodes in the order of VTK and Gmsh

struct Mesh {
    std::string source;                     // "[fem.block]" or the file, for messages
    std::vector<Vec3> x;                    // [m] undeformed, [n_nodes]
    std::vector<Hexahedron> hexahedra;      // [n_elements]
    std::vector<std::int64_t> element_tag;  // the file's element numbers; a block counts from 1
    std::map<std::string, std::vector<std::int32_t>> volume_sets;  // elements
    std::map<std::string, std::vector<Quad>> facet_sets;           // outer skin, normals outward
    std::map<std::string, std::vector<std::int32_t>> node_sets;    // nodes of points and curves

    /// Nodes of a node, facet or volume set, increasing. InputError if there is no such set; `key`
    /// says where the name was given ("fem.support").
    std::vector<std::int32_t> nodes_of(const std::string& set, const std::string& key) const;
    /// InputError if there is no such facet set, listing those there are.
    const std::vector<Quad>& facets_of(const std::string& set, const std::string& key) const;
    const std::vector<std::int32_t>& elements_of(const std::string& set,
                                                 const std::string& key) const;
    /// "hexahedron 17"
    std::string element_name(std::size_t element) const;
};

/// "(0.1, 0, -2) m", for messages
std::string point_text(const Vec3& x);

/// Faces of a hexahedron, counter-clockwise seen from outside: xi-, xi+, eta-, eta+, zeta-, zeta+.
inline constexpr int hexahedron_face[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                              {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};

}  // namespace undertow::fem
