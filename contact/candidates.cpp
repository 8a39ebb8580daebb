#include "contact/candidates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace undertow::contact {

namespace {

// 21 bits per axis: 2 million cells along each, more than any coordinate range of a run needs.
constexpr int axis_bits = 21;
constexpr std::int64_t axis_mask = (std::int64_t(1) << axis_bits) - 1;

std::uint64_t pack(std::int64_t i, std::int64_t j, std::int64_t k) {
    return std::uint64_t(i & axis_mask) << (2 * axis_bits) |
           std::uint64_t(j & axis_mask) << axis_bits | std::uint64_t(k & axis_mask);
}

}  // namespace

std::uint64_t FacetCells::key_of(const Vec& x) const {
    const Vec cell = (x - origin_) / size_;
    return pack(std::int64_t(std::floor(cell[0])), std::int64_t(std::floor(cell[1])),
                std::int64_t(std::floor(cell[2])));
}

std::size_t FacetCells::bucket_of(std::uint64_t key) const {
    return (key * 0x9E3779B97F4A7C15ull) >> (64 - bits_);  // Fibonacci hashing
}

template <typename Visit>
void FacetCells::for_each_cell(const Surface& surface, std::uint32_t facet, double range,
                               Visit visit) const {
    const Corners shape = surface.shape(facet);
    const FacetFrame& frame = frame_[facet];
    Vec low = shape.x[0], high = shape.x[0];
    for (const Vec& corner : shape.x) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
    }
    const Vec first = (low.array() - range - origin_.array()) / size_;
    const Vec last = (high.array() + range - origin_.array()) / size_;
    // The box of a slanted facet has corners that the facet never comes near.
    const double cell_reach =
        frame.warp + range + 0.8660254037844387 * size_;  // half a cell's diagonal
    for (auto i = std::int64_t(std::floor(first[0])); i <= std::int64_t(std::floor(last[0])); ++i)
        for (auto j = std::int64_t(std::floor(first[1])); j <= std::int64_t(std::floor(last[1]));
             ++j)
            for (auto k = std::int64_t(std::floor(first[2]));
                 k <= std::int64_t(std::floor(last[2])); ++k) {
                const Vec middle =
                    origin_ + size_ * Vec(double(i) + 0.5, double(j) + 0.5, double(k) + 0.5);
                if (std::abs(frame.normal.dot(middle - frame.center)) <= cell_reach)
                    visit(pack(i, j, k));
            }
}

void FacetCells::fill(const Surface& surface, double range) {
    const std::uint32_t facets = std::uint32_t(surface.facets());
    frame_.resize(facets);
    Vec low = Vec::Constant(std::numeric_limits<double>::infinity());
    double mean_size = 0;
    for (std::uint32_t f = 0; f < facets; ++f) {
        frame_[f] = surface.frame(f);
        mean_size += (frame_[f].outline[0] + frame_[f].outline[2]) / facets;
        low = low.cwiseMin(frame_[f].center);
    }
    // Larger cells hold facets that are tested in vain, smaller ones repeat each facet in many
    // cells; a test costs less than an entry.
    size_ = mean_size + range;
    origin_ = low;

    unsorted_.clear();
    for (std::uint32_t f = 0; f < facets; ++f) {
        const Vec center = frame_[f].center - origin_;
        double radius = 0;
        for (const Vec& corner : surface.shape(f).x)
            radius = std::max(radius, (corner - frame_[f].center).norm());
        radius += 1e-6 * (radius + center.norm());  // for what float cannot hold
        const Entry ball{
            0, f, {float(center[0]), float(center[1]), float(center[2])}, float(radius)};
        for_each_cell(surface, f, range, [&](std::uint64_t key) {
            unsorted_.push_back(ball);
            unsorted_.back().key = key;
        });
    }

    // Counting sort into buckets. Filled from the back, each bucket's end moves to its start.
    bits_ = std::max(4, int(std::bit_width(unsorted_.size())));
    start_.assign((std::size_t(1) << bits_) + 2, 0);
    entry_.resize(unsorted_.size());
    for (const Entry& entry : unsorted_) ++start_[bucket_of(entry.key)];
    for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
    for (std::size_t e = unsorted_.size(); e-- > 0;)
        entry_[--start_[bucket_of(unsorted_[e].key)]] = unsorted_[e];
}

void FacetCells::search(const Points& points, const Surface& surface, double skin,
                        CandidateList& found) {
    double largest_radius = 0;
    for (double radius : points.radius) largest_radius = std::max(largest_radius, radius);
    fill(surface, largest_radius + skin);

    found.row.clear();
    found.start.assign(1, 0);
    found.facet.clear();
    is_used_.assign(surface.facets(), 0);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Vec x = Vec::Map(&points.x[3 * std::size_t(i)]);
        const double range = points.radius[i] + skin;
        const std::uint64_t key = key_of(x);
        const std::size_t bucket = bucket_of(key);
        const Vec from_origin = x - origin_;
        const float px = float(from_origin[0]), py = float(from_origin[1]),
                    pz = float(from_origin[2]), ball = float(range * (1 + 1e-6));
        for (std::uint32_t e = start_[bucket]; e < start_[bucket + 1]; ++e) {
            const Entry& entry = entry_[e];
            const float dx = px - entry.center[0], dy = py - entry.center[1],
                        dz = pz - entry.center[2], far = entry.radius + ball;
            if (dx * dx + dy * dy + dz * dz > far * far || entry.key != key) continue;
            const std::uint32_t facet = entry.facet;
            if (frame_[facet].is_beyond(x - frame_[facet].center, range)) continue;
            if (closest_point(x, surface.shape(facet)).distance > range) continue;
            found.facet.push_back(facet);
            is_used_[facet] = 1;
        }
        if (found.facet.size() > found.start.back()) {
            found.row.push_back(i);
            found.start.push_back(std::uint32_t(found.facet.size()));
        }
    }
    found.used.clear();
    for (std::uint32_t f = 0; f < is_used_.size(); ++f)
        if (is_used_[f]) found.used.push_back(f);
}

}  // namespace undertow::contact
