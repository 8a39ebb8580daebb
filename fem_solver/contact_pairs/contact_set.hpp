#pragma once
// One [[fem.contact]] with its names resolved: the nodes that touch, and what they touch.

#include <cstdint>
#include <string>
#include <vector>

#include "fem_solver/shells/face_layout.hpp"

namespace undertow::fem {

struct ContactSet {
    std::string name;
    std::vector<std::int32_t> nodes;  // of the mesh, increasing; all of deformable elements; of
                                      // shells each twice, on both faces
    std::vector<double> area;         // [m2] tributary to each node on its facet set
    std::vector<double> stiffness;    // [N/m] E A/h of the element behind each node
    std::vector<Quad> surface;        // nodes of the mesh, normals out of the solid; of shells
                                      // both faces
    FaceLayout node_faces;            // of `nodes` on shells that deform, else empty
    FaceLayout surface_faces;         // of a surface of shells that deform, else empty
    std::vector<std::int32_t> opposite;  // per facet the other face of the same shell, -1 of a
                                         // solid; empty without shells
    double coverage = 0;              // largest area at a node of the surface over the smallest
                                      // facet of `nodes`
    int body = -1;                    // index of the rigid body it belongs to, -1 = none
    double friction = 0;              // Coulomb coefficient
    std::vector<double> max_friction;  // [N] upper limit at each node; empty = none
    double gap = 0;                   // [m] distance in the mesh at which they touch
    double near = 0;                  // [m] within which nodes are kept in sight; 0 = two gaps
};

}  // namespace undertow::fem
