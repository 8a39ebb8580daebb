#pragma once
// closest_point() of facet.hpp for eight points and eight facets at once: the same formulas in the
// same order (pieces.hpp), the same bits.

#include "contact/pieces.hpp"
#include "contact/surface.hpp"

namespace undertow::contact {

/// Feet of eight points, each on its own facet; fields as in Foot.
struct LaneFeet {
    Lanes weight[4];
    Three<Lanes> offset, normal;  // [m], unit
    Lanes distance, side;         // [m]; side = offset along the normal
    Lanes rim;                    // nodes of the outline, as bits 0 to 3; whole numbers
};

/// Rows of the nodes of eight facets.
struct LaneCorners {
    LaneRows node[4];
    LaneMask triangle() const { return equal(node[2], node[3]); }
};
inline LaneCorners corners_of(const Surface& surface, const LaneRows& facet) {
    const std::int32_t* quad = surface.corners(0);
    LaneCorners corners;
    for (int a = 0; a < 4; ++a) corners.node[a] = gather_rows(quad + a, 4 * facet);
    return corners;
}

/// Fetches what closest_points() and contacts will need of the nodes of eight facets.
[[gnu::always_inline]] inline void fetch_nodes(const Surface& surface,
                                               std::span<const std::int32_t> facet) {
    const double *x = surface.x().data(), *v = surface.v().data();
    for (const std::int32_t f : facet) {
        const std::int32_t* node = surface.corners(std::uint32_t(f));
        for (int a = 0; a < 4; ++a) {
            __builtin_prefetch(x + 3 * std::size_t(node[a]));
            __builtin_prefetch(v + 3 * std::size_t(node[a]));
        }
    }
}

/// [m/s] velocity v of points against the surface at sum_a w_a x_a of nodes a.
inline Three<Lanes> relative_velocity(const Three<Lanes>& v, const Surface& surface,
                                      const LaneRows (&node)[4], const Lanes (&weight)[4]) {
    const double* of_nodes = surface.v().data();
    Three<Lanes> at = weight[0] * gather_three(of_nodes, node[0]);
    for (int a = 1; a < 4; ++a) at = at + weight[a] * gather_three(of_nodes, node[a]);
    return v - at;
}

LaneFeet closest_points(const Three<Lanes>& point, const Surface& surface, const LaneRows& facet);

}  // namespace undertow::contact
