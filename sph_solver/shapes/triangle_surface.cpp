#include "sph_solver/shapes/triangle_surface.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

constexpr int leaf_size = 4;       // facets
constexpr double far_ratio = 2.5;  // a node this many radii away counts as one dipole: the error of
                                   // the winding number stays below 0.01, what matters is 1/2

/// Point of a triangle that is nearest to x.  [Ericson 2005, Real-Time Collision Detection, 5.1.5]
Vec3 nearest_in_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ax = x - a;
    const double d1 = dot(ab, ax), d2 = dot(ac, ax);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bx = x - b;
    const double d3 = dot(ab, bx), d4 = dot(ac, bx);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
    const Vec3 cx = x - c;
    const double d5 = dot(ab, cx), d6 = dot(ac, cx);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
    return a + (vb / (va + vb + vc)) * ab + (vc / (va + vb + vc)) * ac;
}

double distance2_to_box(const Vec3& x, const Vec3& low, const Vec3& high) {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
        const double beyond = std::max({low[a] - x[a], x[a] - high[a], 0.0});
        sum += beyond * beyond;
    }
    return sum;
}

}  // namespace

TriangleSurface::TriangleSurface(TriangleMesh mesh) : mesh_(std::move(mesh)) {
    tree_.reserve(2 * mesh_.facet.size());
    build(0, facets());
    bounds_ = {tree_[0].low, tree_[0].high};
}

std::int32_t TriangleSurface::build(std::int32_t first, std::int32_t last) {
    const auto center = [&](const std::array<std::int32_t, 3>& f, int axis) {
        return mesh_.vertex[f[0]][axis] + mesh_.vertex[f[1]][axis] + mesh_.vertex[f[2]][axis];
    };
    Node node{};
    node.first = first, node.last = last;
    node.low = {1e300, 1e300, 1e300}, node.high = {-1e300, -1e300, -1e300};
    double area = 0;
    for (std::int32_t k = first; k < last; ++k) {
        const Vec3 part = area_vector(k);
        const double size = length(part);
        area += size;
        node.dipole = node.dipole + part;
        for (int a = 0; a < 3; ++a) {
            node.middle[a] += size * center(mesh_.facet[k], a) / 3;
            for (const std::int32_t v : mesh_.facet[k]) {
                node.low[a] = std::min(node.low[a], mesh_.vertex[v][a]);
                node.high[a] = std::max(node.high[a], mesh_.vertex[v][a]);
            }
        }
    }
    node.middle = (1 / area) * node.middle;
    for (std::int32_t k = first; k < last; ++k)
        for (const std::int32_t v : mesh_.facet[k])
            node.radius = std::max(node.radius, length(mesh_.vertex[v] - node.middle));
    const auto own = static_cast<std::int32_t>(tree_.size());
    tree_.push_back(node);
    if (last - first <= leaf_size) return own;
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (node.high[a] - node.low[a] > node.high[axis] - node.low[axis]) axis = a;
    const std::int32_t half = (first + last) / 2;
    std::nth_element(
        mesh_.facet.begin() + first, mesh_.facet.begin() + half, mesh_.facet.begin() + last,
        [&](const auto& f, const auto& g) { return center(f, axis) < center(g, axis); });
    const std::int32_t left = build(first, half), right = build(half, last);
    tree_[own].left = left, tree_[own].right = right;
    return own;
}

TriangleSurface::Nearest TriangleSurface::nearest(const Vec3& x) const {
    Nearest best{1e300, {}, 0};
    double best2 = 1e300;
    std::int32_t waiting[128];  // nodes; a tree cut in halves is never this deep
    int n = 0;
    waiting[n++] = 0;
    while (n > 0) {
        const Node& node = tree_[waiting[--n]];
        if (distance2_to_box(x, node.low, node.high) >= best2) continue;
        if (node.left == 0) {
            for (std::int32_t k = node.first; k < node.last; ++k) {
                const auto& f = mesh_.facet[k];
                const Vec3 point = nearest_in_triangle(x, mesh_.vertex[f[0]], mesh_.vertex[f[1]],
                                                       mesh_.vertex[f[2]]);
                const double d2 = dot(point - x, point - x);
                if (d2 < best2) best2 = d2, best.point = point, best.facet = k;
            }
            continue;
        }
        const Node &l = tree_[node.left], &r = tree_[node.right];
        const bool left_first =
            distance2_to_box(x, l.low, l.high) < distance2_to_box(x, r.low, r.high);
        waiting[n++] = left_first ? node.right : node.left;
        waiting[n++] = left_first ? node.left : node.right;
    }
    best.distance = std::sqrt(best2);
    return best;
}

double TriangleSurface::winding_number(const Vec3& x) const {
    double angle = 0;
    std::int32_t waiting[128];
    int n = 0;
    waiting[n++] = 0;
    while (n > 0) {
        const Node& node = tree_[waiting[--n]];
        const Vec3 r = node.middle - x;
        const double d = length(r);
        if (d > far_ratio * node.radius) {
            angle += dot(node.dipole, r) / (d * d * d);
        } else if (node.left == 0) {
            for (std::int32_t k = node.first; k < node.last; ++k) angle += solid_angle(k, x);
        } else {
            waiting[n++] = node.right;
            waiting[n++] = node.left;
        }
    }
    return angle / (4 * M_PI);
}

/// tan(Omega/2) = det[a b c]/(|a||b||c| + a.b|c| + b.c|a| + c.a|b|)  [van Oosterom & Strackee 1983]
double TriangleSurface::solid_angle(int facet, const Vec3& x) const {
    const auto& f = mesh_.facet[facet];
    const Vec3 a = mesh_.vertex[f[0]] - x, b = mesh_.vertex[f[1]] - x, c = mesh_.vertex[f[2]] - x;
    const double la = length(a), lb = length(b), lc = length(c);
    return 2 * std::atan2(dot(a, cross(b, c)),
                          la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

Vec3 TriangleSurface::area_vector(int facet) const {
    const auto& f = mesh_.facet[facet];
    return 0.5 *
           cross(mesh_.vertex[f[1]] - mesh_.vertex[f[0]], mesh_.vertex[f[2]] - mesh_.vertex[f[0]]);
}

Vec3 TriangleSurface::normal(int facet) const {
    const Vec3 a = area_vector(facet);
    return (1 / length(a)) * a;
}

double TriangleSurface::volume() const {
    double sum = 0;
    for (int k = 0; k < facets(); ++k) sum += dot(mesh_.vertex[mesh_.facet[k][0]], area_vector(k));
    return sum / 3;
}

}  // namespace undertow::sph
