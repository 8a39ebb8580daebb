#include "contact/facet.hpp"

#include "contact/facet_lanes.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace undertow::contact;

namespace {

const Corners unit_square{{Vec(0, 0, 0), Vec(1, 0, 0), Vec(1, 1, 0), Vec(0, 1, 0)}, false};
const Corners warped{{Vec(0, 0, 0.1), Vec(1, 0, -0.1), Vec(1.2, 1, 0.15), Vec(0, 0.9, -0.05)},
                     false};

Vec weighted(const Foot& foot, const Corners& facet) {
    Vec sum = Vec::Zero();
    for (int a = 0; a < 4; ++a) sum += foot.weight[a] * facet.x[a];
    return sum;
}

/// Smallest distance over a fine grid on the four triangles: slow, and
/// obviously right.
double sampled_distance(const Vec& x, const Corners& facet) {
    const Vec center = 0.25 * (facet.x[0] + facet.x[1] + facet.x[2] + facet.x[3]);
    double best = 1e300;
    for (int k = 0; k < 4; ++k)
        for (int i = 0; i <= 200; ++i)
            for (int j = 0; i + j <= 200; ++j) {
                const double u = i / 200.0, w = j / 200.0;
                const Vec p = u * facet.x[k] + w * facet.x[(k + 1) % 4] + (1 - u - w) * center;
                best = std::min(best, (x - p).norm());
            }
    return best;
}

}  // namespace

TEST_CASE("the foot is the weighted sum of the nodes, weights sum to 1 and none is negative") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1, 2);
    for (const Corners& facet : {unit_square, warped})
        for (int i = 0; i < 500; ++i) {
            const Vec x(any(random), any(random), any(random));
            const Foot foot = closest_point(x, facet);
            double sum = 0;
            for (double w : foot.weight) {
                sum += w;
                CHECK(w >= -1e-15);
            }
            CHECK(sum == Approx(1).epsilon(1e-14));
            CHECK((x - foot.offset - weighted(foot, facet)).norm() < 1e-14);
        }
}

TEST_CASE("no point of a warped facet is nearer than the foot") {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> any(-1, 2);
    for (int i = 0; i < 50; ++i) {
        const Vec x(any(random), any(random), any(random));
        const double sampled = sampled_distance(x, warped);
        const double found = closest_point(x, warped).distance;
        CHECK(found <= sampled + 1e-12);
        CHECK(found >= sampled - 0.01);  // the grid's own spacing
    }
}

TEST_CASE("a foot inside has no rim, one on an edge two nodes, one on a corner one") {
    CHECK(closest_point(Vec(0.4, 0.3, 0.5), unit_square).rim == 0);
    CHECK(closest_point(Vec(0.5, 0.5, 0.5), unit_square).rim == 0);  // the centroid is inside
    CHECK(closest_point(Vec(0.4, -0.3, 0.5), unit_square).rim == 0b0011);
    CHECK(closest_point(Vec(-0.4, 0.3, 0.5), unit_square).rim == 0b1001);
    CHECK(closest_point(Vec(1.4, 1.3, 0.5), unit_square).rim == 0b0100);
    const Corners triangle{{Vec(0, 0, 0), Vec(1, 0, 0), Vec(0, 1, 0), Vec(0, 1, 0)}, true};
    CHECK(closest_point(Vec(0.2, 0.2, 1), triangle).rim == 0);
    CHECK(closest_point(Vec(-0.2, 0.2, 1), triangle).rim == 0b0101);
    CHECK(closest_point(Vec(-0.2, 1.4, 1), triangle).rim == 0b0100);
}

TEST_CASE("over a flat quad the foot lies straight below and the normal points to the wet side") {
    const Foot foot = closest_point(Vec(0.7, 0.2, 0.3), unit_square);
    CHECK(foot.distance == Approx(0.3));
    CHECK(foot.normal[2] == Approx(1));
    CHECK(closest_point(Vec(0.7, 0.2, -0.3), unit_square).normal[2] == Approx(1));
}

TEST_CASE("neighboring quads are watertight: at the common edge both give the same foot") {
    const Corners left{{Vec(0, 0, 0.1), Vec(1, 0, 0), Vec(1, 1, 0.2), Vec(0, 1, 0)}, false};
    const Corners right{{Vec(1, 0, 0), Vec(2, 0.1, 0.3), Vec(2, 1, 0), Vec(1, 1, 0.2)}, false};
    for (double y = 0.05; y < 1; y += 0.1) {
        const Vec on_edge(1, y, 0.2 * y);
        CHECK(closest_point(on_edge, left).distance < 1e-15);
        CHECK(closest_point(on_edge, right).distance < 1e-15);
    }
}

TEST_CASE("eight closest points at once are those of one after the other: weights and offsets bit for bit") {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> any(-0.3, 1.3);
    // Warped quads and triangles in a fan of shared corners; feet in all regions.
    std::vector<double> x;
    std::vector<std::int32_t> quad;
    for (int n = 0; n < 40; ++n)
        for (int axis = 0; axis < 3; ++axis) x.push_back(any(random));
    for (int f = 0; f < 64; ++f) {
        const std::int32_t first = std::int32_t(random() % 37);
        quad.insert(quad.end(), {first, first + 1, first + 2, f % 3 ? first + 3 : first + 2});
    }
    Surface surface(quad, std::vector<double>(40, 1));
    surface.move(x, x);
    std::array<int, 16> seen{};
    for (int run = 0; run < 4000; ++run) {
        Three<Lanes> point;
        LaneRows facet;
        for (int lane = 0; lane < lane_count; ++lane) {
            facet[lane] = std::int32_t(random() % 64);
            point.x[lane] = any(random), point.y[lane] = any(random), point.z[lane] = any(random);
        }
        if (run % 7 == 0)  // triangles alone
            for (int lane = 0; lane < lane_count; ++lane) facet[lane] = 3 * (facet[lane] / 3);
        const LaneFeet feet = closest_points(point, surface, facet);
        for (int lane = 0; lane < lane_count; ++lane) {
            const Foot foot =
                closest_point(Vec(point.x[lane], point.y[lane], point.z[lane]),
                              surface.shape(std::uint32_t(facet[lane])));
            for (int a = 0; a < 4; ++a) REQUIRE(feet.weight[a][lane] == foot.weight[a]);
            REQUIRE(feet.distance[lane] == foot.distance);
            REQUIRE(Vec(feet.offset.x[lane], feet.offset.y[lane], feet.offset.z[lane]) ==
                    foot.offset);
            // Tells sides only: which product of a cross product is fused is the compiler's choice.
            const Vec normal(feet.normal.x[lane], feet.normal.y[lane], feet.normal.z[lane]);
            REQUIRE((normal - foot.normal).norm() < 1e-14);
            REQUIRE(int(feet.rim[lane]) == foot.rim);
            ++seen[foot.rim];
        }
    }
    for (int rim : {0, 1, 2, 4, 8, 3, 6, 12, 9, 5}) CHECK(seen[rim] > 20);
}
