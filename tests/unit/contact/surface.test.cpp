#include "contact/surface.hpp"

#include <catch2/catch.hpp>

#include "contact/boxes.hpp"
#include "scene.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;
using Catch::Contains;

TEST_CASE("a sound plate has no defect") {
    const Nodes plate = flat_plate(4, 3, 0.1, 1);
    CHECK(find_defect(plate.x, plate.quad).empty());
}

TEST_CASE("a degenerate facet is refused by its number") {
    Nodes plate = flat_plate(3, 1, 0.1, 1);
    SECTION("a node used twice") {
        plate.quad[4 * 1 + 1] = plate.quad[4 * 1];
        CHECK_THAT(find_defect(plate.x, plate.quad), Contains("facet 1 uses a node twice"));
    }
    SECTION("no area") {
        for (int node : {2, 6}) plate.x[3 * node + 0] = 0.1;  // facet 1 folded to a line
        CHECK_THAT(find_defect(plate.x, plate.quad), Contains("facet 1 has no area"));
    }
    SECTION("corners in crossing order") {
        std::swap(plate.quad[4 * 2 + 2], plate.quad[4 * 2 + 3]);
        CHECK_THAT(find_defect(plate.x, plate.quad), Contains("facet 2"));
    }
    SECTION("a facet turned over") {
        std::swap(plate.quad[4 * 2 + 1], plate.quad[4 * 2 + 3]);
        CHECK_THAT(find_defect(plate.x, plate.quad), Contains("disagree on which side is wet"));
    }
}

TEST_CASE("a triangle is a quad that repeats its third node") {
    const Nodes triangle = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2, 2}, 1);
    CHECK(find_defect(triangle.x, triangle.quad).empty());
}

TEST_CASE("outer edges of an open plate are free, inner ones are not") {
    const Nodes plate = flat_plate(2, 1, 1, 1);  // nodes 0 1 2 / 3 4 5, facets (0 1 4 3) (1 2 5 4)
    const Surface surface = plate.surface();
    CHECK(surface.is_free_rim(0, 0b0011));
    CHECK_FALSE(surface.is_free_rim(0, 0b0110));  // edge 1-4, shared
    CHECK(surface.is_free_rim(0, 0b0010));        // node 1 lies on a free edge
    CHECK_FALSE(surface.is_free_rim(0, 0));
}

TEST_CASE("every point within range of a facet lies in a box") {
    const Nodes plate = flat_plate(30, 20, 0.1, 1);
    Surface surface = plate.surface();
    surface.move(plate.x, plate.v);
    const double range = 0.05;
    const std::vector<double> boxes = boxes_around(surface, range, 16);
    CHECK(boxes.size() / 6 <= 16);
    CHECK(boxes.size() / 6 > 4);
    for (double x = -0.049; x < 3.05; x += 0.03)
        for (double y = -0.049; y < 2.05; y += 0.03) {
            bool inside = false;
            for (std::size_t b = 0; b < boxes.size(); b += 6)
                inside =
                    inside || (boxes[b] <= x && x <= boxes[b + 3] && boxes[b + 1] <= y &&
                               y <= boxes[b + 4] && boxes[b + 2] <= 0.049 && 0.049 <= boxes[b + 5]);
            REQUIRE(inside);
        }
}
