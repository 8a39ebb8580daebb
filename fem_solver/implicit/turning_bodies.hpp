#pragma once
// How the implicit parts turn as wholes, so that a stiffness assembled in one position serves while
// they do: a = R (M + kappa K)^-1 R^T f with R the rotation that fits a body best.
//
// A body is what hangs together. One that a support holds in single directions does not turn: the
// directions would turn with it.

#include <array>
#include <cstdint>
#include <vector>

#include "fem_solver/implicit/stiffness_matrix.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

using Rotation = std::array<double, 9>;  // row by row

class TurningBodies {
 public:
    /// Of the rows of `k`; supports are in `nodes`.
    TurningBodies(const BlockMatrix& k, const Nodes& nodes);

    /// Rotations count from the shape x [m].
    void accept(const NodeRows& x);
    /// Least squares over the nodes, weighted by mass, of x - center against the accepted ones.
    void find(const NodeRows& x);

    /// a -> R^T a and a -> R a for every row's body, (3 rows).
    void turn_back(std::vector<double>& a) const;
    void turn(std::vector<double>& a) const;

    void archive(Archive& a);
    const Rotation& rotation(std::int32_t body) const { return body_[body].rotation; }
    /// [n_nodes] the body of a node of the mesh, or -1.
    const std::vector<std::int32_t>& body_of_node() const { return body_of_node_; }

 private:
    struct Body {
        std::vector<std::int32_t> row;
        std::vector<std::array<double, 3>> x;  // [m] accepted, from their center
        double mass = 0;                       // [kg] of its rows
        bool turns = true;
        Rotation rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
    };
    std::array<double, 3> center(const Body& body, const NodeRows& x) const;

    std::vector<Body> body_;
    std::vector<std::int32_t> body_of_node_;
    std::vector<std::int32_t> node_;  // [rows] of the mesh
    std::vector<double> mass_;        // [kg, rows]
};

}  // namespace undertow::fem
