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

std::vector<std::int32_t> flat(const std::vector<Quad>& quads) {
    std::vector<std::int32_t> corners;
    for (const Quad& q : quads) corners.insert(corners.end(), q.begin(), q.end());
    return corners;
}

std::vector<double> masses_of(const std::vector<std::int32_t>& node, const Nodes& nodes) {
    std::vector<double> mass;
    for (std::int32_t n : node) mass.push_back(nodes.mass[n]);
    return mass;
}

}  // namespace

TouchedSurface::TouchedSurface(ContactPoints points, std::vector<std::int32_t> quad,
                               const Nodes& nodes, SurfaceKind kind)
    : kind_(kind),
      points_(std::move(points)),
      surface_(std::move(quad), masses_of(points_.node(), nodes)),
      normal_(surface_.facets()) {
    surface_.move(points_.x(), points_.v());
    refresh_normals();
    group_normals();
    mirror_ends();
    follow_edges();
    find_bulge();
}

TouchedSurface::TouchedSurface(const std::vector<Quad>& facets, const Nodes& nodes,
                               SurfaceKind kind)
    : TouchedSurface(ContactPoints(nodes_of(facets), nodes), renumbered(facets, nodes_of(facets)),
                     nodes, kind) {}

TouchedSurface::TouchedSurface(const FaceLayout& faces, const Nodes& nodes,
                               const TurningNodes& turning)
    : TouchedSurface(ContactPoints(faces, nodes, turning), flat(faces.quad), nodes,
                     SurfaceKind::deformable) {}

void TouchedSurface::group_normals() {
    const std::uint32_t facets = std::uint32_t(surface_.facets());
    std::vector<std::vector<std::uint32_t>> facets_of(points_.size());
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
    across_.assign(4 * std::size_t(facets), -1);
    sharp_node_.assign(points_.size(), 0);
    for (std::uint32_t f = 0; f < facets; ++f)
        for (int k = 0; k < 4; ++k) {
            for (std::uint32_t g : facets_of[surface_.corners(f)[k]])
                if (normal_[f].dot(normal_[g]) >= smooth_cosine) group_.push_back(g);
            start_.push_back(std::uint32_t(group_.size()));
            for (std::uint32_t g : facets_at[edge(f, k)]) {
                if (normal_[f].dot(normal_[g]) >= smooth_cosine) continue;
                across_[4 * f + k] = std::int32_t(g);
                sharp_node_[surface_.corners(f)[k]] = 1;
                sharp_node_[surface_.corners(f)[(k + 1) % 4]] = 1;
            }
        }
}

void TouchedSurface::follow(const Nodes& nodes, const TurningNodes* turning) {
    points_.follow(nodes, turning);
    surface_.move(points_.x(), points_.v());
}

void TouchedSurface::refresh_normals() {
    for (std::uint32_t f = 0; f < normal_.size(); ++f) {
        const std::int32_t* q = surface_.corners(f);
        const Vector area = (surface_.position(q[2]) - surface_.position(q[0]))
                                .cross(surface_.position(q[3]) - surface_.position(q[1]));
        normal_[f] = area / area.norm();
    }
}

Vector TouchedSurface::mean_normal(std::uint32_t facet, int corner) const {
    Vector sum = Vector::Zero();
    for (std::uint32_t i = start_[4 * facet + corner]; i < start_[4 * facet + corner + 1]; ++i)
        sum += normal_[group_[i]];
    return sum / sum.norm();
}

/// Normal mirrored at the middle of the edge from the corner `from` to this one.
Vector TouchedSurface::corner_normal(std::uint32_t facet, int corner) const {
    const int from = mirror_[4 * facet + corner];
    if (from < 0) return mean_normal(facet, corner);
    const std::int32_t* q = surface_.corners(facet);
    const Vector along = (surface_.position(q[corner]) - surface_.position(q[from])).normalized();
    const Vector n = mean_normal(facet, from);
    return n - 2 * n.dot(along) * along;
}

void TouchedSurface::mirror_ends() {
    mirror_.assign(4 * surface_.facets(), -1);
    for (std::uint32_t f = 0; f < surface_.facets(); ++f) {
        const std::int32_t* q = surface_.corners(f);
        const auto is_end = [&](int k) {
            return across_[4 * f + k] >= 0 ||
                   surface_.is_free_rim(f, std::uint8_t(1 << k | 1 << (k + 1) % 4));
        };
        for (int corner = 0; corner < 4; ++corner) {
            double most = 1e-9;  // tilts below that are round-off
            // across the edge that begins here lies the corner before, across the one that ends
            // here the corner after
            for (const auto& [edge, from] : {std::pair(corner, (corner + 3) % 4),
                                             std::pair((corner + 3) % 4, (corner + 1) % 4)}) {
                if (!is_end(edge)) continue;
                const Vector along =
                    (surface_.position(q[corner]) - surface_.position(q[from])).normalized();
                const double tilt = std::abs(mean_normal(f, from).dot(along));
                if (tilt <= most) continue;
                most = tilt;
                mirror_[4 * f + corner] = std::int8_t(from);
            }
        }
    }
}

/// Does a sharp edge run on through its node, or end there? Elsewhere the node is a corner.
void TouchedSurface::follow_edges() {
    std::vector<std::vector<std::int32_t>> beyond(points_.size());  // other ends of sharp edges
    for (std::uint32_t f = 0; f < surface_.facets(); ++f)
        for (int k = 0; k < 4; ++k) {
            if (across_[4 * f + k] < 0) continue;
            const std::int32_t a = surface_.corners(f)[k], b = surface_.corners(f)[(k + 1) % 4];
            for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
                if (std::find(beyond[from].begin(), beyond[from].end(), to) == beyond[from].end())
                    beyond[from].push_back(to);
        }
    edge_runs_on_.assign(points_.size(), 0);
    for (std::size_t n = 0; n < points_.size(); ++n) {
        const auto direction = [&](int i) {
            return (surface_.position(beyond[n][i]) - surface_.position(std::int32_t(n)))
                .normalized();
        };
        edge_runs_on_[n] =
            beyond[n].size() == 1 ||
            (beyond[n].size() == 2 && -direction(0).dot(direction(1)) >= smooth_cosine);
    }
}

/// h is largest near the middle of a facet; twice that, for facets whose corners differ.
void TouchedSurface::find_bulge() {
    if (kind_ != SurfaceKind::rigid) return;
    for (std::uint32_t f = 0; f < surface_.facets(); ++f) {
        const std::int32_t* q = surface_.corners(f);
        Vector middle = Vector::Zero();
        for (int k = 0; k < 4; ++k) middle += 0.25 * surface_.position(q[k]);
        double height = 0;
        for (int k = 0; k < 4; ++k)
            height += 0.125 * std::abs((middle - surface_.position(q[k])).dot(corner_normal(f, k)));
        largest_bulge_ = std::max(largest_bulge_, 2 * height);
    }
}

/// Of a shell that has, on its other side, a corner in common with the facet `before`.
bool TouchedSurface::is_other_face(std::uint32_t facet, std::int32_t before) const {
    if (before < 0 || opposite_.empty() || opposite_[facet] < 0) return false;
    const std::int32_t* a = surface_.corners(std::uint32_t(opposite_[facet]));
    const std::int32_t* b = surface_.corners(std::uint32_t(before));
    return std::find_first_of(a, a + 4, b, b + 4) != a + 4;
}

bool TouchedSurface::touch(const Vector& x, std::span<const std::uint32_t> candidates, Touch& out,
                           std::int32_t before) const {
    contact::Foot best;
    best.distance = std::numeric_limits<double>::infinity();
    double best_side = 0;  // [m] height above the facet's plane
    bool found = false;
    for (std::uint32_t facet : candidates) {
        if (is_other_face(facet, before)) continue;
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

    const std::int32_t* q = surface_.corners(out.facet);
    const auto is_sharp = [&](int k) { return across_[4 * out.facet + k] >= 0; };
    for (int k = 0; k < 4 && best_side >= 0 && best.distance > 0; ++k) {
        const int next = (k + 1) % 4, before = (k + 3) % 4;
        if (best.rim == (1 << k | 1 << next) && is_sharp(k))
            return touch_edge(x, k, best.weight[next], out);
        if (best.rim != 1 << k || !sharp_node_[q[k]]) continue;
        if (edge_runs_on_[q[k]] && is_sharp(k)) return touch_edge(x, k, 0, out);
        if (edge_runs_on_[q[k]] && is_sharp(before)) return touch_edge(x, before, 1, out);
        out.normal = best.offset / best.distance;
        out.distance = best.distance;
        return true;
    }
    return touch_smooth(x, best, out);
}

/// Over a smooth surface the foot lies straight below along the interpolated normal, not along the
/// facet's: one correction of the nearest point, whose error is the distance over the radius of
/// curvature times as large.
bool TouchedSurface::touch_smooth(const Vector& x, const contact::Foot& nearest, Touch& out) const {
    const auto normal_at = [&](const std::array<double, 4>& weight) {
        Vector n = Vector::Zero();
        for (int k = 0; k < 4; ++k)
            if (weight[k] != 0) n += weight[k] * corner_normal(out.facet, k);
        return Vector(n.normalized());
    };
    const contact::Corners shape = surface_.shape(out.facet);
    const Vector& plane = normal_[out.facet];
    const Vector n = normal_at(nearest.weight);
    const Vector from_foot = nearest.offset;
    const Vector below = x - (from_foot.dot(plane) / n.dot(plane)) * n;
    const contact::Foot foot = contact::closest_point(below, shape);
    const Vector at = below - foot.offset, offset = x - at;
    out.weight = foot.weight;
    out.normal = normal_at(foot.weight);
    double height = 0;
    const std::int32_t* q = surface_.corners(out.facet);
    for (int k = 0; k < 4; ++k)
        if (foot.weight[k] != 0 && kind_ == SurfaceKind::rigid)
            height -= 0.5 * foot.weight[k] *
                      (at - surface_.position(q[k])).dot(corner_normal(out.facet, k));
    const double along = offset.dot(out.normal);
    out.distance = along - height;
    // Beyond a rim where the surface just ends there is nothing to touch (45 degrees).
    return std::abs(along) >= 0.7 * offset.norm();
}

/// On the sharp edge k of the facet, at the share u from its first to its second corner: like a
/// smooth surface, the edge is a curve whose tangent changes steadily, and it bulges with both of
/// its facets.
bool TouchedSurface::touch_edge(const Vector& x, int k, double u, Touch& out) const {
    const std::int32_t* q = surface_.corners(out.facet);
    const int next = (k + 1) % 4;
    const Vector start = surface_.position(q[k]), edge = surface_.position(q[next]) - start;
    const std::array<std::uint32_t, 2> facet{out.facet, std::uint32_t(across_[4 * out.facet + k])};
    std::array<std::array<Vector, 2>, 2> end;  // normals of both facets at both ends
    for (int f = 0; f < 2; ++f) {
        const std::int32_t* c = surface_.corners(facet[f]);
        for (int e = 0; e < 2; ++e)
            end[f][e] = corner_normal(facet[f], int(std::find(c, c + 4, q[e == 0 ? k : next]) - c));
    }
    const auto normal_at = [&](int f, double at) {
        return Vector(((1 - at) * end[f][0] + at * end[f][1]).normalized());
    };
    const auto tangent_at = [&](double at) {
        return Vector(normal_at(0, at).cross(normal_at(1, at)).normalized());
    };
    Vector tangent = tangent_at(u);
    u = std::clamp(u + (x - start - u * edge).dot(tangent) / edge.dot(tangent), 0.0, 1.0);
    tangent = tangent_at(u);
    Vector offset = x - start - u * edge;
    if (kind_ == SurfaceKind::rigid)
        for (int f = 0; f < 2; ++f)
            offset += 0.5 * u * (1 - u) * edge.dot(end[f][0] - end[f][1]) * normal_at(f, u);
    const double along = offset.dot(tangent);
    offset -= along * tangent;
    out.weight.fill(0);
    out.weight[k] = 1 - u;
    out.weight[next] = u;
    out.distance = offset.norm();
    out.normal = out.distance > 0 ? Vector(offset / out.distance) : normal_at(0, u);
    return std::abs(along) <= out.distance;  // beyond the end of the edge: 45 degrees
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

Vector TouchedSurface::turn_rate(const Touch& touch, const TurningNodes* turning) const {
    Vector sum = Vector::Zero();
    if (!points_.turn()) return sum;
    const std::int32_t* q = surface_.corners(touch.facet);
    for (int a = 0; a < 4; ++a)
        sum += touch.weight[a] * points_.turn_rate(std::size_t(q[a]), turning);
    return sum;
}

}  // namespace undertow::fem
