#pragma once
// Is the mesh fit to compute with? Asked once, at the start.

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

struct MeshQuality {
    double worst_aspect = 1;  // longest over shortest edge of an element; of a tetrahedron longest
                              // edge over smallest height, 1 when regular
    std::size_t worst_aspect_element = 0;
    double worst_corner = 1;  // smallest corner Jacobian over the element's mean
    std::size_t worst_corner_element = 0;
};

/// InputError that names the first inverted or degenerate element, and how many there are.
MeshQuality check_mesh(const Mesh& mesh);

}  // namespace undertow::fem
