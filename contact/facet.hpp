#pragma once
// Closest point on one facet. A quad is four triangles about its centroid, which carries a quarter
// of each node: the closest point is exactly sum_a w_a x_a, neighbors share their edges
// (watertight), and a force split by w_a at that point conserves moments.

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace undertow::contact {

using Vec = Eigen::Vector3d;

/// Nodes of a facet, counter-clockwise seen from the wet side. A triangle repeats its third node.
struct Corners {
    std::array<Vec, 4> x;  // [m]
    bool triangle = false;
};

/// Foot of the perpendicular (or the nearest edge or corner point) of a point on a facet.
struct Foot {
    std::array<double, 4> weight;  // w_a of the facet's nodes, sum 1
    Vec offset;                    // [m] point minus foot
    Vec normal;                    // unit normal of the plane piece that holds the foot, wet side
    double distance;               // [m] length of offset
    std::uint8_t rim;              // nodes (bits 0 to 3) of the outline edge or corner that holds
                                   // the foot; 0 = inside the facet
};

/// Closest point of a facet to `point`.  [Ericson 2005, Real-Time Collision Detection, 5.1.5]
Foot closest_point(const Vec& point, const Corners& facet);

}  // namespace undertow::contact
