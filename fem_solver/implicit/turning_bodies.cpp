#include "fem_solver/implicit/turning_bodies.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <numeric>

namespace undertow::fem {
namespace {

/// Number of the body of each row, by the blocks that join rows.
std::vector<std::int32_t> joined_rows(const BlockMatrix& k) {
    std::vector<std::int32_t> root(k.rows());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](std::int32_t i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    for (std::size_t j = 0; j < k.rows(); ++j)
        for (std::int32_t p = k.begin[j]; p < k.begin[j + 1]; ++p)
            root[find(k.row[p])] = find(std::int32_t(j));
    for (std::size_t i = 0; i < k.rows(); ++i) root[i] = find(std::int32_t(i));
    return root;
}

}  // namespace

TurningBodies::TurningBodies(const BlockMatrix& k, const Nodes& nodes)
    : body_of_node_(nodes.size(), -1), node_(k.node) {
    const std::vector<std::int32_t> root = joined_rows(k);
    std::vector<std::int32_t> number(k.rows(), -1);
    for (std::size_t i = 0; i < k.rows(); ++i) {
        std::int32_t& b = number[root[i]];
        if (b < 0) {
            b = std::int32_t(body_.size());
            body_.emplace_back();
        }
        Body& body = body_[b];
        body.row.push_back(std::int32_t(i));
        body_of_node_[k.node[i]] = b;
        mass_.push_back(nodes.mass[k.node[i]]);
        body.mass += mass_.back();
        for (int d = 0; d < 3; ++d) body.turns &= nodes.inverse_mass[k.node[i]].c[d] > 0;
    }
    for (Body& body : body_) body.x.resize(body.row.size());
}

std::array<double, 3> TurningBodies::center(const Body& body, const NodeRows& x) const {
    std::array<double, 3> c{};
    for (std::int32_t i : body.row)
        for (int d = 0; d < 3; ++d) c[d] += mass_[i] * x[node_[i]].c[d];
    for (double& v : c) v /= body.mass;
    return c;
}

void TurningBodies::accept(const NodeRows& x) {
    for (Body& body : body_) {
        const std::array<double, 3> c = center(body, x);
        for (std::size_t i = 0; i < body.row.size(); ++i)
            for (int d = 0; d < 3; ++d) body.x[i][d] = x[node_[body.row[i]]].c[d] - c[d];
        body.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    }
}

void TurningBodies::find(const NodeRows& x) {
    for (Body& body : body_) {
        if (!body.turns) continue;
        const std::array<double, 3> c = center(body, x);
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (std::size_t i = 0; i < body.row.size(); ++i) {
            const std::int32_t n = node_[body.row[i]];
            for (int d = 0; d < 3; ++d)
                for (int e = 0; e < 3; ++e)
                    sum(d, e) += mass_[body.row[i]] * (x[n].c[d] - c[d]) * body.x[i][e];
        }
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
        // nodes on a line leave the turn about it open
        if (!(svd.singularValues()[1] > 1e-9 * svd.singularValues()[0])) continue;
        const Eigen::Matrix3d plain = svd.matrixU() * svd.matrixV().transpose();
        const Eigen::Vector3d sign(1, 1, plain.determinant() > 0 ? 1 : -1);
        const Eigen::Matrix3d r = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
        for (int d = 0; d < 3; ++d)
            for (int e = 0; e < 3; ++e) body.rotation[3 * d + e] = r(d, e);
    }
}

void TurningBodies::turn_back(std::vector<double>& a) const {
    for (const Body& body : body_) {
        if (!body.turns) continue;
        const Rotation& r = body.rotation;
        for (std::int32_t i : body.row) {
            double* v = &a[3 * std::size_t(i)];
            const double x = v[0], y = v[1], z = v[2];
            for (int d = 0; d < 3; ++d) v[d] = r[d] * x + r[3 + d] * y + r[6 + d] * z;
        }
    }
}

void TurningBodies::turn(std::vector<double>& a) const {
    for (const Body& body : body_) {
        if (!body.turns) continue;
        const Rotation& r = body.rotation;
        for (std::int32_t i : body.row) {
            double* v = &a[3 * std::size_t(i)];
            const double x = v[0], y = v[1], z = v[2];
            for (int d = 0; d < 3; ++d) v[d] = r[3 * d] * x + r[3 * d + 1] * y + r[3 * d + 2] * z;
        }
    }
}

}  // namespace undertow::fem
