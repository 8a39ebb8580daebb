#pragma once
// Force and moment that one group of elements exerts on the rest, where they share nodes.
//
// Internal forces of any element are in equilibrium: those of the group add up to nothing, in force
// and moment. So what it puts on the shared nodes is minus what it puts on the nodes that are its
// own, and there the sum over all elements is that of the group alone. Nothing is integrated over
// stresses; hourglass and viscous forces are in it.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fem_solver/mesh.hpp"
#include "fem_solver/nodes.hpp"
#include "fem_solver/rigid/rigid_body.hpp"
#include "fem_solver/shells/turning_nodes.hpp"

namespace undertow::fem {

class SectionForce {
 public:
    /// `elements` of the mesh; moments about `point` [m], fixed in space. InputError when the group
    /// shares no node with the rest, or has none of its own; `where` for messages.
    SectionForce(const Mesh& mesh, const std::vector<std::int32_t>& elements, const Vec3& point,
                 const std::string& where);

    /// f [N] holds minus the internal forces and nothing else; `turning` may be null.
    void measure(const NodeRows& x, const NodeRows& f, const TurningNodes* turning);
    /// Of the group on the rest, at the last measure.
    const Wrench& force() const { return force_; }

    void archive(Archive& a);
    std::size_t shared_nodes() const { return shared_; }

 private:
    std::vector<std::int32_t> node_;  // that are summed: of the group alone, or all others if fewer
    double sign_ = -1;                // +1 when they are the others
    Vec3 point_;
    std::size_t shared_ = 0;
    Wrench force_;
};

}  // namespace undertow::fem
