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
    std::vector<float> distance;  // [m] of point and facet at the search, rounded down
};

/// Hashed cells over facets. Storage is kept between searches.
class FacetCells {
 public:
    /// All facets within radius_i + skin [m] of point i, at the surface's present position.
    void search(const Points& points, const Surface& surface, double skin, CandidateList& found);

 private:
    /// A ball around a facet: most tests end here, in a quarter of a cache line.
    struct Ball {
        std::array<float, 3> center;  // [m] from the origin of the cells
        float radius;                 // [m] rounded up
    };
    void fill(const Surface& surface, double range);
    /// Keeps of the listed pairs those within reach.
    void keep_near(const Points& points, const Surface& surface, double skin, CandidateList& found);
    std::size_t bucket_of(std::int64_t i, std::int64_t j, std::int64_t k) const;
    template <typename Visit>
    void for_each_bucket(const Surface& surface, double range, Visit visit);

    Vec origin_ = Vec::Zero();          // [m]
    double size_ = 1;                   // [m] cell edge
    int bits_ = 0;                      // buckets = 2^bits
    std::vector<std::uint32_t> start_;  // per bucket
    std::vector<std::uint32_t> entry_;  // facets of a bucket, rising, each once
    std::vector<std::uint32_t> last_;   // per bucket: the last facet that came, while filling
    std::vector<Ball> ball_;            // per facet
    std::vector<std::int32_t> pair_particle_, pair_facet_;  // still to be measured
};

}  // namespace undertow::contact
