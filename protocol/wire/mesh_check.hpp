#pragma once
// Is an announced mesh usable at all? Geometry (flat or inverted facets) is the contact's business.

#include "wire/messages.hpp"

namespace undertow::wire {

/// Throws PeerError E_MESH naming the facet or the group, or E_NONFINITE naming the node whose mass
/// is not > 0, or the radius of particles.
void check_mesh(const Mesh& mesh, const std::string& role);

}  // namespace undertow::wire
