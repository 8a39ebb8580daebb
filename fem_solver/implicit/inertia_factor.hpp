#pragma once
// The Cholesky factor of M + kappa K, and accelerations from forces.

#include <cstdint>
#include <vector>

#include "fem_solver/implicit/supernodes.hpp"

namespace undertow::fem {

class InertiaFactor {
 public:
    /// For matrices with the pattern of `k`.
    explicit InertiaFactor(const BlockMatrix& k);

    /// L L^T = diag(mass) + kappa K; `mass` [kg] of each row of blocks, kappa [s2]. False when the
    /// matrix is not positive definite.
    bool factorize(const BlockMatrix& k, const std::vector<double>& mass, double kappa);
    /// b -> (M + kappa K)^-1 b in place, (3 rows). Uses its own scratch space: one solve at a time.
    void solve(std::vector<double>& b);

    std::int64_t nonzeros() const { return std::int64_t(factor_.size()); }  // stored

 private:
    void assemble_front(std::size_t s, const BlockMatrix& k, const std::vector<double>& mass,
                        double kappa);
    void add_update(const Supernode& child, const std::vector<double>& update, std::size_t size);

    std::vector<Supernode> nodes_;
    std::vector<double> factor_;  // panels, by columns: triangle and rows below
    std::vector<std::vector<double>>
        update_;                       // what is left of each front until its parent takes it
    std::vector<double> front_;        // by columns, lower triangle
    std::vector<std::int32_t> place_;  // [rows] of blocks: where in the present front
    std::vector<double> below_;        // scratch of a solve
};

}  // namespace undertow::fem
