#pragma once
// A closed surface of triangles: the nearest point on it, and whether a point is inside.

#include <array>
#include <cstdint>
#include <vector>

#include "case/case.hpp"

namespace undertow::sph {

/// Vertices that facets share are one; normals point away from what is enclosed.
struct TriangleMesh {
    std::vector<Vec3> vertex;                        // [m]
    std::vector<std::array<std::int32_t, 3>> facet;  // counterclockwise seen from outside
};

class TriangleSurface {
 public:
    explicit TriangleSurface(TriangleMesh mesh);

    struct Nearest {
        double distance;  // [m] never negative
        Vec3 point;       // [m]
        int facet;
    };
    Nearest nearest(const Vec3& x) const;

    /// How often the surface winds around x: 1 inside, 0 outside, also where facets overlap or
    /// leave hairline gaps.  [Jacobson, Kavan & Sorkine-Hornung 2013; far facets together as one
    /// dipole, Barill et al. 2018]
    double winding_number(const Vec3& x) const;

    Vec3 normal(int facet) const;                  // unit vector
    const Box& bounds() const { return bounds_; }  // [m]
    int facets() const { return static_cast<int>(mesh_.facet.size()); }
    double volume() const;  // enclosed [m3]

 private:
    /// A node of the tree: facets [first, last) in tree order; children 0 = a leaf.
    struct Node {
        Vec3 low, high;       // [m]
        Vec3 dipole, middle;  // sum of area vectors [m2], their mean place [m]
        double radius;        // [m] around `middle`, holds all facets
        std::int32_t first, last, left, right;
    };
    std::int32_t build(std::int32_t first, std::int32_t last);
    Vec3 area_vector(int facet) const;
    double solid_angle(int facet, const Vec3& x) const;

    TriangleMesh mesh_;
    std::vector<Node> tree_;
    Box bounds_;
};

}  // namespace undertow::sph
