#pragma once
// Buffered Verlet lists, one per cluster of eight consecutive target particles: every source that is
// within `range` of any of the eight. The lanes of the pair loop are the eight targets, the list is
// walked one source at a time (single-j lists: no races, same sums for any number of threads).

#include <cstdint>
#include <vector>

#include "sph_solver/neighbors/column_grid.hpp"
#include "sph_solver/particles.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

/// Where the sources of one kind stand: their records are sorted by cell from index `base` on.
struct SourceCells {
    const std::vector<int>* start;   // [cells + 1] relative to base
    int base;
};

class ClusterLists {
 public:
    /// Targets are records [first, first + n), eight a cluster. range: 2h + skin [m]; where smoothing
    /// lengths differ, of the largest: then `smoothing` has h of each record [m], and a pair is listed
    /// within h_i + h_j + skin.
    void build(const ColumnGrid& grid, const FixedPoint& fixed, const std::vector<Packed>& records,
               int first, int n, const std::vector<SourceCells>& sources, double range,
               const std::vector<float>* smoothing = nullptr, double skin = 0);

    int clusters() const { return static_cast<int>(begin_.size()); }
    const int* begin(int c) const { return begin_[c]; }
    const int* end(int c) const { return begin_[c] + count_[c]; }
    /// Who walks a list may look so many entries ahead, past its end too: those are of no meaning.
    static constexpr int ahead = 16;
    /// Sources of the second kind and after: the kinds come one after the other in each list.
    const int* second(int c) const { return begin_[c] + of_first_kind_[c]; }
    std::int64_t entries() const;
    void archive(Archive& a);

 private:
    std::vector<const int*> begin_;
    std::vector<int> count_, of_first_kind_;
    std::vector<std::vector<int>> buffer_;   // one per block of clusters; keeps its capacity
    std::vector<float> reach_;               // of all records, where sizes differ [unit]
    std::vector<std::int32_t> x_, y_, z_;    // of all records, to look at sixteen at once
};

}  // namespace undertow::sph
