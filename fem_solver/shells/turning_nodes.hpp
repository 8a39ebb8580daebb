#pragma once
// Nodes that turn: angular velocities of the nodes that shells hang on, and their
// central-difference update.
//
//     omega^{n+1/2} = omega^{n-1/2} + (M^n / J) (dt^{n-1} + dt^n)/2
//
// J is the same about every axis, so that no frame needs to be followed. Rotations themselves are
// not needed: shells take their increments.

#include <cstdint>
#include <vector>

#include "fem_solver/nodes.hpp"

namespace undertow::fem {

struct TurningNodes {
    std::vector<std::int32_t> node;  // of the mesh, increasing
    NodeRows omega;                  // [rad/s] at n - 1/2
    NodeRows moment;                 // [N m] minus internal moments at n
    NodeRows inverse_inertia;        // [1/(kg m2)] per direction; 0 where a support holds it
    std::vector<double> inertia;     // [kg m2]

    std::size_t size() const { return node.size(); }
    std::int32_t index_of(std::int32_t node_of_mesh) const;  // -1: does not turn

    /// The report has the kinetic energy of turning and its damping.
    KickReport kick(const Kick& step, int threads);
    void clear_moments(int threads = 1);
    void stop();
    /// No turn about x, y or z (0, 1, 2) of a node of the mesh; nothing where it does not turn.
    void hold(std::int32_t node_of_mesh, int axis);
    void archive(Archive& a);

 private:
    KickReport kick_block(const Kick& step, std::size_t first, std::size_t last);
};

/// At rest; inertia [kg m2] of each, in the order of `node`.
TurningNodes make_turning_nodes(std::vector<std::int32_t> node, std::vector<double> inertia);

}  // namespace undertow::fem
