#include "fem_solver/implicit/inertia_factor.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>

namespace undertow::fem {
namespace {

using Dense = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstDense = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using Vector = Eigen::Map<Eigen::VectorXd>;

}  // namespace

InertiaFactor::InertiaFactor(const BlockMatrix& k)
    : nodes_(find_supernodes(k)), update_(nodes_.size()), place_(k.rows()) {
    std::size_t largest = 0, below = 0;
    for (const Supernode& node : nodes_) {
        largest = std::max(largest, node.rows());
        below = std::max(below, node.below.size());
    }
    front_.resize(9 * largest * largest);
    below_.resize(3 * below);
    if (!nodes_.empty())
        factor_.resize(nodes_.back().panel +
                       9 * nodes_.back().rows() * std::size_t(nodes_.back().columns));
}

/// The front of a supernode: its columns of M + kappa K, and what its children have left.
void InertiaFactor::assemble_front(std::size_t s, const BlockMatrix& k,
                                   const std::vector<double>& mass, double kappa) {
    const Supernode& node = nodes_[s];
    const std::size_t size = 3 * node.rows();
    std::fill_n(front_.begin(), size * size, 0.0);
    for (std::int32_t c = 0; c < node.columns; ++c) place_[node.first + c] = c;
    for (std::size_t i = 0; i < node.below.size(); ++i)
        place_[node.below[i]] = std::int32_t(std::size_t(node.columns) + i);
    for (std::int32_t c = 0; c < node.columns; ++c) {
        const std::int32_t j = node.first + c;
        for (std::int32_t p = k.begin[j]; p < k.begin[j + 1]; ++p)
            for (int d = 0; d < 3; ++d)
                for (int e = 0; e < 3; ++e)
                    front_[(3 * c + e) * size + 3 * place_[k.row[p]] + d] =
                        kappa * k.value[p][3 * d + e];
        for (int d = 0; d < 3; ++d) front_[(3 * c + d) * (size + 1)] += mass[j];
    }
    for (std::int32_t child : node.children) {
        add_update(nodes_[child], update_[child], size);
        update_[child] = {};
    }
}

void InertiaFactor::add_update(const Supernode& child, const std::vector<double>& update,
                               std::size_t size) {
    const std::size_t blocks = child.below.size(), stride = 3 * blocks;
    for (std::size_t b = 0; b < blocks; ++b)
        for (int e = 0; e < 3; ++e) {
            double* to = &front_[(3 * place_[child.below[b]] + e) * size];
            const double* from = &update[(3 * b + e) * stride];
            for (std::size_t a = b; a < blocks; ++a)
                for (int d = 0; d < 3; ++d) to[3 * place_[child.below[a]] + d] += from[3 * a + d];
        }
}

bool InertiaFactor::factorize(const BlockMatrix& k, const std::vector<double>& mass, double kappa) {
    for (std::size_t s = 0; s < nodes_.size(); ++s) {
        const Supernode& node = nodes_[s];
        assemble_front(s, k, mass, kappa);
        const Eigen::Index size = Eigen::Index(3 * node.rows()), w = 3 * node.columns, r = size - w;
        Dense front(front_.data(), size, size, Eigen::OuterStride<>(size));
        auto top = front.topLeftCorner(w, w);
        if (Eigen::internal::llt_inplace<double, Eigen::Lower>::blocked(top) >= 0) return false;
        auto below = front.bottomLeftCorner(r, w);
        if (r > 0) {
            top.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
            update_[s].assign(std::size_t(r * r), 0.0);
            Dense update(update_[s].data(), r, r, Eigen::OuterStride<>(r));
            update.triangularView<Eigen::Lower>() = front.bottomRightCorner(r, r);
            update.selfadjointView<Eigen::Lower>().rankUpdate(below, -1.0);
        }
        Dense(factor_.data() + node.panel, size, w, Eigen::OuterStride<>(size)) = front.leftCols(w);
    }
    return true;
}

void InertiaFactor::solve(std::vector<double>& b) {
    for (const Supernode& node : nodes_) {  // L y = b
        const Eigen::Index size = Eigen::Index(3 * node.rows()), w = 3 * node.columns, r = size - w;
        const ConstDense panel(factor_.data() + node.panel, size, w, Eigen::OuterStride<>(size));
        Vector x(&b[3 * std::size_t(node.first)], w), below(below_.data(), r);
        panel.topRows(w).triangularView<Eigen::Lower>().solveInPlace(x);
        below.noalias() = panel.bottomRows(r) * x;
        for (std::size_t i = 0; i < node.below.size(); ++i)
            for (int d = 0; d < 3; ++d) b[3 * std::size_t(node.below[i]) + d] -= below[3 * i + d];
    }
    for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {  // L^T x = y
        const Eigen::Index size = Eigen::Index(3 * node->rows()), w = 3 * node->columns,
                           r = size - w;
        const ConstDense panel(factor_.data() + node->panel, size, w, Eigen::OuterStride<>(size));
        Vector x(&b[3 * std::size_t(node->first)], w), below(below_.data(), r);
        for (std::size_t i = 0; i < node->below.size(); ++i)
            for (int d = 0; d < 3; ++d) below[3 * i + d] = b[3 * std::size_t(node->below[i]) + d];
        x.noalias() -= panel.bottomRows(r).transpose() * below;
        panel.topRows(w).triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    }
}

}  // namespace undertow::fem
