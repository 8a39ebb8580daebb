#pragma once
// The factors of M + kappa K, and accelerations from forces.

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "fem_solver/implicit/stiffness_matrix.hpp"

namespace undertow::fem {

class InertiaFactor {
 public:
    /// For matrices with the pattern of `k`.
    explicit InertiaFactor(const BlockMatrix& k);

    /// L D L^T = diag(mass) + kappa K; `mass` [kg] of each row of blocks, kappa [s2]. False when
    /// the matrix is not positive definite.
    bool factorize(const BlockMatrix& k, const std::vector<double>& mass, double kappa);
    /// b -> (M + kappa K)^-1 b in place, (3 rows).
    void solve(std::vector<double>& b) const;

    std::int64_t nonzeros() const { return nonzeros_; }  // of L

 private:
    using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
    Matrix sum_;  // M + kappa K, lower triangle
    Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt_;
    std::int64_t nonzeros_ = 0;
};

}  // namespace undertow::fem
