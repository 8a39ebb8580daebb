#pragma once
// Which facets can a particle touch before the next search? Cells over the facets, one look-up per
// particle, kept as flat rows until a displacement makes them stale.

#include <cstdint>
#include <span>
#include <vector>

#include "contact/points.hpp"
#include "contact/surface.hpp"

namespace undertow::contact {

/// Candidate facets of the active particles: facet[start[i]] .. facet[start[i + 1] - 1], rising.
struct CandidateList {
    std::vector<std::uint32_t> row;    // (A) rows of the searched points that have a candidate
    std::vector<std::uint32_t> start;  // (A + 1)
    std::vector<std::uint32_t> facet;
    std::vector<std::uint32_t> used;  // facets that appear, rising
};

/// Hashed cells over facets. Storage is kept between searches.
class FacetCells {
 public:
    /// All facets within radius_i + skin [m] of point i, at the surface's present position.
    void search(const Points& points, const Surface& surface, double skin, CandidateList& found);

 private:
    /// A facet in a cell, with a ball around its reach: most tests end here, in one cache line.
    struct Entry {
        std::uint64_t key;
        std::uint32_t facet;
        std::array<float, 3> center;  // [m] from the origin of the cells
        float radius;                 // [m] of the ball around the facet, rounded up
    };
    void fill(const Surface& surface, double range);
    std::uint64_t key_of(const Vec& x) const;
    std::size_t bucket_of(std::uint64_t key) const;
    template <typename Visit>
    void for_each_cell(const Surface& surface, std::uint32_t facet, double range,
                       Visit visit) const;

    Vec origin_ = Vec::Zero();          // [m]
    double size_ = 1;                   // [m] cell edge
    int bits_ = 0;                      // buckets = 2^bits
    std::vector<std::uint32_t> start_;  // per bucket
    std::vector<Entry> entry_, unsorted_;
    std::vector<FacetFrame> frame_;
    std::vector<std::uint8_t> is_used_;
};

}  // namespace undertow::contact
