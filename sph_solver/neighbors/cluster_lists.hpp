#pragma once
// Buffered Verlet lists, one per cluster of eight consecutive target particles: every source that is
// within `range` of any of the eight. The lanes of the pair loop are the eight targets, the list is
// walked one source at a time (single-j lists: no races, same sums for any number of threads).

#include <cstdint>
#include <vector>

#include "sph_solver/neighbors/column_grid.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/simd.hpp"

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

    /// A stretch of a list whose entries some of the eight do not see (bit k: target k), see
    /// ThinPlates. The first is what begin() to end() holds, which all see; most clusters have no
    /// other.
    struct Part {
        const int *begin, *end;
        std::uint32_t hidden;
    };
    int parts(int c) const {
        return part_begin_.empty() ? 1 : 1 + part_begin_[c + 1] - part_begin_[c];
    }
    Part part(int c, int k) const {
        if (k == 0) return {begin(c), end(c), 0};
        const Stretch& s = stretch_[part_begin_[c] + k - 1];
        return {begin_[c] + s.first, begin_[c] + s.first + s.count, s.hidden};
    }
    /// Calls f(record) for all entries that one target sees.
    template <class F>
    void for_each_seen(int target, F&& f) const {
        const int c = target / lanes, lane = target % lanes;
        for (int k = 0; k < parts(c); ++k) {
            const Part seen = part(c, k);
            if (seen.hidden >> lane & 1) continue;
            for (const int* at = seen.begin; at != seen.end; ++at) f(*at);
        }
    }
    bool cut() const { return !stretch_.empty() || dropped_ > 0; }
    static constexpr std::uint8_t nobody = 0xff;
    /// Pairs (i, j) within range that were taken out, (j, i) too.
    std::int64_t cut_pairs() const { return cut_pairs_; }
    /// [clusters], each empty or by entry who does not see it; entries that `nobody` sees are dropped.
    /// `pairs` that is in all.
    void hide(const std::vector<std::vector<std::uint8_t>>& from, std::int64_t pairs);

 private:
    struct Stretch {
        int first, count;  // from begin(c)
        std::uint32_t hidden;
    };
    std::vector<int> part_begin_;     // [clusters + 1]; empty unless lists were cut
    std::vector<Stretch> stretch_;
    std::int64_t dropped_ = 0;        // entries
    std::int64_t cut_pairs_ = 0;
    std::vector<int*> begin_;
    std::vector<int> count_, of_first_kind_;
    std::vector<std::vector<int>> buffer_;   // one per block of clusters; keeps its capacity
    std::vector<float> reach_;               // of all records, where sizes differ [unit]
    std::vector<std::int32_t> x_, y_, z_;    // of all records, to look at sixteen at once
};

}  // namespace undertow::sph
