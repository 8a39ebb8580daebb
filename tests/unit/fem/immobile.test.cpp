// A bed of facets without elements beside a block, from a Gmsh file.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "contact/surface.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "support.hpp"
#include "two_solids.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

/// A unit cube, its top "soil", and one facet "bed" that continues the top along +x. `bed` are the
/// nodes of that facet, `extra` further nodes.
std::string cube_and_bed(const std::string& bed, const std::string& extra = "") {
    const int nodes = extra.empty() ? 11 : 12;
    return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
           "$PhysicalNames\n3\n2 1 \"top\"\n2 2 \"bed\"\n3 3 \"cube\"\n$EndPhysicalNames\n"
           "$Entities\n0 0 2 1\n"
           "1 0 0 1 1 1 1 1 1 0\n"
           "2 1 0 1 2 1 1 1 2 0\n"
           "1 0 0 0 1 1 1 1 3 0\n"
           "$EndEntities\n"
           "$Nodes\n1 " +
           std::to_string(nodes) + " 1 12\n3 1 0 " + std::to_string(nodes) +
           "\n1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n" + (extra.empty() ? "" : "12\n") +
           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n2 0 1\n2 1 1\n9 9 9\n" + extra +
           "$EndNodes\n"
           "$Elements\n3 3 1 3\n"
           "2 1 3 1\n1 5 6 7 8\n"
           "2 2 3 1\n2 " +
           bed +
           "\n3 1 5 1\n3 1 2 3 4 5 6 7 8\n"
           "$EndElements\n";
}

struct BedCase {
    std::filesystem::path file = std::filesystem::temp_directory_path() /
                                 ("undertow-bed-" + std::to_string(::getpid()) + ".msh");
    Case c = two_solids(1e7, 1800);
    explicit BedCase(const std::string& text) {
        std::ofstream(file) << text;
        c.fem.mesh = file.string();
        c.fem.part = {{"cube", "soil"}};
        c.fem.surface = {{"soil", "top", false}, {"bed", "bed", true}};
    }
    ~BedCase() { std::filesystem::remove(file); }
};

TEST_CASE("a bed of no element continues the soil's surface, shares its nodes and stays at rest") {
    BedCase scene(cube_and_bed("6 9 10 7"));
    scene.c.info.gravity = {0, 0, -9.81};
    const Model model = build_model(scene.c);
    check_mesh(model.mesh);
    CHECK(model.mesh.x.size() == 10);  // the orphan at (9, 9, 9) is dropped, the bed's nodes stay
    CHECK(model.surface.node.size() == 6);
    CHECK(model.surface.quad.size() == 2);
    CHECK(model.surface.names == std::vector<std::string>{"soil", "bed"});
    std::vector<double> x;
    std::vector<std::int32_t> quad;
    for (std::int32_t n : model.surface.node)
        for (int d = 0; d < 3; ++d) x.push_back(model.mesh.x[n][d]);
    for (const Quad& q : model.surface.quad) quad.insert(quad.end(), q.begin(), q.end());
    CHECK(contact::find_defect(x, quad).empty());  // what the coupler asks

    Structure s(model, 1);
    march(s, 1e-4, 100);  // everything falls but the bed
    for (std::size_t n = 0; n < s.nodes().size(); ++n) {
        const bool of_bed = s.nodes().x0[n].c[0] > 1.5;
        CHECK((s.nodes().mass[n] == 0) == of_bed);
        CHECK((s.displacement(std::int32_t(n))[2] == 0) == of_bed);
    }
    CHECK(s.energies().external == Approx(1800 * 9.81 * 0.5 * 9.81 * 1e-4).epsilon(0.03));
}

TEST_CASE("a bed that faces down, has twin nodes, or lies on an element is refused in words") {
    BedCase turned(cube_and_bed("6 7 10 9"));
    CHECK_THROWS_WITH(build_model(turned.c), Catch::Contains("look to different sides") &&
                                                 Catch::Contains("\"bed\"") &&
                                                 Catch::Contains("Reverse Surface"));
    BedCase leaky(cube_and_bed("12 9 10 7", "1 0 1\n"));
    CHECK_THROWS_WITH(build_model(leaky.c),
                      Catch::Contains("a leak") && Catch::Contains("(1, 0, 1)"));
    BedCase on_cube(cube_and_bed("2 3 7 6"));
    CHECK_THROWS_WITH(build_model(on_cube.c), Catch::Contains("is a face of an element"));
    BedCase mobile(cube_and_bed("6 9 10 7"));
    mobile.c.fem.surface[1].immobile = false;
    CHECK_THROWS_WITH(build_model(mobile.c), Catch::Contains("is not a face of any solid element"));
    BlockCase block;
    Case c = block.settings();
    c.fem.surface = {{"bed", "zmax", true}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("[fem.block]"));
}

}  // namespace
}  // namespace undertow::fem
