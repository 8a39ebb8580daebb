#include "fem_solver/implicit/stiffness_matrix.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

namespace undertow::fem {
namespace {

using Neighbors = std::vector<std::vector<std::int32_t>>;  // of each row, itself included

/// Nodes of the elements that can move, increasing.
std::vector<std::int32_t> free_nodes(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                                     const Nodes& nodes) {
    std::vector<std::int32_t> free;
    for (std::int32_t e : elements)
        for (std::int32_t n : mesh.hexahedra[e]) {
            const double* im = nodes.inverse_mass[n].c;
            if (im[0] > 0 || im[1] > 0 || im[2] > 0) free.push_back(n);
        }
    std::sort(free.begin(), free.end());
    free.erase(std::unique(free.begin(), free.end()), free.end());
    return free;
}

Neighbors neighbors_of(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                       const std::vector<std::int32_t>& row_of, std::size_t rows) {
    Neighbors neighbors(rows);
    for (std::int32_t e : elements)
        for (std::int32_t a : mesh.hexahedra[e])
            for (std::int32_t b : mesh.hexahedra[e])
                if (row_of[a] >= 0 && row_of[b] >= 0) neighbors[row_of[a]].push_back(row_of[b]);
    for (std::vector<std::int32_t>& list : neighbors) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return neighbors;
}

/// Rows in the order of elimination: approximate minimum degree [Amestoy, Davis and Duff 1996].
std::vector<std::int32_t> elimination_order(const Neighbors& neighbors) {
    using Graph = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < neighbors.size(); ++i)
        for (std::int32_t j : neighbors[i]) entries.emplace_back(int(i), j, 1.0);
    Graph graph{Eigen::Index(neighbors.size()), Eigen::Index(neighbors.size())};
    graph.setFromTriplets(entries.begin(), entries.end());
    Eigen::AMDOrdering<int>::PermutationType order;
    Eigen::AMDOrdering<int>()(graph, order);
    return {order.indices().data(), order.indices().data() + order.size()};
}

/// Smallest color that nobody within two steps has, in the order of the rows.
std::vector<std::int32_t> color_columns(const Neighbors& neighbors, int& colors) {
    std::vector<std::int32_t> color(neighbors.size(), -1), taken_by;
    colors = 0;
    for (std::size_t i = 0; i < neighbors.size(); ++i) {
        for (std::int32_t j : neighbors[i])
            for (std::int32_t k : neighbors[j])
                if (color[k] >= 0) taken_by[color[k]] = std::int32_t(i);
        std::int32_t c = 0;
        while (c < colors && taken_by[c] == std::int32_t(i)) ++c;
        if (c == colors) {
            ++colors;
            taken_by.push_back(-1);
        }
        color[i] = c;
    }
    return color;
}

}  // namespace

void BlockMatrix::multiply(const std::vector<double>& x, std::vector<double>& y) const {
    std::fill(y.begin(), y.end(), 0.0);
    for (std::size_t j = 0; j < rows(); ++j) {
        const double* xj = &x[3 * j];
        double* yj = &y[3 * j];
        for (std::int32_t p = begin[j]; p < begin[j + 1]; ++p) {
            const double* k = value[p].data();
            const std::int32_t i = row[p];
            double* yi = &y[3 * i];
            for (int d = 0; d < 3; ++d)
                yi[d] += k[3 * d] * xj[0] + k[3 * d + 1] * xj[1] + k[3 * d + 2] * xj[2];
            if (i == std::int32_t(j)) continue;
            const double* xi = &x[3 * i];
            for (int d = 0; d < 3; ++d) yj[d] += k[d] * xi[0] + k[3 + d] * xi[1] + k[6 + d] * xi[2];
        }
    }
}

StiffnessMatrix::StiffnessMatrix(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                                 const Nodes& nodes)
    : displaced_(nodes.size()), force_(nodes.size()) {
    const std::vector<std::int32_t> free = free_nodes(mesh, elements, nodes);
    std::vector<std::int32_t> row_of(nodes.size(), -1);
    const auto number = [&](const std::vector<std::int32_t>& list) {
        for (std::size_t i = 0; i < list.size(); ++i) row_of[list[i]] = std::int32_t(i);
    };
    number(free);
    for (std::int32_t i : elimination_order(neighbors_of(mesh, elements, row_of, free.size())))
        matrix_.node.push_back(free[i]);
    number(matrix_.node);
    const Neighbors neighbors = neighbors_of(mesh, elements, row_of, free.size());
    color_ = color_columns(neighbors, colors_);
    matrix_.begin.push_back(0);
    for (std::size_t j = 0; j < neighbors.size(); ++j) {
        for (std::int32_t i : neighbors[j])
            if (i >= std::int32_t(j)) matrix_.row.push_back(i);
        matrix_.begin.push_back(std::int32_t(matrix_.row.size()));
    }
    matrix_.value.resize(matrix_.row.size());
}

void StiffnessMatrix::assemble(const Hexahedra& elements, const Nodes& nodes) {
    double extent = 0;
    for (const NodeRow& x : nodes.x)
        for (int d = 0; d < 3; ++d) extent = std::max(extent, std::abs(x.c[d] - nodes.x[0].c[d]));
    // The kernel takes finite displacements: ones far below round-off of the positions make it
    // exactly linear, and lose nothing, since they never get added to positions.
    const double scale = 1e-20 * extent;
    for (int color = 0; color < colors_; ++color)
        for (int d = 0; d < 3; ++d) {
            for (NodeRow& u : displaced_) u = NodeRow{};
            for (NodeRow& f : force_) f = NodeRow{};
            for (std::size_t j = 0; j < matrix_.rows(); ++j)
                if (color_[j] == color) displaced_[matrix_.node[j]].c[d] = scale;
            elements.subtract_tangent_forces(nodes.x, displaced_, force_);
            for (std::size_t j = 0; j < matrix_.rows(); ++j)
                if (color_[j] == color) fill_column(std::int32_t(j), d, nodes, scale);
        }
}

/// Column 3 j + d of the lower triangle; the upper one is its mirror image.
void StiffnessMatrix::fill_column(std::int32_t j, int d, const Nodes& nodes, double scale) {
    const bool held = nodes.inverse_mass[matrix_.node[j]].c[d] == 0;
    for (std::int32_t p = matrix_.begin[j]; p < matrix_.begin[j + 1]; ++p) {
        const std::int32_t n = matrix_.node[matrix_.row[p]];
        for (int i = 0; i < 3; ++i)
            matrix_.value[p][3 * i + d] =
                held || nodes.inverse_mass[n].c[i] == 0 ? 0 : -force_[n].c[i] / scale;
    }
}

}  // namespace undertow::fem
