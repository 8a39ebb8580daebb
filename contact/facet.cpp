#include "contact/facet.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace undertow::contact {

namespace {

enum class Region : std::uint8_t { inside, a, b, c, ab, bc, ca };

struct PieceFoot {
    double wa, wb, wc;
    double distance2;  // [m2]
    Region region;
};

/// Closest point of triangle abc by its Voronoi regions.
PieceFoot closest_on_piece(const Vec& p, const Vec& a, const Vec& b, const Vec& c) {
    const Vec ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0, ap.squaredNorm(), Region::a};

    const Vec bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0, bp.squaredNorm(), Region::b};

    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const double t = d1 / (d1 - d3);
        return {1 - t, t, 0, (ap - t * ab).squaredNorm(), Region::ab};
    }

    const Vec cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1, cp.squaredNorm(), Region::c};

    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const double t = d2 / (d2 - d6);
        return {1 - t, 0, t, (ap - t * ac).squaredNorm(), Region::ca};
    }

    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {0, 1 - t, t, (bp - t * (c - b)).squaredNorm(), Region::bc};
    }

    const double scale = 1 / (va + vb + vc), wb = vb * scale, wc = vc * scale;
    return {1 - wb - wc, wb, wc, (ap - wb * ab - wc * ac).squaredNorm(), Region::inside};
}

/// The piece whose sector about the centroid holds the point: it holds the foot, too, whenever the
/// foot lies inside a flat facet.
int sector(const Vec& from_center, const std::array<Vec, 4>& spoke, const Vec& normal) {
    bool left_of_previous = normal.cross(spoke[0]).dot(from_center) >= 0;
    for (int k = 0; k < 4; ++k) {
        const bool left_of_next = normal.cross(spoke[(k + 1) & 3]).dot(from_center) >= 0;
        if (left_of_previous && !left_of_next) return k;
        left_of_previous = left_of_next;
    }
    return 0;
}

/// Foot with weights made exact: the offset is measured from sum_a w_a x_a itself.
void finish(Foot& foot, const Vec& point, const Corners& facet, const Vec& plane) {
    foot.offset = point - (foot.weight[0] * facet.x[0] + foot.weight[1] * facet.x[1] +
                           foot.weight[2] * facet.x[2] + foot.weight[3] * facet.x[3]);
    foot.distance = foot.offset.norm();
    foot.normal = plane / plane.norm();
}

Foot closest_on_triangle(const Vec& point, const Corners& facet) {
    static constexpr std::uint8_t rim_of[] = {0, 1, 2, 4, 1 | 2, 2 | 4, 4 | 1};
    const auto& x = facet.x;
    const PieceFoot piece = closest_on_piece(point, x[0], x[1], x[2]);
    Foot foot;
    foot.weight = {piece.wa, piece.wb, piece.wc, 0};
    foot.rim = rim_of[static_cast<int>(piece.region)];
    finish(foot, point, facet, (x[1] - x[0]).cross(x[2] - x[0]));
    return foot;
}

}  // namespace

Foot closest_point(const Vec& point, const Corners& facet) {
    if (facet.triangle) return closest_on_triangle(point, facet);

    const auto& x = facet.x;
    const Vec center = 0.25 * (x[0] + x[1] + x[2] + x[3]);
    const std::array<Vec, 4> spoke{x[0] - center, x[1] - center, x[2] - center, x[3] - center};
    const Vec diagonal_normal = (x[2] - x[0]).cross(x[3] - x[1]);  // twice the area, along n
    // Of a flat facet the piece below the point is the answer; of a warped one a neighboring piece
    // may be nearer. Half a warp of 1e-9 of the size is round-off.
    const double height = std::abs(diagonal_normal.dot(spoke[0]));
    const double size2 = diagonal_normal.norm();
    const bool flat = height <= 1e-9 * size2 * std::sqrt(size2);

    const int first = sector(point - center, spoke, diagonal_normal);
    int best_k = first;
    PieceFoot best{0, 0, 0, std::numeric_limits<double>::infinity(), Region::inside};
    for (int i = 0; i < 4; ++i) {
        const int k = (first + i) & 3;
        const PieceFoot piece = closest_on_piece(point, x[k], x[(k + 1) & 3], center);
        if (piece.distance2 < best.distance2) {
            best = piece;
            best_k = k;
        }
        if (flat && piece.region == Region::inside) break;
    }

    const int a = best_k, b = (best_k + 1) & 3;
    Foot foot;
    foot.weight.fill(0.25 * best.wc);
    foot.weight[a] += best.wa;
    foot.weight[b] += best.wb;
    switch (best.region) {
        case Region::a:
            foot.rim = std::uint8_t(1 << a);
            break;
        case Region::b:
            foot.rim = std::uint8_t(1 << b);
            break;
        case Region::ab:
            foot.rim = std::uint8_t(1 << a | 1 << b);
            break;
        default:
            foot.rim = 0;
    }
    finish(foot, point, facet, spoke[a].cross(spoke[b]));
    return foot;
}

}  // namespace undertow::contact
