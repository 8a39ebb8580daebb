#pragma once
// Both faces of shells that are coupled or in contact, half a thickness off the middle surface on
// either side; a force on a face is a force and a moment on the node between them.

#include <array>
#include <cstdint>
#include <vector>

#include "fem_solver/shells/face_layout.hpp"
#include "fem_solver/shells/turning_nodes.hpp"

namespace undertow::fem {

class ShellFaces {
 public:
    ShellFaces() = default;
    /// `faces` has offsets; turning: the nodes of the shells.
    ShellFaces(const FaceLayout& faces, const TurningNodes& turning);

    bool empty() const { return offset_.empty(); }
    /// Normals of the shape x, area-weighted means of the facets around a node.
    void follow(const NodeRows& x);

    /// [m] of node i of the surface, and [m/s] relative to the shell's node.
    Row lever(std::size_t i) const { return offset_[i] * as_row(normal_[i]); }
    /// Row of the node among those that turn; -1 of a solid.
    std::int32_t row(std::size_t i) const { return turning_[i]; }
    Row velocity(std::size_t i, const TurningNodes& turning) const;
    /// [kg] that a force on one face meets while the other is pushed alike: half of the node's,
    /// less for the turn that friction brings.
    double mass(std::size_t i, double node_mass, const TurningNodes& turning) const;

    /// Moments of the forces on the faces [N] go to the nodes that turn.
    void add_moments(const NodeRows& force, TurningNodes& turning) const;
    /// [W] of those moments.
    double power(const NodeRows& force, const TurningNodes& turning) const;

 private:
    std::vector<double> offset_;         // [m] along the normal; 0 of nodes of solids
    std::vector<std::int32_t> node_;     // of the mesh
    std::vector<std::int32_t> turning_;  // row of the node; -1: of a solid
    std::vector<std::array<std::int32_t, 4>>
        quad_;                        // indices into node_, of the faces with + offset
    std::vector<std::int32_t> twin_;  // of each node the one with the normal: itself or the + side
    NodeRows normal_;                 // unit
};

}  // namespace undertow::fem
