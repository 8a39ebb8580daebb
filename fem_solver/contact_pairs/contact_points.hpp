#pragma once
// Where contact takes hold of the structure: at nodes, or on both faces of shells that deform, half
// a thickness off the middle surface. A force on a face is a force and a moment on its node, and a
// face moves with its node's velocity and turn.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fem_solver/nodes.hpp"
#include "fem_solver/shells/shell_faces.hpp"

namespace undertow::fem {

class ContactPoints {
 public:
    /// Nodes of the mesh as they are.
    ContactPoints(std::vector<std::int32_t> node, const Nodes& nodes);
    /// Both faces of shells that deform.
    ContactPoints(const FaceLayout& faces, const Nodes& nodes, const TurningNodes& turning);

    std::size_t size() const { return node_.size(); }
    const std::vector<std::int32_t>& node() const { return node_; }  // of the mesh, increasing
    bool turn() const { return !faces_.empty(); }

    /// Takes positions and velocities of this step; `turning` of the shells, or none.
    void follow(const Nodes& nodes, const TurningNodes* turning);
    const std::vector<double>& x() const { return x_; }  // [m] (points, 3) at n
    const std::vector<double>& v() const { return v_; }  // [m/s] (points, 3) at n - 1/2

    /// Unit, out of the shell on the side of point i.
    Eigen::Vector3d normal(std::size_t i) const;
    /// [rad/s] of point i; 0 of a node that does not turn.
    Eigen::Vector3d turn_rate(std::size_t i, const TurningNodes* turning) const;

    /// A force [N] on point i that acts at `arm` [m] from it. Nodes that do not turn take no
    /// moment.
    void add_force(std::size_t i, const Eigen::Vector3d& force, const Eigen::Vector3d& arm,
                   Nodes& nodes, TurningNodes* turning) const;

    /// [1/kg] what the node yields to a force on point i in its easiest direction, acting no
    /// farther than `arm` [m] from the point.
    double yields(std::size_t i, double arm, const Nodes& nodes, const TurningNodes* turning) const;

 private:
    std::vector<std::int32_t> node_;
    ShellFaces faces_;            // empty without shells
    std::vector<double> offset_;  // [m] of each point; empty without shells
    std::vector<double> x_, v_;   // [m], [m/s] (points, 3)
};

}  // namespace undertow::fem
