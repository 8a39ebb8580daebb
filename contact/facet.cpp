#include "contact/facet.hpp"

#include <cmath>
#include <limits>

#include "contact/pieces.hpp"

namespace undertow::contact {

namespace {

using Vector = Three<double>;

Three<Lanes4> spread_out(const Vector& v) {
    return {spread<Lanes4>(v.x), spread<Lanes4>(v.y), spread<Lanes4>(v.z)};
}
/// The next corner in each lane.
Lanes4 turned(const Lanes4& a) {
    return __builtin_shuffle(a, LaneMask4{1, 2, 3, 0});
}
Vector vector_of(const Vec& v) {
    return {v[0], v[1], v[2]};
}

Foot made_exact(const Vector& point, const Vector (&x)[4], const double (&weight)[4],
                const Vector& plane, int rim) {
    const Vector offset = offset_from(point, weight, x), normal = unit(plane);
    Foot foot;
    for (int a = 0; a < 4; ++a) foot.weight[a] = weight[a];
    foot.offset = {offset.x, offset.y, offset.z};
    foot.normal = {normal.x, normal.y, normal.z};
    foot.distance = norm(offset);
    foot.rim = std::uint8_t(rim);
    return foot;
}

Foot closest_on_triangle(const Vector& point, const Vector (&x)[4]) {
    const Vector ab = x[1] - x[0], ac = x[2] - x[0];
    const PieceFeet<double> feet =
        closest_on_pieces(ab, ac, point - x[0], point - x[1], point - x[2]);
    return made_exact(point, x, {feet.wa, feet.wb, feet.wc, 0}, cross(ab, ac), int(feet.rim));
}

}  // namespace

Foot closest_point(const Vec& at, const Corners& facet) {
    const Vector point = vector_of(at);
    const Vector x[4] = {vector_of(facet.x[0]), vector_of(facet.x[1]), vector_of(facet.x[2]),
                         vector_of(facet.x[3])};
    if (facet.triangle) return closest_on_triangle(point, x);

    // The four pieces of a quad side by side, one to a lane: a warped facet costs no more than a
    // flat one, and no branch depends on where the point lies.
    const Vector center = 0.25 * (x[0] + x[1] + x[2] + x[3]);
    const Three<Lanes4> corner{{x[0].x, x[1].x, x[2].x, x[3].x},
                               {x[0].y, x[1].y, x[2].y, x[3].y},
                               {x[0].z, x[1].z, x[2].z, x[3].z}};
    const Three<Lanes4> ap = spread_out(point) - corner,
                        bp{turned(ap.x), turned(ap.y), turned(ap.z)};
    const Three<Lanes4> ac = spread_out(center) - corner;
    const PieceFeet<Lanes4> feet = closest_on_pieces(ap - bp, ac, ap, bp, ap - ac);

    int k = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (int piece = 0; piece < 4; ++piece)
        if (feet.distance2[piece] < nearest) {
            nearest = feet.distance2[piece];
            k = piece;
        }
    const int next = (k + 1) & 3, rim = int(feet.rim[k]);
    double weight[4];
    for (double& w : weight) w = 0.25 * feet.wc[k];
    weight[k] += feet.wa[k];
    weight[next] += feet.wb[k];
    // Piece k has corners k and next on the facet's outline; the centroid is inside.
    const bool outline = rim < 4;
    return made_exact(point, x, weight, cross(x[k] - center, x[next] - center),
                      outline ? (rim & 1) << k | (rim >> 1) << next : 0);
}

}  // namespace undertow::contact
