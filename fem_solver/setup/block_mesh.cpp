#include "fem_solver/setup/block_mesh.hpp"

#include <cmath>
#include <limits>

#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

/// The six tetrahedra about the diagonal from corner 0 to corner 6: neighbors agree on the diagonals
/// of the faces between them.
constexpr int tetrahedra_of[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                     {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};

/// Place in the block at the shares s of its three directions.   [m]
Vec3 place(const FemBlock& block, const double (&s)[3]) {
    Vec3 x{};
    if (block.corners.empty()) {
        for (int d = 0; d < 3; ++d)  // exact at both ends
            x[d] = (1 - s[d]) * block.box.min[d] + s[d] * block.box.max[d];
        return x;
    }
    constexpr int side[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        for (int k = 0; k < 3; ++k) weight *= side[corner][k] ? s[k] : 1 - s[k];
        for (int d = 0; d < 3; ++d) x[d] += weight * block.corners[corner][d];
    }
    return x;
}

/// Takes cells one by one, as hexahedra or cut into tetrahedra.
class Cells {
 public:
    Cells(Mesh& mesh, BlockCells kind) : mesh_(mesh), kind_(kind) {}

    void add(const Hexahedron& cell) {
        cell_ = cell;
        if (kind_ == BlockCells::hexahedra) {
            mesh_.hexahedra.push_back(cell);
            number();
            return;
        }
        for (const auto& n : tetrahedra_of) {
            mesh_.tetrahedra.push_back({cell[n[0]], cell[n[1]], cell[n[2]], cell[n[3]]});
            number();
        }
    }
    /// A face of the last cell.
    void add_face(const char* set, int face) {
        std::vector<Quad>& facets = mesh_.facet_sets[set];
        int n[4], first = 0;
        for (int k = 0; k < 4; ++k) {
            n[k] = hexahedron_face[face][k];
            if (n[k] == 0 || n[k] == 6) first = k;  // where the diagonal begins
        }
        if (kind_ == BlockCells::hexahedra) {
            facets.push_back({cell_[n[0]], cell_[n[1]], cell_[n[2]], cell_[n[3]]});
            return;
        }
        const auto at = [&](int k) { return cell_[n[(first + k) % 4]]; };
        facets.push_back({at(0), at(1), at(2), at(2)});
        facets.push_back({at(0), at(2), at(3), at(3)});
    }

 private:
    void number() {
        mesh_.volume_sets["block"].push_back(std::int32_t(mesh_.element_tag.size()));
        mesh_.element_tag.push_back(std::int64_t(mesh_.element_tag.size()) + 1);
    }

    Mesh& mesh_;
    BlockCells kind_;
    Hexahedron cell_{};
};

}  // namespace

Mesh make_block(const FemBlock& block) {
    const char* axis[3] = {"x", "y", "z"};
    double elements = 1;
    for (int k = 0; k < 3; ++k) {
        if (block.divisions[k] < 1)
            throw InputError("fem.block.divisions: " + std::to_string(block.divisions[k]) +
                             " along " + axis[k] + " must be >= 1.");
        if (!(block.box.max[k] > block.box.min[k]))
            throw InputError("fem.block.box: max must lie beyond min along " +
                             std::string(axis[k]) + ", but " + std::to_string(block.box.max[k]) +
                             " <= " + std::to_string(block.box.min[k]) + ".");
        elements *= block.divisions[k] + 1.0;
    }
    if (block.cells == BlockCells::tetrahedra) elements *= 6;
    if (elements > std::numeric_limits<std::int32_t>::max())
        throw InputError("fem.block.divisions: the block has more than 2^31 nodes or elements; use "
                         "fewer.");

    const int nx = block.divisions[0], ny = block.divisions[1], nz = block.divisions[2];
    const auto node = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
    Mesh mesh;
    mesh.source = "[fem.block]";
    mesh.x.reserve(std::size_t(nx + 1) * (ny + 1) * (nz + 1));
    for (int k = 0; k <= nz; ++k)
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) {
                const double s[3] = {double(i) / nx, double(j) / ny, double(k) / nz};
                mesh.x.push_back(place(block, s));
            }

    Cells cells(mesh, block.cells);
    for (int k = 0; k < nz; ++k)
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                cells.add({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k),
                           node(i, j + 1, k), node(i, j, k + 1), node(i + 1, j, k + 1),
                           node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)});
                if (i == 0) cells.add_face("xmin", 0);
                if (i == nx - 1) cells.add_face("xmax", 1);
                if (j == 0) cells.add_face("ymin", 2);
                if (j == ny - 1) cells.add_face("ymax", 3);
                if (k == 0) cells.add_face("zmin", 4);
                if (k == nz - 1) cells.add_face("zmax", 5);
            }
    return mesh;
}

}  // namespace undertow::fem
