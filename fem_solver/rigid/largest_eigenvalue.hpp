#pragma once
// The largest eigenvalue of a small symmetric pair of matrices. Eigen's solver of fixed size gives the same
// and costs this one call 15 s of compilation.

#include <cmath>

namespace undertow::fem {

/// lambda of K u = lambda M u, largest. K symmetric, M symmetric and positive definite, both [n][n].
/// By M = L L^T and Jacobi's rotations of L^-1 K L^-T, to round-off.
template <int n>
double largest_eigenvalue(const double (&K)[n][n], const double (&M)[n][n]) {
    double L[n][n] = {}, A[n][n];
    for (int j = 0; j < n; ++j)
        for (int i = j; i < n; ++i) {
            double sum = M[i][j];
            for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
            L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
        }
    for (int i = 0; i < n; ++i)  // A = L^-1 K
        for (int j = 0; j < n; ++j) {
            double sum = K[i][j];
            for (int k = 0; k < i; ++k) sum -= L[i][k] * A[k][j];
            A[i][j] = sum / L[i][i];
        }
    for (int i = 0; i < n; ++i)  // A = A L^-T
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < j; ++k) A[i][j] -= A[i][k] * L[j][k];
            A[i][j] /= L[j][j];
        }
    for (int sweep = 0; sweep < 50; ++sweep) {
        double off = 0, all = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) (i == j ? all : off) += A[i][j] * A[i][j];
        if (off <= 1e-30 * all) break;
        for (int p = 0; p < n; ++p)
            for (int q = p + 1; q < n; ++q) {
                if (A[p][q] == 0) continue;
                // the angle that makes A[p][q] zero, the smaller of two
                const double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
                const double t = std::copysign(1, theta) / (std::abs(theta) + std::hypot(theta, 1));
                const double c = 1 / std::hypot(t, 1), s = t * c;
                for (int k = 0; k < n; ++k) {
                    const double a = A[k][p], b = A[k][q];
                    A[k][p] = c * a - s * b, A[k][q] = s * a + c * b;
                }
                for (int k = 0; k < n; ++k) {
                    const double a = A[p][k], b = A[q][k];
                    A[p][k] = c * a - s * b, A[q][k] = s * a + c * b;
                }
            }
    }
    double largest = A[0][0];
    for (int i = 1; i < n; ++i) largest = std::fmax(largest, A[i][i]);
    return largest;
}

}  // namespace undertow::fem
