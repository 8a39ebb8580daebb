#include "contact/facet.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace undertow::contact {

namespace {

// The four pieces of a quad side by side, one to a lane: a warped facet costs no more than a flat
// one, and no branch depends on where the point lies.
using Lanes = double __attribute__((vector_size(32)));
using LaneMask = std::int64_t __attribute__((vector_size(32)));

struct LaneVec {
    Lanes x, y, z;
};

Lanes spread(double value) {
    return Lanes{value, value, value, value};
}
LaneVec spread(const Vec& v) {
    return {spread(v[0]), spread(v[1]), spread(v[2])};
}
LaneVec operator-(const LaneVec& a, const LaneVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
LaneVec operator*(const Lanes& s, const LaneVec& a) {
    return {s * a.x, s * a.y, s * a.z};
}
Lanes dot(const LaneVec& a, const LaneVec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// The next corner in each lane.
Lanes turned(const Lanes& a) {
    return __builtin_shuffle(a, LaneMask{1, 2, 3, 0});
}

// Where the foot of a piece abc lies: in it, on an edge, on a corner.
enum Region : std::int64_t { inside, bc, ca, c, ab, b, a };

struct PieceFeet {
    Lanes wa, wb, wc;
    Lanes distance2;  // [m2]
    LaneMask region;
};

/// Closest points of triangles abc by their Voronoi regions; ap = p - a, and so on.
PieceFeet closest_on_pieces(const LaneVec& ab_, const LaneVec& ac, const LaneVec& ap,
                            const LaneVec& bp, const LaneVec& cp) {
    const Lanes d1 = dot(ab_, ap), d2 = dot(ac, ap), d3 = dot(ab_, bp), d4 = dot(ac, bp),
                d5 = dot(ab_, cp), d6 = dot(ac, cp);
    const Lanes va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    const Lanes none = spread(0), one = spread(1);

    // Weights of b and c over a common denominator; later regions take precedence.
    Lanes over = va + vb + vc, nb = vb, nc = vc;
    LaneMask region = LaneMask{inside, inside, inside, inside};
    const auto choose = [&](const LaneMask& here, std::int64_t name, const Lanes& b_,
                            const Lanes& c_, const Lanes& whole) {
        nb = here ? b_ : nb;
        nc = here ? c_ : nc;
        over = here ? whole : over;
        region = here ? LaneMask{name, name, name, name} : region;
    };
    const Lanes d43 = d4 - d3, d56 = d5 - d6;
    choose((va <= none) & (d43 >= none) & (d56 >= none), bc, d56, d43, d43 + d56);
    choose((vb <= none) & (d2 >= none) & (d6 <= none), ca, none, d2, d2 - d6);
    choose((d6 >= none) & (d5 <= d6), c, none, one, one);
    choose((vc <= none) & (d1 >= none) & (d3 <= none), ab, d1, none, d1 - d3);
    choose((d3 >= none) & (d4 <= d3), b, one, none, one);
    choose((d1 <= none) & (d2 <= none), a, none, none, one);

    PieceFeet feet;
    const Lanes share = one / over;
    feet.wc = nc * share;
    const LaneMask on_bc = region == LaneMask{bc, bc, bc, bc};
    feet.wb = on_bc ? one - feet.wc : nb * share;
    feet.wa = on_bc ? none : one - feet.wb - feet.wc;
    const LaneVec offset = ap - feet.wb * ab_ - feet.wc * ac;
    feet.distance2 = dot(offset, offset);
    feet.region = region;
    return feet;
}

/// Foot with weights made exact: the offset is measured from sum_a w_a x_a itself.
void finish(Foot& foot, const Vec& point, const Corners& facet, const Vec& plane) {
    foot.offset = point - (foot.weight[0] * facet.x[0] + foot.weight[1] * facet.x[1] +
                           foot.weight[2] * facet.x[2] + foot.weight[3] * facet.x[3]);
    foot.distance = foot.offset.norm();
    foot.normal = plane / plane.norm();
}

Foot closest_on_triangle(const Vec& point, const Corners& facet) {
    static constexpr std::uint8_t rim_of[] = {0, 2 | 4, 4 | 1, 4, 1 | 2, 2, 1};
    const auto& x = facet.x;
    const Vec ab_ = x[1] - x[0], ac = x[2] - x[0];
    const PieceFeet feet = closest_on_pieces(spread(ab_), spread(ac), spread(Vec(point - x[0])),
                                             spread(Vec(point - x[1])), spread(Vec(point - x[2])));
    Foot foot;
    foot.weight = {feet.wa[0], feet.wb[0], feet.wc[0], 0};
    foot.rim = rim_of[feet.region[0]];
    finish(foot, point, facet, ab_.cross(ac));
    return foot;
}

}  // namespace

Foot closest_point(const Vec& point, const Corners& facet) {
    if (facet.triangle) return closest_on_triangle(point, facet);

    const auto& x = facet.x;
    const Vec center = 0.25 * (x[0] + x[1] + x[2] + x[3]);
    const LaneVec corner{{x[0][0], x[1][0], x[2][0], x[3][0]},
                         {x[0][1], x[1][1], x[2][1], x[3][1]},
                         {x[0][2], x[1][2], x[2][2], x[3][2]}};
    const LaneVec ap = spread(point) - corner, bp{turned(ap.x), turned(ap.y), turned(ap.z)};
    const LaneVec ac = spread(center) - corner;
    const PieceFeet feet = closest_on_pieces(ap - bp, ac, ap, bp, ap - ac);

    int k = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (int piece = 0; piece < 4; ++piece)
        if (feet.distance2[piece] < nearest) {
            nearest = feet.distance2[piece];
            k = piece;
        }
    const int next = (k + 1) & 3;
    Foot foot;
    foot.weight.fill(0.25 * feet.wc[k]);
    foot.weight[k] += feet.wa[k];
    foot.weight[next] += feet.wb[k];
    switch (feet.region[k]) {
        case a:
            foot.rim = std::uint8_t(1 << k);
            break;
        case b:
            foot.rim = std::uint8_t(1 << next);
            break;
        case ab:
            foot.rim = std::uint8_t(1 << k | 1 << next);
            break;
        default:
            foot.rim = 0;
    }
    finish(foot, point, facet, (x[k] - center).cross(x[next] - center));
    return foot;
}

}  // namespace undertow::contact
