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
