#include "fem_solver/setup/block_mesh.hpp"

#include <cmath>
#include <limits>

#include "wire/errors.hpp"

namespace undertow::fem {

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
    if (elements > std::numeric_limits<std::int32_t>::max())
        throw InputError("fem.block.divisions: the block has more than 2^31 nodes; use fewer.");

    const int nx = block.divisions[0], ny = block.divisions[1], nz = block.divisions[2];
    const auto node = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
    Mesh mesh;
    mesh.source = "[fem.block]";
    mesh.x.reserve(std::size_t(nx + 1) * (ny + 1) * (nz + 1));
    for (int k = 0; k <= nz; ++k)
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) {
                const double s[3] = {double(i) / nx, double(j) / ny, double(k) / nz};
                Vec3 x;
                for (int d = 0; d < 3; ++d)  // exact at both ends
                    x[d] = (1 - s[d]) * block.box.min[d] + s[d] * block.box.max[d];
                mesh.x.push_back(x);
            }

    std::vector<std::int32_t>& all = mesh.volume_sets["block"];
    const auto put_face = [&](const char* set, int face) {
        const Hexahedron& h = mesh.hexahedra.back();
        const int* n = hexahedron_face[face];
        mesh.facet_sets[set].push_back({h[n[0]], h[n[1]], h[n[2]], h[n[3]]});
    };
    for (int k = 0; k < nz; ++k)
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                all.push_back(std::int32_t(mesh.hexahedra.size()));
                mesh.element_tag.push_back(std::int64_t(mesh.hexahedra.size()) + 1);
                mesh.hexahedra.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k),
                                          node(i, j + 1, k), node(i, j, k + 1),
                                          node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1),
                                          node(i, j + 1, k + 1)});
                if (i == 0) put_face("xmin", 0);
                if (i == nx - 1) put_face("xmax", 1);
                if (j == 0) put_face("ymin", 2);
                if (j == ny - 1) put_face("ymax", 3);
                if (k == 0) put_face("zmin", 4);
                if (k == nz - 1) put_face("zmax", 5);
            }
    return mesh;
}

}  // namespace undertow::fem
