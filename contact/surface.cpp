#include "contact/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace undertow::contact {

namespace {

/// An outline edge as its two nodes in rising order, and who walks along it in which direction.
struct Edge {
    std::int32_t low, high;
    std::uint32_t facet;
    std::uint8_t side;  // runs from corner `side` to the next
    bool rising;        // the facet walks it from low to high
    bool same_nodes(const Edge& other) const { return low == other.low && high == other.high; }
};

std::vector<Edge> sorted_edges(std::span<const std::int32_t> quad) {
    std::vector<Edge> edges;
    edges.reserve(quad.size());
    for (std::uint32_t facet = 0; facet < quad.size() / 4; ++facet)
        for (std::uint8_t k = 0; k < 4; ++k) {
            const std::int32_t a = quad[4 * facet + k], b = quad[4 * facet + (k + 1) % 4];
            if (a != b) edges.push_back({std::min(a, b), std::max(a, b), facet, k, a < b});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
        if (l.low != r.low) return l.low < r.low;
        if (l.high != r.high) return l.high < r.high;
        return l.facet < r.facet;
    });
    return edges;
}

Vec node_position(std::span<const double> x, std::int32_t node) {
    return Vec::Map(&x[3 * std::size_t(node)]);
}

/// Empty if facet `f` has area and is convex.
std::string shape_defect(std::span<const double> x, const std::int32_t* q, std::size_t f) {
    const std::string name = "facet " + std::to_string(f);
    const bool triangle = q[2] == q[3];
    if (q[0] == q[1] || q[1] == q[2] || q[0] == q[2] ||
        (!triangle && (q[3] == q[0] || q[3] == q[1])))
        return name + " uses a node twice (a triangle repeats its third node, nothing else)";
    std::array<Vec, 4> c;
    for (int k = 0; k < 4; ++k) c[k] = node_position(x, q[k]);
    const Vec center =
        triangle ? Vec((c[0] + c[1] + c[2]) / 3) : Vec(0.25 * (c[0] + c[1] + c[2] + c[3]));
    const Vec normal =
        triangle ? Vec((c[1] - c[0]).cross(c[2] - c[0])) : Vec((c[2] - c[0]).cross(c[3] - c[1]));
    double longest = 0;
    for (int k = 0; k < 4; ++k) longest = std::max(longest, (c[k] - center).squaredNorm());
    // 1e-6 of the square of its size: a sliver of one part in a million is no facet.
    if (!(normal.norm() > 1e-6 * longest)) return name + " has no area";
    for (int k = 0; k < (triangle ? 3 : 4); ++k) {
        const Vec piece = (c[k] - center).cross(c[(k + 1) % (triangle ? 3 : 4)] - center);
        if (!(piece.dot(normal) > 0))
            return name + " is not convex or crosses itself at its node " + std::to_string(q[k]);
    }
    return {};
}

}  // namespace

std::string find_defect(std::span<const double> x, std::span<const std::int32_t> quad) {
    for (std::size_t f = 0; f < quad.size() / 4; ++f)
        if (std::string defect = shape_defect(x, &quad[4 * f], f); !defect.empty()) return defect;

    const std::vector<Edge> edges = sorted_edges(quad);
    for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
        const bool just_two = edges[e].same_nodes(edges[e + 1]) &&
                              (e == 0 || !edges[e].same_nodes(edges[e - 1])) &&
                              (e + 2 >= edges.size() || !edges[e].same_nodes(edges[e + 2]));
        if (just_two && edges[e].rising == edges[e + 1].rising)
            return "facets " + std::to_string(edges[e].facet) + " and " +
                   std::to_string(edges[e + 1].facet) +
                   " share an edge but disagree on which side is wet: reverse the node order of "
                   "one";
    }
    return {};
}

Surface::Surface(std::vector<std::int32_t> quad, std::vector<double> mass)
    : quad_(std::move(quad)),
      mass_(std::move(mass)),
      free_edges_(quad_.size() / 4, 0),
      free_node_(mass_.size(), 0) {
    inverse_mass_.reserve(mass_.size());
    for (double m : mass_) inverse_mass_.push_back(1 / m);
    const std::vector<Edge> edges = sorted_edges(quad_);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const bool shared = (e > 0 && edges[e].same_nodes(edges[e - 1])) ||
                            (e + 1 < edges.size() && edges[e].same_nodes(edges[e + 1]));
        if (shared) continue;
        free_edges_[edges[e].facet] |= std::uint8_t(1 << edges[e].side);
        free_node_[edges[e].low] = free_node_[edges[e].high] = 1;
    }
}

void Surface::move(std::span<const double> x, std::span<const double> v) {
    x_ = x;
    v_ = v;
}

Corners Surface::shape(std::uint32_t facet) const {
    const std::int32_t* q = corners(facet);
    return {{position(q[0]), position(q[1]), position(q[2]), position(q[3])}, q[2] == q[3]};
}

FacetPlane Surface::plane(std::uint32_t facet) const {
    const std::int32_t* q = corners(facet);
    const Corners c = shape(facet);
    FacetPlane plane;
    Vec area;
    if (c.triangle) {
        plane.center = (c.x[0] + c.x[1] + c.x[2]) / 3;
        plane.velocity = (velocity(q[0]) + velocity(q[1]) + velocity(q[2])) / 3;
        area = (c.x[1] - c.x[0]).cross(c.x[2] - c.x[0]);
    } else {
        plane.center = 0.25 * (c.x[0] + c.x[1] + c.x[2] + c.x[3]);
        plane.velocity = 0.25 * (velocity(q[0]) + velocity(q[1]) + velocity(q[2]) + velocity(q[3]));
        area = (c.x[2] - c.x[0]).cross(c.x[3] - c.x[1]);
    }
    plane.normal = area / area.norm();
    return plane;
}

bool Surface::is_free_rim(std::uint32_t facet, std::uint8_t rim) const {
    if (rim == 0) return false;
    const std::int32_t* q = corners(facet);
    for (int k = 0; k < 4; ++k)
        if (rim == 1 << k) return free_node_[q[k]];
    for (int k = 0; k < 4; ++k) {
        // A triangle's third edge runs from corner 3 (= corner 2) to corner 0.
        const int from = k == 3 && q[2] == q[3] ? 2 : k;
        if (rim == (1 << from | 1 << (k + 1) % 4)) return free_edges_[facet] & (1 << k);
    }
    return false;
}

}  // namespace undertow::contact
