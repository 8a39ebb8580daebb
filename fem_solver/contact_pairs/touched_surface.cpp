#include "fem_solver/contact_pairs/touched_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

constexpr double smooth_cosine = 0.8660254037844387;  // of 30 degrees

// Feet on two facets are one point when they differ by less than this share of their distance.
constexpr double same_point = 1e-9;

std::vector<std::int32_t> nodes_of(const std::vector<Quad>& facets) {
    std::vector<std::int32_t> nodes;
    for (const Quad& q : facets) nodes.insert(nodes.end(), q.begin(), q.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

std::vector<std::int32_t> renumbered(const std::vector<Quad>& facets,
                                     const std::vector<std::int32_t>& node) {
    std::vector<std::int32_t> quad;
    for (const Quad& q : facets)
        for (std::int32_t n : q)
            quad.push_back(
                std::int32_t(std::lower_bound(node.begin(), node.end(), n) - node.begin()));
    return quad;
}

std::vector<double> masses_of(const std::vector<std::int32_t>& node, const Nodes& nodes) {
    std::vector<double> mass;
    for (std::int32_t n : node) mass.push_back(nodes.mass[n]);
    return mass;
}

}  // namespace

TouchedSurface::TouchedSurface(const std::vector<Quad>& facets, const Nodes& nodes)
    : node_(nodes_of(facets)),
      x_(3 * node_.size()),
      v_(3 * node_.size()),
      surface_(renumbered(facets, node_), masses_of(node_, nodes)),
      normal_(facets.size()) {
    follow(nodes);
    refresh_normals();
    group_normals();
}

void TouchedSurface::group_normals() {
    const std::uint32_t facets = std::uint32_t(surface_.facets());
    std::vector<std::vector<std::uint32_t>> facets_of(node_.size());
    std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::uint32_t>> facets_at;
    const auto edge = [&](std::uint32_t f, int k) {
        const std::int32_t a = surface_.corners(f)[k], b = surface_.corners(f)[(k + 1) % 4];
        return std::pair(std::min(a, b), std::max(a, b));
    };
    for (std::uint32_t f = 0; f < facets; ++f)
        for (int k = 0; k < 4; ++k) {
            facets_of[surface_.corners(f)[k]].push_back(f);
            facets_at[edge(f, k)].push_back(f);
        }
    start_.assign(1, 0);
    sharp_edge_.assign(facets, 0);
    sharp_node_.assign(node_.size(), 0);
    for (std::uint32_t f = 0; f < facets; ++f)
        for (int k = 0; k < 4; ++k) {
            for (std::uint32_t g : facets_of[surface_.corners(f)[k]])
                if (normal_[f].dot(normal_[g]) >= smooth_cosine) group_.push_back(g);
            start_.push_back(std::uint32_t(group_.size()));
            for (std::uint32_t g : facets_at[edge(f, k)]) {
                if (normal_[f].dot(normal_[g]) >= smooth_cosine) continue;
                sharp_edge_[f] |= std::uint8_t(1 << k);
                sharp_node_[surface_.corners(f)[k]] = 1;
                sharp_node_[surface_.corners(f)[(k + 1) % 4]] = 1;
            }
        }
}

void TouchedSurface::follow(const Nodes& nodes) {
    for (std::size_t i = 0; i < node_.size(); ++i)
        for (int d = 0; d < 3; ++d) {
            x_[3 * i + d] = nodes.x[node_[i]].c[d];
            v_[3 * i + d] = nodes.v[node_[i]].c[d];
        }
    surface_.move(x_, v_);
}

void TouchedSurface::refresh_normals() {
    for (std::uint32_t f = 0; f < normal_.size(); ++f) {
        const std::int32_t* q = surface_.corners(f);
        const Vector area = (surface_.position(q[2]) - surface_.position(q[0]))
                                .cross(surface_.position(q[3]) - surface_.position(q[1]));
        normal_[f] = area / area.norm();
    }
}

Vector TouchedSurface::corner_normal(std::uint32_t facet, int corner) const {
    Vector sum = Vector::Zero();
    for (std::uint32_t i = start_[4 * facet + corner]; i < start_[4 * facet + corner + 1]; ++i)
        sum += normal_[group_[i]];
    return sum / sum.norm();
}

bool TouchedSurface::touch(const Vector& x, std::span<const std::uint32_t> candidates,
                           Touch& out) const {
    contact::Foot best;
    best.distance = std::numeric_limits<double>::infinity();
    double best_side = 0;  // [m] height above the facet's plane
    bool found = false;
    for (std::uint32_t facet : candidates) {
        const contact::Foot foot = contact::closest_point(x, surface_.shape(facet));
        const double side = foot.offset.dot(foot.normal);
        // of several facets with the same nearest point the one it faces most squarely tells the
        // side
        const double tolerance = same_point * foot.distance;
        const bool nearer = foot.distance < best.distance - tolerance;
        const bool same = !nearer && foot.distance <= best.distance + tolerance;
        if (found && !nearer && !(same && std::abs(side) > std::abs(best_side) + tolerance))
            continue;
        found = true;
        best = foot;
        best_side = side;
        out.facet = facet;
    }
    if (!found) return false;
    out.weight = best.weight;

    Vector smooth = Vector::Zero();
    for (int k = 0; k < 4; ++k)
        if (best.weight[k] != 0) smooth += best.weight[k] * corner_normal(out.facet, k);
    smooth.normalize();
    bool sharp = false;
    const std::int32_t* q = surface_.corners(out.facet);
    for (int k = 0; k < 4; ++k) {
        sharp |= best.rim == 1 << k && sharp_node_[q[k]];
        sharp |= best.rim == (1 << k | 1 << (k + 1) % 4) && (sharp_edge_[out.facet] & 1 << k);
    }
    if (sharp && best_side >= 0 && best.distance > 0) {
        out.normal = best.offset / best.distance;
        out.distance = best.distance;
        return true;
    }
    out.normal = smooth;
    out.distance = best.offset.dot(smooth);
    // Beyond a rim where the surface just ends there is nothing to touch (45 degrees).
    return std::abs(out.distance) >= 0.7 * best.distance;
}

Vector TouchedSurface::position(const Touch& touch) const {
    const std::int32_t* q = surface_.corners(touch.facet);
    Vector sum = Vector::Zero();
    for (int a = 0; a < 4; ++a) sum += touch.weight[a] * surface_.position(q[a]);
    return sum;
}

Vector TouchedSurface::velocity(const Touch& touch) const {
    const std::int32_t* q = surface_.corners(touch.facet);
    Vector sum = Vector::Zero();
    for (int a = 0; a < 4; ++a) sum += touch.weight[a] * surface_.velocity(q[a]);
    return sum;
}

}  // namespace undertow::fem
