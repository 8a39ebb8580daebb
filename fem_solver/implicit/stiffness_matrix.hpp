#pragma once
// The stiffness of the implicit parts as a sparse matrix, K = -d f/d x of what the elements
// themselves compute.
//
// Whatever an element's formulation, its tangent forces are linear in the displacements. Nodes that
// share no neighbor are displaced together, so that one sweep over the elements fills a column for
// each of them (Curtis, Powell and Reid 1974): some 60 to 100 sweeps for a mesh of any size.

#include <array>
#include <cstdint>
#include <vector>

#include "fem_solver/elements/hexahedra.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

/// Symmetric, in blocks of 3 x 3, one row of blocks for each node; rows in an order that keeps the
/// factor sparse. Lower triangle by columns, the diagonal block first, rows increasing.
struct BlockMatrix {
    std::vector<std::int32_t> node;            // [rows] of the mesh
    std::vector<std::int32_t> begin;           // [rows + 1] first block of a column
    std::vector<std::int32_t> row;             // [blocks]
    std::vector<std::array<double, 9>> value;  // [blocks] row by row [N/m]

    std::size_t rows() const { return node.size(); }
    /// y = K x; (3 rows) both.
    void multiply(const std::vector<double>& x, std::vector<double>& y) const;
};

class StiffnessMatrix {
 public:
    /// Rows for the nodes of `elements` (of the mesh) that are free in any direction.
    StiffnessMatrix(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                    const Nodes& nodes);

    /// K of `elements`, the group of the implicit parts, in the shape nodes.x. Rows and columns of
    /// directions that a support holds are zero.
    void assemble(const Hexahedra& elements, const Nodes& nodes);

    const BlockMatrix& matrix() const { return matrix_; }
    void archive(Archive& a);
    int sweeps() const { return 3 * colors_; }

 private:
    void fill_column(std::int32_t column, int direction, const Nodes& nodes, double scale);

    BlockMatrix matrix_;
    std::vector<std::int32_t> color_;  // [rows] equal colors share no neighbor
    int colors_ = 0;
    NodeRows displaced_, force_;
};

}  // namespace undertow::fem
