#pragma once
// All announced surface meshes as one: the order in which STATE carries their nodes.

#include <cstdint>
#include <string>
#include <vector>

#include "wire/messages.hpp"

namespace undertow::coupler {

struct JointSurface {
    std::vector<double> x;            // [m] (N, 3)
    std::vector<double> mass;         // [kg] (N)
    std::vector<std::int32_t> quad;   // (F, 4)
    std::vector<std::int32_t> group;  // (F) index into names
    std::vector<std::string> names;   // of the coupled surfaces, each once
};

/// Joins and checks them. Throws PeerError E_MESH naming mesh and facet: no area, not convex,
/// turned over; a shell's thickness, which this contact does not know.
JointSurface join_surfaces(const std::vector<wire::Mesh>& meshes);

}  // namespace undertow::coupler
