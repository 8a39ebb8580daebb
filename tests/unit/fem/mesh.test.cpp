// Meshes: the block, Gmsh files, their sets and their mistakes.

#include "fem_solver/mesh.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "fem_solver/setup/block_mesh.hpp"
#include "fem_solver/setup/gmsh_mesh.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

/// Sum of x.n dA/3 over a closed surface: the volume it encloses, > 0 if normals point out.
double enclosed_volume(const Mesh& mesh, const std::vector<Quad>& facets) {
    double volume = 0;
    for (const Quad& q : facets) {
        double a[3], b[3], middle[3];
        for (int d = 0; d < 3; ++d) {
            a[d] = mesh.x[q[2]][d] - mesh.x[q[0]][d];
            b[d] = mesh.x[q[3]][d] - mesh.x[q[1]][d];
            middle[d] =
                0.25 * (mesh.x[q[0]][d] + mesh.x[q[1]][d] + mesh.x[q[2]][d] + mesh.x[q[3]][d]);
        }
        volume +=
            0.5 / 3 *
            (middle[0] * (a[1] * b[2] - a[2] * b[1]) + middle[1] * (a[2] * b[0] - a[0] * b[2]) +
             middle[2] * (a[0] * b[1] - a[1] * b[0]));
    }
    return volume;
}

TEST_CASE("a block has its volume, its sets, and facets that look outward") {
    const Mesh mesh = make_block({{{1, 2, 3}, {2, 4, 6}}, {2, 3, 4}});
    CHECK(mesh.hexahedra.size() == 24);
    CHECK(mesh.x.size() == 60);
    CHECK(mesh.facets_of("xmax", "test").size() == 12);
    CHECK(mesh.nodes_of("zmin", "test").size() == 12);
    CHECK(mesh.nodes_of("block", "test").size() == 60);
    std::vector<Quad> skin;
    for (const auto& [name, facets] : mesh.facet_sets)
        skin.insert(skin.end(), facets.begin(), facets.end());
    CHECK(enclosed_volume(mesh, skin) == Approx(6).epsilon(1e-14));
    for (const Quad& q : mesh.facets_of("xmax", "test"))
        for (std::int32_t n : q) CHECK(mesh.x[n][0] == 2);
    CHECK_THROWS_WITH(mesh.nodes_of("top", "fem.support"), Catch::Contains("fem.support") &&
                                                               Catch::Contains("\"top\"") &&
                                                               Catch::Contains("\"zmax\""));
}

TEST_CASE("an inverted element is named, and so is one that collapsed") {
    Mesh mesh = make_block({{{0, 0, 0}, {1, 1, 1}}, {2, 2, 2}});
    CHECK(check_mesh(mesh).worst_aspect == Approx(1));
    Mesh turned = mesh;
    std::swap(turned.hexahedra[4][1], turned.hexahedra[4][3]);
    std::swap(turned.hexahedra[4][5], turned.hexahedra[4][7]);
    CHECK_THROWS_WITH(check_mesh(turned),
                      Catch::Contains("hexahedron 5 ") && Catch::Contains("1 of 8"));
    mesh.hexahedra[2][3] = mesh.hexahedra[2][2];
    CHECK_THROWS_AS(check_mesh(mesh), InputError);
}

// Version 2.2: a cube in two groups, hence twice in the file, a facet, an edge, a point.
const char* const cubes_2_2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
5
0 5 "tip"
1 4 "edge"
2 3 "roof"
3 1 "cube"
3 2 "all"
$EndPhysicalNames
$Nodes
9
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
50 7 7 7
$EndNodes
$Elements
6
1 15 2 5 1 8
2 1 2 4 1 1 2
3 3 2 3 1 8 7 6 5
4 3 2 0 1 1 2 3 4
17 5 2 1 1 1 2 3 4 5 6 7 8
18 5 2 2 1 1 2 3 4 5 6 7 8
$EndElements
)";

// Two unit cubes side by side along x, in two volumes; tags of nodes and elements have gaps.
const char* const two_cubes = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
5
0 9 "tip"
1 8 "edge"
2 3 "skin"
3 1 "left part"
3 2 "right"
$EndPhysicalNames
$Entities
1 1 1 2
1 2 0 0 1 9
1 0 0 0 0 1 0 1 8 2 1 -1
1 0 0 0 2 1 1 1 3 1 1
1 0 0 0 1 1 1 1 1 1 1
2 1 0 0 2 1 1 1 2 1 1
$EndEntities
$Nodes
2 13 1 40
3 1 0 8
1
2
3
4
5
6
7
8
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
3 2 0 5
20
21
22
23
40
2 0 0
2 1 0
2 0 1
2 1 1
9 9 9
$EndNodes
$Elements
5 7 1 107
0 1 15 1
101 20
1 1 1 1
102 1 4
2 1 3 3
103 1 2 3 4
104 20 21 23 22
105 1 2 6 5
3 1 5 1
106 1 2 3 4 5 6 7 8
3 2 5 1
107 2 20 21 3 6 22 23 7
$EndElements
)";

struct GmshFolder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("undertow-gmsh-" + std::to_string(::getpid()));
    GmshFolder() { std::filesystem::create_directories(path); }
    ~GmshFolder() { std::filesystem::remove_all(path); }
    std::string write(const std::string& text) const {
        const std::string file = (path / "mesh.msh").string();
        std::ofstream(file) << text;
        return file;
    }
};

std::string with(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

TEST_CASE("a mesh of Gmsh 2.2 brings its sets, and an element of two groups once") {
    const GmshFolder folder;
    const Mesh mesh = read_gmsh(folder.write(cubes_2_2));
    CHECK(mesh.hexahedra.size() == 1);
    CHECK(mesh.element_tag == std::vector<std::int64_t>{17});
    CHECK(mesh.x.size() == 8);  // the ninth is of nothing
    CHECK(mesh.elements_of("cube", "test") == std::vector<std::int32_t>{0});
    CHECK(mesh.elements_of("all", "test") == std::vector<std::int32_t>{0});
    REQUIRE(mesh.facets_of("roof", "test").size() == 1);  // turned outward
    CHECK(enclosed_volume(mesh, mesh.facets_of("roof", "test")) == Approx(1.0 / 3));
    CHECK(mesh.nodes_of("edge", "test") == std::vector<std::int32_t>{0, 1});
    CHECK(mesh.nodes_of("tip", "test") == std::vector<std::int32_t>{7});
    CHECK(mesh.facet_sets.size() == 1);  // group 0 is none
    check_mesh(mesh);
}

TEST_CASE("a Gmsh file brings nodes, elements and sets, its quads turned outward") {
    const GmshFolder folder;
    const Mesh mesh = read_gmsh(folder.write(two_cubes));
    CHECK(mesh.hexahedra.size() == 2);
    CHECK(mesh.x.size() == 12);  // the node that no hexahedron uses is gone
    CHECK(mesh.element_name(1) == "hexahedron 107");
    CHECK(mesh.elements_of("left part", "test") == std::vector<std::int32_t>{0});
    CHECK(mesh.elements_of("right", "test") == std::vector<std::int32_t>{1});
    CHECK(mesh.nodes_of("edge", "test").size() == 2);
    REQUIRE(mesh.nodes_of("tip", "test").size() == 1);
    CHECK(mesh.x[mesh.nodes_of("tip", "test")[0]] == Vec3{2, 0, 0});
    const double outward[3][3] = {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
    const std::vector<Quad>& skin = mesh.facets_of("skin", "test");
    REQUIRE(skin.size() == 3);
    for (int f = 0; f < 3; ++f) {
        const Quad& q = skin[f];
        for (int d = 0; d < 3; ++d) {
            const int e = (d + 1) % 3, g = (d + 2) % 3;
            const auto edge = [&](int a, int b, int k) {
                return mesh.x[q[b]][k] - mesh.x[q[a]][k];
            };
            CHECK(edge(0, 1, e) * edge(0, 3, g) - edge(0, 1, g) * edge(0, 3, e) == outward[f][d]);
        }
    }
}

// A tetrahedron, then a hexahedron beside it, then a quad of a plate; in this order in the file.
const char* const three_kinds = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 "skin"
2 2 "plate"
3 3 "wedge"
3 4 "brick"
$EndPhysicalNames
$Entities
0 0 2 2
1 0 0 0 1 1 1 1 1 0
2 0 0 5 1 1 5 1 2 0
1 0 0 0 1 1 1 1 3 0
2 2 0 0 3 1 1 1 4 0
$EndEntities
$Nodes
1 16 1 16
3 1 0 16
1
2
3
4
5
6
7
8
9
10
11
12
13
14
15
16
0 0 0
1 0 0
0 1 0
0 0 1
2 0 0
3 0 0
3 1 0
2 1 0
2 0 1
3 0 1
3 1 1
2 1 1
0 0 5
1 0 5
1 1 5
0 1 5
$EndNodes
$Elements
4 4 1 30
3 1 4 1
10 1 2 3 4
3 2 5 1
20 5 6 7 8 9 10 11 12
2 1 2 1
25 1 2 3
2 2 3 1
30 13 14 15 16
$EndElements
)";

TEST_CASE("elements of several shapes are numbered shape by shape, their facets turned outward") {
    const GmshFolder folder;
    const Mesh mesh = read_gmsh(folder.write(three_kinds), {{}, {"plate"}});
    CHECK(mesh.n_elements() == 3);
    CHECK(mesh.elements_of("brick", "test") == std::vector<std::int32_t>{0});
    CHECK(mesh.elements_of("wedge", "test") == std::vector<std::int32_t>{1});
    CHECK(mesh.elements_of("plate", "test") == std::vector<std::int32_t>{2});
    CHECK(mesh.element_name(0) == "hexahedron 20");
    CHECK(mesh.element_name(1) == "tetrahedron 10");
    CHECK(mesh.element_name(2) == "shell 30");
    CHECK(mesh.corners(1).size() == 4);
    CHECK(mesh.nodes_of("wedge", "test").size() == 4);
    CHECK(mesh.x.size() == 16);
    const Quad& bottom = mesh.facets_of("skin", "test")[0];  // 1 2 3 looks up, into the solid
    CHECK(bottom[2] == bottom[3]);
    CHECK(corners_of(bottom).size() == 3);
    CHECK(enclosed_volume(mesh, {bottom}) == 0);  // at z = 0; its normal:
    const Vec3 &a = mesh.x[bottom[0]], &b = mesh.x[bottom[1]], &c = mesh.x[bottom[2]];
    CHECK((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) == -1);
    CHECK(mesh.facets_of("plate", "test").size() == 1);
    CHECK(check_mesh(mesh).worst_aspect == Approx(2));  // of the tetrahedron

    // without the name of a shell, its quad is a facet that belongs to nothing
    CHECK_THROWS_WITH(read_gmsh(folder.write(three_kinds)),
                      Catch::Contains("quad 30") && Catch::Contains("not a face"));
    const Mesh flat = read_gmsh(folder.write(with(three_kinds, "10 1 2 3 4", "10 1 3 2 4")),
                                {{}, {"plate"}});
    CHECK_THROWS_WITH(check_mesh(flat), Catch::Contains("tetrahedron 10"));
}

TEST_CASE("the faces of a tetrahedron enclose its volume") {
    Mesh mesh;
    mesh.x = {{0.1, 0, 0}, {1, 0.2, 0}, {0, 1, 0.3}, {0.2, 0.1, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    std::vector<Quad> skin;
    for_each_face(mesh, [&](std::size_t, const Quad& q) { skin.push_back(q); });
    REQUIRE(skin.size() == 4);
    // det of the edges from node 0: (0.9, 0.2, 0), (-0.1, 1, 0.3), (0.1, 0.1, 1)
    CHECK(enclosed_volume(mesh, skin) == Approx((0.9 * 0.97 - 0.2 * -0.13) / 6).epsilon(1e-14));
    Quad turned{5, 3, 9, 9};
    CHECK(sorted_facet(turned) == sorted_facet({9, 5, 3, 3}));
    CHECK(sorted_facet(turned) != sorted_facet({9, 5, 4, 4}));
}

TEST_CASE("a Gmsh file that cannot be used is refused with file, line and advice") {
    const GmshFolder folder;
    const auto message = [&](const std::string& text) -> std::string {
        try {
            read_gmsh(folder.write(text));
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK_THAT(message(with(two_cubes, "4.1 0 8", "3.0 0 8")),
               Catch::Contains("mesh.msh:2") && Catch::Contains("2.2") && Catch::Contains("4.1"));
    CHECK_THAT(message(with(cubes_2_2, "17 5 2 1 1", "17 5 0")),
               Catch::Contains("mesh.msh:") && Catch::Contains("element 17 has no tags"));
    CHECK_THAT(message(with(cubes_2_2, "15 2 5 1 8", "15 2 5 1 99")),
               Catch::Contains("node 99 is not in $Nodes"));
    CHECK_THAT(message(with(cubes_2_2, "17 5 2", "17 6 2")),
               Catch::Contains("6-node prisms (Gmsh type 6) are not read"));
    CHECK_THAT(message(with(two_cubes, "4.1 0 8", "4.1 1 8")), Catch::Contains("binary"));
    CHECK_THAT(message(with(two_cubes, "3 1 5 1\n", "3 1 6 1\n")),
               Catch::Contains("mesh.msh:61") && Catch::Contains("prism"));
    CHECK_THAT(message(with(two_cubes, "106 1 2", "106 1 77")),
               Catch::Contains("node 77 is not in $Nodes"));
    CHECK_THAT(message(with(two_cubes, "103 1 2 3 4", "103 2 3 7 6")),
               Catch::Contains("quad 103") && Catch::Contains("between two"));
    CHECK_THAT(message(with(two_cubes, "103 1 2 3 4", "103 1 2 7 8")),
               Catch::Contains("not a face"));
    CHECK_THAT(message(with(two_cubes, "1 0 0\n", "1 nan? 0\n")),
               Catch::Contains("expected a number, found \"nan?\""));
    CHECK_THAT(message("solid cube\n"), Catch::Contains("mesh.msh:1"));
    CHECK_THAT(message(std::string(two_cubes).substr(0, 400)), Catch::Contains("ends"));
    CHECK_THROWS_AS(read_gmsh((folder.path / "none.msh").string()), InputError);
}

TEST_CASE("a truncated Gmsh file is refused wherever it ends") {
    const GmshFolder folder;
    const std::string whole = two_cubes;
    for (std::size_t n = 0; n + 14 < whole.size(); n += 3)
        CHECK_THROWS_AS(read_gmsh(folder.write(whole.substr(0, n))), InputError);
}

TEST_CASE("the coupled surface numbers its nodes anew and keeps names and masses together") {
    BlockCase block{{2, 1, 1}, {2, 1, 1}};
    Case c = block.settings();
    c.fem.surface = {{"front", "xmax"}, {"roof", "zmax"}};
    const Model model = build_model(c);
    const CoupledSurface& surface = model.surface;
    CHECK(surface.names == std::vector<std::string>{"front", "roof"});
    CHECK(surface.group == std::vector<std::int32_t>{0, 1, 1});
    CHECK(surface.node.size() == 8);  // 4 of xmax, 6 of zmax, 2 shared
    for (const Quad& q : surface.quad)
        for (std::int32_t n : q) CHECK((n >= 0 && n < 8));
    for (std::int32_t n : surface.quad[0]) CHECK(model.mesh.x[surface.node[n]][0] == 2);
}

TEST_CASE("parts must cover the mesh once, and names must exist") {
    BlockCase block;
    Case c = block.settings();
    c.fem.part.clear();
    CHECK_THROWS_WITH(build_model(c),
                      Catch::Contains("hexahedron 1") && Catch::Contains("no part"));
    c.fem.part = {{"block", "solid"}, {"block", "solid"}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("belongs to both"));
    c.fem.part = {{"block", "gold"}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("\"gold\""));
    c = block.settings();
    c.fem.material[0].poisson_ratio = 0.5;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("poisson_ratio"));
    c = block.settings();
    c.info.dimension = 2;
    c.info.thickness = 0.5;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("slab"));
    c.info.thickness = 1;
    const Structure slab(build_model(c), 1);  // plane strain: no node moves in y
    for (const NodeRow& inverse_mass : slab.nodes().inverse_mass) {
        CHECK(inverse_mass.c[1] == 0);
        CHECK(inverse_mass.c[0] > 0);
    }
}

}  // namespace
}  // namespace undertow::fem
