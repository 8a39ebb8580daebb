#include "fem_solver/implicit/inertia_factor.hpp"

namespace undertow::fem {

InertiaFactor::InertiaFactor(const BlockMatrix& k) {
    const int n = int(3 * k.rows());
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(9 * k.row.size());
    for (std::size_t j = 0; j < k.rows(); ++j)
        for (std::int32_t p = k.begin[j]; p < k.begin[j + 1]; ++p)
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r)
                    if (3 * k.row[p] + r >= int(3 * j) + c)
                        entries.emplace_back(3 * k.row[p] + r, int(3 * j) + c, 1.0);
    sum_.resize(n, n);
    sum_.setFromTriplets(entries.begin(), entries.end());
    sum_.makeCompressed();
    ldlt_.analyzePattern(sum_);
}

bool InertiaFactor::factorize(const BlockMatrix& k, const std::vector<double>& mass, double kappa) {
    double* value = sum_.valuePtr();
    for (std::size_t j = 0; j < k.rows(); ++j)
        for (int c = 0; c < 3; ++c)
            for (std::int32_t p = k.begin[j]; p < k.begin[j + 1]; ++p) {
                const bool diagonal = p == k.begin[j];
                for (int r = diagonal ? c : 0; r < 3; ++r)
                    *value++ = kappa * k.value[p][3 * r + c] + (diagonal && r == c ? mass[j] : 0.0);
            }
    ldlt_.factorize(sum_);
    nonzeros_ = ldlt_.matrixL().nestedExpression().nonZeros();
    return ldlt_.info() == Eigen::Success && ldlt_.vectorD().minCoeff() > 0;
}

void InertiaFactor::solve(std::vector<double>& b) const {
    Eigen::Map<Eigen::VectorXd> x(b.data(), Eigen::Index(b.size()));
    ldlt_.matrixL().solveInPlace(x);
    x = x.cwiseQuotient(ldlt_.vectorD());
    ldlt_.matrixU().solveInPlace(x);
}

}  // namespace undertow::fem
