#include "contact/facet_lanes.hpp"

#include <limits>

namespace undertow::contact {

namespace {

void close_on_quads(const Three<Lanes>& point, const Three<Lanes> (&x)[4],
                    const Three<Lanes>& center, LaneFeet& feet, Three<Lanes>& plane) {
    const Three<Lanes> ap[4] = {point - x[0], point - x[1], point - x[2], point - x[3]};
    const Lanes none = spread<Lanes>(0);
    Lanes nearest = spread<Lanes>(std::numeric_limits<double>::infinity());
    Lanes wa = none, wb = none, wc = none, rim = none;
    // Piece 0 stands, as in closest_point(), where no distance is a number.
    LaneMask is[4] = {first_lanes(lane_count), first_lanes(0), first_lanes(0), first_lanes(0)};
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        const Three<Lanes>&bp = ap[(k + 1) & 3], ac = center - x[k];
        const PieceFeet<Lanes> piece = closest_on_pieces(ap[k] - bp, ac, ap[k], bp, ap[k] - ac);
        const LaneMask nearer = k == 0 ? first_lanes(lane_count) : less(piece.distance2, nearest);
        nearest = select(less(piece.distance2, nearest), piece.distance2, nearest);
        wa = select(nearer, piece.wa, wa);
        wb = select(nearer, piece.wb, wb);
        wc = select(nearer, piece.wc, wc);
        rim = select(nearer, piece.rim, rim);
        for (int j = 0; j < k; ++j) is[j] = without(is[j], nearer);
        is[k] = nearer;
    }
    const Lanes quarter = 0.25 * wc, four = spread<Lanes>(4);
    const LaneMask outline = less(rim, four);
    // Of rim: 1 = corner k, 2 = the next one, 3 = both.
    const LaneMask at_b = outline & at_most(spread<Lanes>(2), rim),
                   at_a = outline & (less(rim, spread<Lanes>(2)) | less(spread<Lanes>(2), rim)) &
                          less(none, rim);
    Three<Lanes> from_a = x[0] - center, from_b = x[1] - center;
    feet.rim = none;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        const int before = (k + 3) & 3;
        feet.weight[k] = select(is[k], quarter + wa, select(is[before], quarter + wb, quarter));
        const LaneMask touched = (is[k] & at_a) | (is[before] & at_b);
        feet.rim = feet.rim + select(touched, spread<Lanes>(1 << k), none);
        if (k == 0) continue;
        from_a = select(is[k], x[k] - center, from_a);
        from_b = select(is[k], x[(k + 1) & 3] - center, from_b);
    }
    plane = cross(from_a, from_b);
}

void close_on_triangles(const Three<Lanes>& point, const Three<Lanes> (&x)[4], LaneFeet& feet,
                        Three<Lanes>& plane) {
    const Three<Lanes> ab = x[1] - x[0], ac = x[2] - x[0];
    const PieceFeet<Lanes> piece =
        closest_on_pieces(ab, ac, point - x[0], point - x[1], point - x[2]);
    feet.weight[0] = piece.wa;
    feet.weight[1] = piece.wb;
    feet.weight[2] = piece.wc;
    feet.weight[3] = spread<Lanes>(0);
    feet.rim = piece.rim;
    plane = cross(ab, ac);
}

}  // namespace

LaneFeet closest_points(const Three<Lanes>& point, const Surface& surface, const LaneRows& facet) {
    const LaneCorners corners = corners_of(surface, facet);
    Three<Lanes> x[4];
    for (int a = 0; a < 4; ++a) x[a] = gather_three(surface.x().data(), corners.node[a]);
    const LaneMask triangle = corners.triangle();

    LaneFeet feet;
    Three<Lanes> plane;
    const Three<Lanes> center = spread<Lanes>(0.25) * (x[0] + x[1] + x[2] + x[3]);
    if (!all(triangle)) close_on_quads(point, x, center, feet, plane);
    if (any(triangle)) {
        LaneFeet here;
        Three<Lanes> its_plane;
        close_on_triangles(point, x, here, its_plane);
        for (int a = 0; a < 4; ++a)
            feet.weight[a] = select(triangle, here.weight[a], feet.weight[a]);
        feet.rim = select(triangle, here.rim, feet.rim);
        plane = select(triangle, its_plane, plane);
    }
    feet.offset = offset_from(point, feet.weight, x);
    feet.distance = norm(feet.offset);
    feet.normal = unit(plane);
    feet.side = dot(feet.offset, feet.normal);
    return feet;
}

}  // namespace undertow::contact
