// Abaqus input files: sets, surfaces, parts, and what is refused; the same run as from a Gmsh file.

#include "fem_solver/setup/abaqus_mesh.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "fem_solver/setup/gmsh_mesh.hpp"
#include "fem_solver/setup/mesh_check.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

const std::string meshes = UNDERTOW_TEST_MESHES;

struct InputFile {
    std::filesystem::path path = std::filesystem::temp_directory_path() /
                                 ("undertow-abaqus-" + std::to_string(::getpid()) + ".inp");
    ~InputFile() { std::filesystem::remove(path); }
    Mesh read(const std::string& text, SetsOfCase of_case = {}) const {
        std::ofstream(path) << text;
        return read_abaqus(path.string(), std::move(of_case));
    }
    std::string message(const std::string& text) const {
        try {
            read(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
};

std::string with(std::string text, const std::string& what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

/// Twice the area vector of a facet.
Vec3 area2(const Mesh& mesh, const Quad& q) {
    Vec3 a, b, n;
    const std::int32_t last = q[3] == q[2] ? q[2] : q[3];
    for (int d = 0; d < 3; ++d) {
        a[d] = mesh.x[q[2]][d] - mesh.x[q[0]][d];
        b[d] = mesh.x[last][d] - mesh.x[q[1]][d];
    }
    for (int d = 0; d < 3; ++d)
        n[d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
    return n;
}

NodeRows state_after_a_run(const std::string& file) {
    BlockCase block;
    Case c = block.settings();
    c.fem.block.reset();
    c.fem.mesh = meshes + file;
    c.fem.part = {{"foot", "solid"}, {"head", "solid"}};
    c.fem.support = {{"clamp", {"x", "y", "z"}}};
    c.fem.pressure = {{"side", 1e4}};
    c.fem.traction = {{"end", {0, 2e4, 0}}};
    Structure structure(build_model(c), 1);
    const double dt = structure.stable_step().dt;
    march(structure, dt, 300);
    CHECK(structure.largest_displacement() > 1e-5);
    return structure.nodes().x;
}

TEST_CASE("a mesh gives the same bits from .msh and from .inp, as Gmsh and meshio write them") {
    const NodeRows msh = state_after_a_run("/two_bodies.msh");
    for (const char* file : {"/two_bodies.inp", "/two_bodies_meshio.inp"}) {
        const NodeRows inp = state_after_a_run(file);
        REQUIRE(inp.size() == msh.size());
        CHECK(std::memcmp(inp.data(), msh.data(), inp.size() * sizeof inp[0]) == 0);
    }
    const Mesh mesh = read_abaqus(meshes + "/two_bodies.inp");
    CHECK(check_mesh(mesh).worst_corner == Approx(1));  // skewed, not distorted
    CHECK(mesh.nodes_of("edge", "test").size() == 3);
    CHECK(mesh.elements_of("foot", "test").size() == 16);
}

// A brick of two hexahedra along x with a plate beside it and a tetrahedron, in the words of
// Abaqus/CAE, with all that is skipped.
const std::string flat_file = R"(*Heading
 a brick, a plate
** a comment
*Preprint, echo=NO
*NODE, NSET=All
1, 0, 0, 0
2, 1., 0., 0.
3, +1.0, 1D0, 0.0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
9, 2, 0, 0
10, 2, 1, 0
11, 2, 0, 1
12, 2, 1, 1
21, 0, 0, 5
22, 1, 0, 5
23, 1, 1, 5
24, 0, 1, 5
30, 5, 5, 5
31, 0, 0, 7
32, 1, 0, 7
33, 0, 1, 7
34, 0, 0, 8
*Element, type=C3D8R, elset=Left
10, 1, 2, 3, 4,
5, 6, 7, 8
*ELEMENT, TYPE=C3D8R,
 ELSET="Right"
11, 2, 9, 10, 3, 6, 11, 12, 7

*Element, type=S4R, elset=Plate
40, 21, 22, 23, 24
*Element, type=C3D4, elset=Wedge
50, 31, 32, 33, 34
*Elset, elset=Brick
left, RIGHT
*Elset, elset=Range, generate
10, 11, 1
*Nset, nset=Bottom, generate
1, 4
*Nset, nset=OfElements, elset=Right
*Surface, type=ELEMENT, name=Roof
Brick, S2
*Surface, name=Skin
Brick,
*Surface, name=Ends
10, S6
11, S4
*Surface, name=Up
Plate, SPOS
*Surface, name=Down
Plate, SNEG
*Surface, name=Faces
Wedge, S1
Wedge, S2
Wedge, S3
Wedge, S4
*Surface, name=Inner
10, S4
*Nset, nset=Torn
1, 99
*Material, name=steel
*Elastic
2e11, 0.3
*Solid Section, elset=Brick, material=steel
*Material, name=mud
*Elastic
1e6, 0.49
*Step
*Static
1., 1.
*Boundary
Bottom, 1, 3
*End Step
)";

TEST_CASE("an Abaqus file brings nodes, elements, sets and surfaces, whatever else is in it") {
    const InputFile file;
    const Mesh mesh = file.read(flat_file, {{}, {"Plate"}});
    CHECK(mesh.hexahedra.size() == 2);
    CHECK(mesh.shells.size() == 1);
    CHECK(mesh.tetrahedra.size() == 1);
    CHECK(mesh.x.size() == 20);  // node 30 is of nothing
    check_mesh(mesh);
    CHECK(mesh.x[2] == Vec3{1, 1, 0});
    CHECK(mesh.element_name(1) == "hexahedron 11");
    CHECK(mesh.elements_of("Brick", "test") == std::vector<std::int32_t>{0, 1});
    CHECK(mesh.elements_of("Range", "test") == std::vector<std::int32_t>{0, 1});
    CHECK(mesh.elements_of("Left", "test") == std::vector<std::int32_t>{0});
    CHECK(mesh.elements_of("Plate", "test") == std::vector<std::int32_t>{3});
    CHECK(mesh.nodes_of("Bottom", "test") == std::vector<std::int32_t>{0, 1, 2, 3});
    CHECK(mesh.nodes_of("OfElements", "test").size() == 8);
    CHECK(mesh.nodes_of("All", "test").size() == 20);
    const auto total = [&](const char* set) {
        Vec3 sum{};
        for (const Quad& q : mesh.facets_of(set, "test")) {
            const Vec3 n = area2(mesh, q);
            for (int d = 0; d < 3; ++d) sum[d] += 0.5 * n[d];
        }
        return sum;
    };
    CHECK(total("Roof") == Vec3{0, 0, 2});
    CHECK(mesh.facets_of("Skin", "test").size() == 10);
    CHECK(total("Skin") == Vec3{0, 0, 0});
    REQUIRE(mesh.facets_of("Ends", "test").size() == 2);
    CHECK(area2(mesh, mesh.facets_of("Ends", "test")[0]) == Vec3{-2, 0, 0});
    CHECK(area2(mesh, mesh.facets_of("Ends", "test")[1]) == Vec3{2, 0, 0});
    CHECK(total("Up") == Vec3{0, 0, 1});
    CHECK(total("Down") == Vec3{0, 0, -1});
    CHECK(mesh.facets_of("Faces", "test").size() == 4);
    CHECK(total("Faces")[0] == Approx(0).margin(1e-15));
    // sets that are no good are an error where they are used alone
    CHECK_THROWS_WITH(mesh.facets_of("Inner", "fem.pressure"),
                      Catch::Contains("fem.pressure") && Catch::Contains("face S4 of element 10") &&
                          Catch::Contains("between two"));
    CHECK(mesh.nodes_of("Inner", "test").size() == 4);
    CHECK_THROWS_WITH(mesh.nodes_of("Torn", "fem.support"),
                      Catch::Contains("node 99") && Catch::Contains("line 64"));
    REQUIRE(mesh.remarks.size() == 1);
    CHECK_THAT(mesh.remarks[0],
               Catch::Contains("skipped: *MATERIAL, *ELASTIC, *SOLIDSECTION, *STEP, *STATIC, "
                               "*BOUNDARY"));
}

TEST_CASE("the faces of an Abaqus hexahedron are numbered as its manual has them") {
    const InputFile file;
    std::string text = flat_file.substr(0, flat_file.find("*Elset, elset=Brick"));
    for (int f = 1; f <= 6; ++f) {
        const std::string s = std::to_string(f);
        text += "*Surface, name=F" + s + "\n10, S" + s + "\n";
    }
    text = with(text, "11, 2, 9, 10, 3, 6, 11, 12, 7\n", "");  // the left one alone
    const Mesh mesh = file.read(text, {{}, {"Plate"}});
    const Vec3 outward[6] = {{0, 0, -2}, {0, 0, 2}, {0, -2, 0}, {2, 0, 0}, {0, 2, 0}, {-2, 0, 0}};
    for (int f = 0; f < 6; ++f)
        CHECK(area2(mesh, mesh.facets_of("F" + std::to_string(f + 1), "test")[0]) == outward[f]);
}

TEST_CASE("parts of an assembly come in their instances, moved and turned") {
    const std::string cube = R"(*Node
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*Element, type=C3D8
1, 1, 2, 3, 4, 5, 6, 7, 8
*Elset, elset=Body
1
*Nset, nset=Foot
1, 2, 3, 4
*End Part
)";
    const std::string text = "*Part, name=A\n" + cube + "*Part, name=B\n" + cube +
                             "*Part, name=Unused\n" + cube + R"(*Assembly, name=Assembly
*Instance, name=A-1, part=A
*End Instance
*Instance, name=B-1, part=B
 2., 0., 0.
 2., 0., 0.,  2., 0., 1.,  90.
*End Instance
*Nset, nset=Both, instance=A-1
 1,
*Nset, nset=Both, instance=B-1
 1,
*Elset, elset=All
A-1.Body, B-1.1
*Surface, type=ELEMENT, name=Top
A-1.Body, S2
*End Assembly
)";
    const InputFile file;
    const Mesh mesh = file.read(text);
    check_mesh(mesh);
    REQUIRE(mesh.x.size() == 16);
    CHECK(mesh.elements_of("All", "test") == std::vector<std::int32_t>{0, 1});
    CHECK(mesh.elements_of("B-1.Body", "test") == std::vector<std::int32_t>{1});
    CHECK(mesh.nodes_of("A-1.Foot", "test") == std::vector<std::int32_t>{0, 1, 2, 3});
    CHECK(mesh.nodes_of("Both", "test") == std::vector<std::int32_t>{0, 8});
    CHECK(mesh.facets_of("Top", "test").size() == 1);
    // x of node 2 of B: moved to (3, 0, 0), turned by 90 degrees about z through (2, 0): (2, 1, 0)
    const Vec3 turned{2, 1, 0};
    for (int d = 0; d < 3; ++d) CHECK(mesh.x[9][d] == Approx(turned[d]).margin(1e-15));
    REQUIRE(mesh.remarks.size() == 1);
    CHECK_THAT(mesh.remarks[0], Catch::Contains("*PART Unused"));
    CHECK_THAT(file.message(with(text, "name=B-1, part=B", "name=B-1, part=A")),
               Catch::Contains("has the instance A-1 already"));
    CHECK_THAT(file.message(with(text, "name=B-1, part=B", "name=B-1, part=C")),
               Catch::Contains("there is no *PART C"));
}

TEST_CASE("an Abaqus file that cannot be used is refused with file, line and advice") {
    const InputFile file;
    const auto message = [&](const char* what, const char* by) {
        return file.message(with(flat_file, what, by));
    };
    CHECK_THAT(message("type=C3D8R", "type=C3D20"), Catch::Contains(".inp:27") &&
                                                        Catch::Contains("C3D20 (line 27)") &&
                                                        Catch::Contains("first order"));
    CHECK_THAT(message("*Elset, elset=Brick", "*Include, input=more.inp\n*Elset, elset=Brick"),
               Catch::Contains(".inp:38: *INCLUDE is not followed"));
    CHECK_THAT(message("*NODE, NSET=All", "*NODE, INPUT=nodes.txt"),
               Catch::Contains("INPUT = nodes.txt of *NODE"));
    CHECK_THAT(message("*NODE, NSET=All", "*NODE, SYSTEM=C"), Catch::Contains("rectangular"));
    CHECK_THAT(message("*Elset, elset=Brick", "*Elgen\n1\n*Elset, elset=Brick"),
               Catch::Contains("*ELGEN makes or moves"));
    CHECK_THAT(message("5, 6, 7, 8\n", "5, 6, 7\n"),
               Catch::Contains("element 10 (C3D8R) has 7 nodes where there must be 8"));
    CHECK_THAT(message("5, 6, 7, 8\n", "5, 6, 7, 77\n"), Catch::Contains("node 77 is not in"));
    CHECK_THAT(message("5, 6, 7, 8\n", "5, 6, x7, 8\n"), Catch::Contains("found \"x7\""));
    CHECK_THAT(message("11, 2, 9", "10, 2, 9"), Catch::Contains("element 10 (C3D8R) is defined"));
    CHECK_THAT(message("12, 2, 1, 1", "11, 2, 1, 1"), Catch::Contains("node 11 is defined twice"));
    CHECK_THAT(message("12, 2, 1, 1", "12, 2, nan, 1"), Catch::Contains("found \"nan\""));
    CHECK_THAT(message("10, 11, 1\n", "1, 900000000\n"), Catch::Contains("more than the part has"));
    CHECK_THAT(message("11, S4", "11, S7"), Catch::Contains("face S7 of element 11"));
    CHECK_THAT(message("*Heading", "* Heading"), Catch::Contains("is a shell of no part"));
    CHECK_THAT(message(", elset=Plate", ""), Catch::Contains("shell 40 is in no element set"));
    CHECK_THAT(message("*Elset, elset=Brick",
                       "*Element, type=B31, elset=Mast\n60, 24, 30\n*Elset, elset=Brick"),
               Catch::Contains(".inp:39: element 60 is a beam"));
    CHECK_THAT(file.message("solid cube\n"), Catch::Contains(".inp:1: not an Abaqus"));
    CHECK_THAT(file.message("*NODE\n1, 0, 0, 0\n"), Catch::Contains("has no 8-node hexahedra"));
    CHECK_THROWS_AS(read_abaqus("/none.inp"), InputError);
    // a curve of beams along an edge of the brick, as meshio writes it
    const Mesh mesh =
        file.read(with(flat_file, "*Elset, elset=Brick",
                       "*Element, type=B31H, elset=Mast\n60, 1, 2\n*Elset, elset=Brick"),
                  {{}, {"Plate"}});
    CHECK(mesh.nodes_of("Mast", "test") == std::vector<std::int32_t>{0, 1});
    CHECK_THAT(mesh.remarks[0], Catch::Contains("1 beam elements"));
}

TEST_CASE("a torn Abaqus file is refused or read, never worse") {
    const InputFile file;
    for (std::size_t n = 0; n < flat_file.size(); n += 5) {
        try {
            file.read(flat_file.substr(0, n), {{}, {"Plate"}});
        } catch (const InputError&) {
        }
    }
    SUCCEED();
}

}  // namespace
}  // namespace undertow::fem
