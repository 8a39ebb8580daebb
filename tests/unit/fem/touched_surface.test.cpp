// A ring of flat facets as contact sees it: round.

#include "fem_solver/contact_pairs/touched_surface.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "support.hpp"
#include "two_solids.hpp"

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

const double pi = std::acos(-1.0);

/// Half a ring of 24 facets around (2.1 mm between chord and arc): inner radius 0.99 m, outer 1.01 m, z from -0.5 to 0.
struct Ring {
    Mesh mesh;
    Nodes nodes;
    std::vector<Quad> facets;
    Ring() {
        add_block(mesh, "ring", {{0.99, 0, -0.5}, {1.01, pi, 0}}, {1, 24, 5});
        map_nodes(mesh, [](const Vec3& x) {
            return Vec3{x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), x[2]};
        });
        for (const char* side : {"ring.xmin", "ring.xmax", "ring.zmin"})
            facets.insert(facets.end(), mesh.facet_sets[side].begin(), mesh.facet_sets[side].end());
        nodes.x.resize(mesh.x.size());
        nodes.v.resize(mesh.x.size());
        nodes.mass.assign(mesh.x.size(), 1.0);
        for (std::size_t n = 0; n < mesh.x.size(); ++n)
            for (int d = 0; d < 3; ++d) nodes.x[n].c[d] = mesh.x[n][d];
    }
};

TEST_CASE("a ring of flat facets is touched as the round wall it stands for, ends included") {
    const Ring ring;
    const TouchedSurface surface(ring.facets, ring.nodes, SurfaceKind::rigid);
    std::vector<std::uint32_t> all(ring.facets.size());
    std::iota(all.begin(), all.end(), 0u);
    struct Line {
        const char* name;
        double radius, z, exact, n_r, n_z;
    };
    const double s = std::sqrt(0.5);
    double worst_distance = 0, worst_normal = 0;
    for (const Line& line :
         {Line{"outside", 1.015, -0.23, 0.005, 1, 0}, Line{"inside", 0.985, -0.23, 0.005, -1, 0},
          Line{"outer edge of the tip", 1.015, -0.505, 0.005 / s, s, -s},
          Line{"inner edge of the tip", 0.985, -0.505, 0.005 / s, -s, -s}}) {
        for (int i = 0; i <= 600; ++i) {
            const double angle = pi * i / 600;
            const Vector radial(std::cos(angle), std::sin(angle), 0);
            Touch touch;
            REQUIRE(surface.touch(line.radius * radial + line.z * Vector::UnitZ(), all, touch));
            const Vector normal = line.n_r * radial + line.n_z * Vector::UnitZ();
            const double off = std::abs(touch.distance - line.exact);
            const double turned = (touch.normal - normal).norm();
            INFO(line.name << " at " << angle << ": distance " << touch.distance << ", normal "
                           << touch.normal.transpose());
            // With a = 0.065, half a facet's angle, the parabola misses the arc by a^4/8 of the
            // radius and its normal by a^3; flat facets would by a^2/2 (2.1 mm) and a.
            CHECK(off < 3e-6);
            CHECK(turned < 3e-4);
            worst_distance = std::max(worst_distance, off);
            worst_normal = std::max(worst_normal, turned);
        }
    }
    WARN("round wall from 24 facets: distance off by " << worst_distance << " m, normal by "
                                                       << worst_normal);
}

TEST_CASE("a sharp corner of a block pushes along the line from it, and a rim ends the surface") {
    Mesh mesh;
    add_block(mesh, "block", {{0, 0, 0}, {1, 1, 1}}, {2, 2, 2});
    std::vector<Quad> facets;
    for (const char* side : {"block.xmax", "block.ymax", "block.zmax"})
        facets.insert(facets.end(), mesh.facet_sets[side].begin(), mesh.facet_sets[side].end());
    Nodes nodes;
    nodes.x.resize(mesh.x.size());
    nodes.v.resize(mesh.x.size());
    nodes.mass.assign(mesh.x.size(), 1.0);
    for (std::size_t n = 0; n < mesh.x.size(); ++n)
        for (int d = 0; d < 3; ++d) nodes.x[n].c[d] = mesh.x[n][d];
    const TouchedSurface surface(facets, nodes, SurfaceKind::rigid);
    std::vector<std::uint32_t> all(facets.size());
    std::iota(all.begin(), all.end(), 0u);
    Touch touch;
    REQUIRE(surface.touch({1.01, 1.02, 1.02}, all, touch));
    CHECK(touch.distance == Approx(0.03));
    CHECK((touch.normal - Vector(1, 2, 2) / 3).norm() < 1e-12);
    REQUIRE(surface.touch({1.03, 0.3, 1.04}, all, touch));  // an edge
    CHECK(touch.distance == Approx(0.05));
    CHECK((touch.normal - Vector(0.6, 0, 0.8)).norm() < 1e-12);
    REQUIRE(surface.touch({0.3, 0.3, 1.02}, all, touch));  // a face
    CHECK(touch.distance == Approx(0.02));
    REQUIRE(surface.touch({0.3, 0.3, 0.98}, all, touch));  // from behind
    CHECK(touch.distance == Approx(-0.02));
    CHECK_FALSE(surface.touch({-0.05, 0.3, 1.01}, all, touch));  // beyond where it just ends
}

}  // namespace
}  // namespace undertow::fem
