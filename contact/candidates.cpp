#include "contact/candidates.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "contact/facet_lanes.hpp"

namespace undertow::contact {

namespace {

// What float cannot hold of a distance: tests in float err by less, on the safe side.
constexpr double float_margin = 1e-6;
// Pairs that are measured together: their rows stay in the nearest cache.
constexpr std::size_t pairs_at_once = 1024;
constexpr std::uint32_t nobody = 0xffffffffu;

}  // namespace

/// Cells share buckets by chance: a facet of another cell is then tested in vain.
std::size_t FacetCells::bucket_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::uint64_t key = std::uint64_t(i) * 0x8DA6B343C2B2AE35ull +
                              std::uint64_t(j) * 0xD8163841FDE6A8F9ull + std::uint64_t(k);
    return std::size_t((key * 0x9E3779B97F4A7C15ull) >> (64 - bits_));  // Fibonacci hashing
}

/// visit(bucket, facet) for every cell that a facet comes within `range` of: facets rising, a
/// bucket once for each of them.
template <typename Visit>
void FacetCells::for_each_bucket(const Surface& surface, double range, Visit visit) {
    last_.assign(std::size_t(1) << bits_, nobody);
    const double per_size = 1 / size_;
    for (std::uint32_t f = 0; f < surface.facets(); ++f) {
        const Corners c = surface.shape(f);
        Vec low = c.x[0].cwiseMin(c.x[1]).cwiseMin(c.x[2].cwiseMin(c.x[3]));
        Vec high = c.x[0].cwiseMax(c.x[1]).cwiseMax(c.x[2].cwiseMax(c.x[3]));
        low = (low.array() - range - origin_.array()) * per_size;
        high = (high.array() + range - origin_.array()) * per_size;
        // The box of a slanted facet has corners that the facet never comes near: all of it lies
        // within `warp` of its mean plane.
        const Vec center = 0.25 * (c.x[0] + c.x[1] + c.x[2] + c.x[3]);
        const Vec area = (c.x[2] - c.x[0]).cross(c.triangle ? c.x[1] - c.x[0] : c.x[3] - c.x[1]);
        const double length = area.norm(), per_length = length > 0 ? 1 / length : 0;
        const double warp = std::abs(area.dot(c.x[0] - center)) * per_length;
        const double reach = warp + range + 0.8660254037844387 * size_;  // half a cell's diagonal
        const Vec n = area * (per_length * size_), first = (origin_ - center) * per_length;
        const double base = area.dot(first) + 0.5 * n.sum();
        for (auto i = std::int64_t(std::floor(low[0])); i <= std::int64_t(std::floor(high[0])); ++i)
            for (auto j = std::int64_t(std::floor(low[1])); j <= std::int64_t(std::floor(high[1]));
                 ++j)
                for (auto k = std::int64_t(std::floor(low[2]));
                     k <= std::int64_t(std::floor(high[2])); ++k) {
                    const double height =
                        base + n[0] * double(i) + n[1] * double(j) + n[2] * double(k);
                    if (std::abs(height) > reach) continue;
                    const std::size_t bucket = bucket_of(i, j, k);
                    if (last_[bucket] == f) continue;
                    last_[bucket] = f;
                    visit(bucket, f);
                }
    }
}

void FacetCells::fill(const Surface& surface, double range) {
    const std::uint32_t facets = std::uint32_t(surface.facets());
    ball_.resize(facets);
    Vec low = Vec::Constant(std::numeric_limits<double>::infinity());
    for (std::uint32_t f = 0; f < facets; ++f) low = low.cwiseMin(surface.shape(f).x[0]);
    origin_ = low;
    double mean_size = 0;
    for (std::uint32_t f = 0; f < facets; ++f) {
        const Corners shape = surface.shape(f);
        const Vec center = 0.25 * (shape.x[0] + shape.x[1] + shape.x[2] + shape.x[3]);
        double radius2 = 0;
        for (const Vec& corner : shape.x)
            radius2 = std::max(radius2, (corner - center).squaredNorm());
        const double radius = std::sqrt(radius2);
        mean_size += 1.4142135623730951 * radius / facets;  // edge of a square
        const Vec at = center - origin_;
        ball_[f] = {{float(at[0]), float(at[1]), float(at[2])},
                    float(radius + float_margin * (radius + at.norm()))};
    }
    // Larger cells hold facets that are tested in vain, smaller ones repeat each facet in many
    // cells; a test costs less than an entry.
    size_ = mean_size + range;
    bits_ = std::max(4, int(std::bit_width(2 * std::size_t(facets))));

    // Counting sort into buckets, facets rising within each.
    start_.assign((std::size_t(1) << bits_) + 2, 0);
    for_each_bucket(surface, range, [&](std::size_t b, std::uint32_t) { ++start_[b + 2]; });
    for (std::size_t b = 2; b < start_.size(); ++b) start_[b] += start_[b - 1];
    entry_.resize(start_.back());
    for_each_bucket(surface, range,
                    [&](std::size_t b, std::uint32_t f) { entry_[start_[b + 1]++] = f; });
}

void FacetCells::search(const Points& points, const Surface& surface, double skin,
                        CandidateList& found) {
    double largest_radius = 0;
    for (double radius : points.radius) largest_radius = std::max(largest_radius, radius);
    // A billionth more: a particle on the border of a cell must not be lost to round-off.
    fill(surface, (1 + 1e-9) * (largest_radius + skin));

    found.row.clear();
    found.start.assign(1, 0);
    found.facet.clear();
    found.distance.clear();
    const double per_size = 1 / size_;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Vec x = Vec::Map(&points.x[3 * std::size_t(i)]);
        const double range = points.radius[i] + skin;
        const Vec from_origin = x - origin_;
        const std::size_t bucket = bucket_of(std::int64_t(std::floor(from_origin[0] * per_size)),
                                             std::int64_t(std::floor(from_origin[1] * per_size)),
                                             std::int64_t(std::floor(from_origin[2] * per_size)));
        const float px = float(from_origin[0]), py = float(from_origin[1]),
                    pz = float(from_origin[2]),
                    own = float(range + float_margin * (range + from_origin.norm()));
        for (std::uint32_t e = start_[bucket]; e < start_[bucket + 1]; ++e) {
            const std::uint32_t facet = entry_[e];
            const Ball& ball = ball_[facet];
            const float dx = px - ball.center[0], dy = py - ball.center[1],
                        dz = pz - ball.center[2], far = ball.radius + own;
            if (dx * dx + dy * dy + dz * dz > far * far) continue;
            pair_particle_.push_back(std::int32_t(i));
            pair_facet_.push_back(std::int32_t(facet));
            __builtin_prefetch(surface.corners(facet));
        }
        if (pair_facet_.size() >= pairs_at_once) keep_near(points, surface, skin, found);
    }
    keep_near(points, surface, skin, found);
}

/// Distances of eight pairs at once; pairs come by particle, then by facet, and stay so.
void FacetCells::keep_near(const Points& points, const Surface& surface, double skin,
                           CandidateList& found) {
    const std::size_t pairs = pair_facet_.size();
    for (std::vector<std::int32_t>* rows : {&pair_particle_, &pair_facet_})
        while (rows->size() % lane_count != 0) rows->push_back(rows->back());
    for (std::size_t p = 0; p < pairs; p += lane_count) {
        fetch_nodes(surface, std::span(pair_facet_)
                                 .subspan(p + lane_count < pairs ? p + lane_count : p, lane_count));
        const Lanes distance =
            closest_points(gather_three(points.x.data(), load_rows(&pair_particle_[p])), surface,
                           load_rows(&pair_facet_[p]))
                .distance;
        for (std::size_t q = p; q < std::min(pairs, p + lane_count); ++q) {
            const std::uint32_t i = std::uint32_t(pair_particle_[q]);
            if (distance[q - p] > points.radius[i] + skin) continue;
            if (found.row.empty() || found.row.back() != i) {
                found.row.push_back(i);
                found.start.push_back(found.start.back());
            }
            found.facet.push_back(std::uint32_t(pair_facet_[q]));
            found.distance.push_back(float(distance[q - p] * (1 - float_margin)));
            ++found.start.back();
        }
    }
    pair_particle_.clear();
    pair_facet_.clear();
}

}  // namespace undertow::contact
