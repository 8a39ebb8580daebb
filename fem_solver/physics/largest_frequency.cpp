#include "fem_solver/physics/largest_frequency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace undertow::fem {
namespace {

/// Largest eigenvalue of the symmetric tridiagonal matrix (alpha, beta), by bisection on the sign
/// count of its Sturm sequence.
double largest_eigenvalue(const std::vector<double>& alpha, const std::vector<double>& beta) {
    double high = 0;
    for (std::size_t i = 0; i < alpha.size(); ++i)
        high = std::max(
            high, alpha[i] + (i > 0 ? beta[i - 1] : 0) + (i + 1 < alpha.size() ? beta[i] : 0));
    double low = 0;
    for (int k = 0; k < 60 && high - low > 1e-12 * high; ++k) {
        const double middle = 0.5 * (low + high);
        bool one_above = false;
        double d = alpha[0] - middle;
        one_above = d > 0;
        for (std::size_t i = 1; i < alpha.size() && !one_above; ++i) {
            d = alpha[i] - middle - beta[i - 1] * beta[i - 1] / d;
            one_above = d > 0;
        }
        (one_above ? low : high) = middle;
    }
    return high;
}

double dot(const NodeRows& a, const NodeRows& b) {
    Row sum = {};
    for (std::size_t n = 0; n < a.size(); ++n) sum += as_row(a[n]) * as_row(b[n]);
    return sum[0] + sum[1] + sum[2];
}

/// A fixed sequence in [-1, 1], so that a run does not depend on a seed.
double pseudo_random(std::uint64_t& state) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return double(std::int64_t(state >> 11)) / double(1ll << 52) - 1;
}

}  // namespace

LargestFrequency find_largest_frequency(const Elements& elements, const Nodes& nodes) {
    constexpr int max_iterations = 200;
    // nodes that move, and after them those that turn
    const std::span<const NodeRow> inverse_inertia = elements.inverse_inertia();
    const std::size_t n = nodes.size() + inverse_inertia.size();
    const auto inverse_mass = [&](std::size_t i) {
        return i < nodes.size() ? nodes.inverse_mass[i].c : inverse_inertia[i - nodes.size()].c;
    };
    NodeRows root(n), q(n), q_old(n), u(n), w(n);  // root = M^-1/2 per direction, 0 where held
    double extent = 0;
    std::uint64_t random = 1;
    for (std::size_t i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) {
            root[i].c[d] = std::sqrt(inverse_mass(i)[d]);
            q[i].c[d] = root[i].c[d] > 0 ? pseudo_random(random) : 0;
            if (i < nodes.size())
                extent = std::max(extent, std::abs(nodes.x[i].c[d] - nodes.x[0].c[d]));
        }
    LargestFrequency found;
    double norm = std::sqrt(dot(q, q));
    if (norm == 0) return found;  // every node is held
    for (NodeRow& r : q) as_row(r) /= norm;

    std::vector<double> alpha, beta;
    double last = 0;
    for (int k = 0; k < max_iterations; ++k) {
        // The element kernel takes finite displacements: ones far below round-off of the positions
        // make it exactly linear, and lose nothing, since they never get added to positions.
        double largest = 0;
        for (std::size_t i = 0; i < n; ++i)
            for (int d = 0; d < 3; ++d)
                largest = std::max(largest, std::abs(root[i].c[d] * q[i].c[d]));
        const double scale = 1e-20 * extent / largest;
        for (std::size_t i = 0; i < n; ++i) {
            as_row(u[i]) = scale * as_row(root[i]) * as_row(q[i]);
            as_row(w[i]) = Row{};
        }
        elements.subtract_tangent_forces(nodes.x, u, w);
        for (std::size_t i = 0; i < n; ++i) as_row(w[i]) *= as_row(root[i]) * (-1 / scale);

        const double a = dot(q, w), b = beta.empty() ? 0 : beta.back();
        for (std::size_t i = 0; i < n; ++i) as_row(w[i]) -= a * as_row(q[i]) + b * as_row(q_old[i]);
        alpha.push_back(a);
        const double eigenvalue = largest_eigenvalue(alpha, beta);
        found = {std::sqrt(eigenvalue), k + 1, false};
        norm = std::sqrt(dot(w, w));
        // ten more iterations without a gain of 0.02 %: what is left is far below the 1 % margin
        if (norm < 1e-10 * eigenvalue || (k % 10 == 9 && eigenvalue < 1.0002 * last)) {
            found.converged = true;
            break;
        }
        if (k % 10 == 9) last = eigenvalue;
        beta.push_back(norm);
        std::swap(q_old, q);
        for (std::size_t i = 0; i < n; ++i) as_row(q[i]) = as_row(w[i]) / norm;
    }
    return found;
}

}  // namespace undertow::fem
