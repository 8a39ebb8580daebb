#include "coupler/joint_surface.hpp"

#include <catch2/catch.hpp>

#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::coupler;
using Catch::Contains;

namespace {

wire::Mesh square(const std::string& name, double x0, const std::string& group) {
    wire::Mesh mesh;
    mesh.mesh = name;
    mesh.kind = "surface";
    mesh.groups = {group};
    mesh.x = {x0, 0, 0, x0 + 1, 0, 0, x0 + 1, 1, 0, x0, 1, 0};
    mesh.mass = {1, 2, 3, 4};
    mesh.quad = {0, 1, 2, 3};
    mesh.group = {0};
    return mesh;
}

std::string refusal(const std::vector<wire::Mesh>& meshes) {
    try {
        join_surfaces(meshes);
    } catch (const PeerError& error) {
        return error.code + ": " + error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("meshes are joined in the order of STATE, equal names become one surface") {
    const JointSurface joint =
        join_surfaces({square("a", 0, "plate"), square("b", 5, "wall"), square("c", 9, "plate")});
    CHECK(joint.mass.size() == 12);
    CHECK(joint.quad == std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
    CHECK(joint.names == std::vector<std::string>{"plate", "wall"});
    CHECK(joint.group == std::vector<std::int32_t>{0, 1, 0});
    CHECK(joint.x[3 * 4] == 5);
}

TEST_CASE("a mesh that cannot be coupled is refused with its name and the facet") {
    auto flat = square("wall", 0, "wall");
    flat.x[3 * 2 + 1] = flat.x[3 * 3 + 1] = 0;
    CHECK_THAT(refusal({square("plate", 0, "plate"), flat}),
               Contains("E_MESH") && Contains("'wall'") && Contains("facet 0 has no area"));
    auto shell = square("skirt", 0, "skirt");
    shell.thickness = 0.02;
    CHECK_THAT(refusal({shell}), Contains("'skirt'") && Contains("both of its faces"));
    auto empty = square("nothing", 0, "nothing");
    empty.quad.clear();
    empty.group.clear();
    CHECK_THAT(refusal({empty}), Contains("no facets"));
}
