#pragma once
// How far elements have turned and strained since the stiffness was assembled in their shape.

#include <array>
#include <cstdint>
#include <vector>

#include "fem_solver/implicit/turning_bodies.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

class ShapeWatch {
 public:
    ShapeWatch(const Mesh& mesh, const std::vector<std::int32_t>& elements,
               const TurningBodies& bodies);

    /// Changes count from the shape x [m].
    void accept(const NodeRows& x);
    /// Largest |X_k - R X_k'|/|X_k'| of any element and any of its three linear modes X_k (the
    /// edges of its mean parallelepiped), X' the accepted ones and R the turn of its body: an
    /// angle, or a strain.
    double largest_change(const NodeRows& x, const TurningBodies& bodies) const;
    void archive(Archive& a);

 private:
    using Axes = std::array<std::array<double, 3>, 3>;  // [m] linear modes
    static Axes axes_of(const Hexahedron& node, const NodeRows& x);

    std::vector<Hexahedron> element_;
    std::vector<std::int32_t> body_;  // [elements], -1 when all nodes are held
    std::vector<Axes> accepted_;
};

}  // namespace undertow::fem
