#pragma once
// Resolves [[fem.initial_velocity]].

#include <cstdint>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/rigid/rigid_set.hpp"

namespace undertow::fem {

/// Velocities at t = 0 of nodes of the mesh, each once.
struct InitialVelocities {
    struct OfNode {
        std::int32_t node;
        Vec3 velocity, spin;  // [m/s], [rad/s] the latter of nodes of shells
    };
    struct OfBody {
        int body;             // index of the rigid body
        Vec3 velocity, spin;  // [m/s] of its center of mass, [rad/s]
    };
    std::vector<OfNode> nodes;
    std::vector<OfBody> bodies;

    bool empty() const { return nodes.empty() && bodies.empty(); }
};

/// InputError for nodes of rigid bodies or of no element, a node that is given two velocities, and
/// a case that holds the structure at first.
InitialVelocities make_initial_velocities(const Case& c, const Mesh& mesh,
                                          const std::vector<RigidSet>& bodies);

}  // namespace undertow::fem
