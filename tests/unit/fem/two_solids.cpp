#include "two_solids.hpp"

#include "fem_solver/setup/block_mesh.hpp"

namespace undertow::fem {

void add_block(Mesh& mesh, const std::string& name, const Box& box, std::array<int, 3> divisions) {
    const Mesh block = make_block({box, divisions});
    mesh.source = "blocks";
    const std::int32_t first_node = std::int32_t(mesh.x.size());
    const std::int32_t first_element = std::int32_t(mesh.hexahedra.size());
    mesh.x.insert(mesh.x.end(), block.x.begin(), block.x.end());
    for (Hexahedron h : block.hexahedra) {
        for (std::int32_t& n : h) n += first_node;
        mesh.hexahedra.push_back(h);
        mesh.element_tag.push_back(std::int64_t(mesh.hexahedra.size()));
    }
    for (std::int32_t e : block.volume_sets.at("block"))
        mesh.volume_sets[name].push_back(first_element + e);
    for (const auto& [side, facets] : block.facet_sets)
        for (Quad q : facets) {
            for (std::int32_t& n : q) n += first_node;
            mesh.facet_sets[name + "." + side].push_back(q);
        }
}

void add_sheet(Mesh& mesh, const std::string& name, const Vec3& from, const Vec3& a, const Vec3& b,
               int n) {
    const auto node_at = [&](const Vec3& x) {
        for (std::size_t k = 0; k < mesh.x.size(); ++k) {
            double squared = 0;
            for (int d = 0; d < 3; ++d) squared += (mesh.x[k][d] - x[d]) * (mesh.x[k][d] - x[d]);
            if (squared < 1e-18) return std::int32_t(k);
        }
        mesh.x.push_back(x);
        return std::int32_t(mesh.x.size() - 1);
    };
    std::vector<std::int32_t> nodes;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
            Vec3 x;
            for (int d = 0; d < 3; ++d) x[d] = from[d] + a[d] * i / n + b[d] * j / n;
            nodes.push_back(node_at(x));
        }
    const auto node = [&](int i, int j) { return nodes[i * (n + 1) + j]; };
    if (mesh.source.empty()) mesh.source = "sheets";
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Quad q{node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)};
            mesh.volume_sets[name].push_back(std::int32_t(mesh.n_elements()));
            mesh.facet_sets[name].push_back(q);
            mesh.shells.push_back(q);
            mesh.element_tag.push_back(std::int64_t(mesh.element_tag.size() + 1));
        }
}

void map_nodes(Mesh& mesh, const std::function<Vec3(const Vec3&)>& map) {
    for (Vec3& x : mesh.x) x = map(x);
}

Case two_solids(double young_modulus, double density) {
    Case c;
    c.info.gravity = {0, 0, 0};
    c.fem.present = true;
    FemMaterial soil, steel;
    soil.name = "soil";
    soil.density = density;
    soil.young_modulus = young_modulus;
    soil.poisson_ratio = 0.3;
    steel.name = "steel";
    steel.density = 7850;
    steel.young_modulus = 210e9;
    steel.poisson_ratio = 0.3;
    c.fem.material = {soil, steel};
    return c;
}

void set_gravity(Structure& structure, const Vec3& gravity) {
    const_cast<Model&>(structure.model()).gravity = gravity;
}

}  // namespace undertow::fem
