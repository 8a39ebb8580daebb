#pragma once
// Is what a participant announces and probes usable at all? Geometry (flat or inverted facets) is
// the contact's business.

#include "wire/messages.hpp"

namespace undertow::wire {

/// Throws PeerError E_MESH naming the facet or the group, or E_NONFINITE naming the node whose mass
/// is not > 0, or the radius of particles.
void check_mesh(const Mesh& mesh, const std::string& role);

/// Throws PeerError E_NONFINITE naming the particle whose mass or radius is not > 0 or whose
/// stiffness is negative, or E_MESH when a radius or a phase is not what `mesh` announced.
void check_probe(const Probe& probe, const Mesh& mesh);

}  // namespace undertow::wire
