#pragma once
// Linear statics of shells from the kernel's own tangent: what an element converges to, without a
// time step. Six unknowns a node: three displacements, three rotations.

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <vector>

#include "fem_solver/shells/shell.hpp"

namespace undertow::fem {

struct ShellModel {
    std::vector<std::array<double, 3>> x;  // [m]
    std::vector<std::array<int, 4>> quad;  // node numbers
    double thickness = 1, young_modulus = 1, poisson_ratio = 0;
    double density = 1;

    ShellLaw law() const;
    ElasticSection section() const;
    ShellConstants<double> constants(const std::array<int, 4>& quad) const;
};

/// A grid of n_u x n_v elements over [0, 1]^2, mapped by `place`.
ShellModel shell_grid(int n_u, int n_v,
                      const std::function<std::array<double, 3>(double, double)>& place);
inline int grid_node(int n_u, int i, int j) {
    return i + (n_u + 1) * j;
}

using ElementMatrix = Eigen::Matrix<double, 24, 24>;  // 6 I + d, translations then rotations
/// Internal forces per unit displacement of the stress-free element.
ElementMatrix stiffness(const ShellModel& model, const std::array<int, 4>& quad);
/// Lumped masses and rotary inertias.
Eigen::Matrix<double, 24, 1> lumped_mass(const ShellModel& model, const std::array<int, 4>& quad);

/// Displacements under the loads, [6 n_nodes]; fixed: 6 n + d.
Eigen::VectorXd solve(const ShellModel& model, const std::vector<int>& fixed,
                      const Eigen::VectorXd& load);
/// Internal forces of displacements.
Eigen::VectorXd internal_forces(const ShellModel& model, const Eigen::VectorXd& u);

/// Of a symmetric matrix, increasing. Here, so that Eigen's solvers are compiled once.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& K);
struct PlateModes {
    Eigen::VectorXd values;   // increasing
    Eigen::MatrixXd vectors;  // in columns
};
/// K x = lambda M x.
PlateModes find_modes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

}  // namespace undertow::fem
