#pragma once
// Which entries of the cluster lists are within the support of a lane, one bit each. Lists reach out
// by a skin: of 197 entries 51 give nothing (skin 0.4 dx). A pass over densities finds out, and the
// pass over forces at the same positions walks the others only. A bit is set unless the kernel is
// exactly zero in all lanes, so that what is left out would have added zeros.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "sph_solver/neighbors/cluster_lists.hpp"

namespace undertow::sph {

class MarkedEntries {
 public:
    static constexpr int bits = 64;   // entries per word

    /// Room for the lists just built; nothing is marked.
    void lay_out(const ClusterLists& lists) {
        first_.resize(lists.clusters());
        std::size_t words = 0;
        for (int c = 0; c < lists.clusters(); ++c) {
            first_[c] = words;
            words += (lists.end(c) - lists.begin(c) + bits - 1) / bits;
        }
        words_.resize(words);
        state_ = State::none;
    }

    /// The word of n entries that are all marked, of `bits` if there are more.
    static std::uint64_t first(std::ptrdiff_t n) {
        return n < bits ? (std::uint64_t(1) << n) - 1 : ~std::uint64_t(0);
    }
    /// One bit for each entry of a cluster's list, the first lowest.
    std::uint64_t* of(int cluster) { return words_.data() + first_[cluster]; }

    /// A sum over all entries has marked those within the support.
    void found() { state_ = State::near; }
    /// Nothing has moved since those within the support were marked.
    bool known() const { return state_ == State::near; }
    /// Something has moved.
    void forget() {
        if (state_ == State::near) state_ = State::none;
    }
    /// Marks all entries unless those within the support are known.
    void need(const ClusterLists& lists) {
        if (state_ != State::none) return;
        for (int c = 0; c < lists.clusters(); ++c) {
            std::uint64_t* word = of(c);
            for (auto left = lists.end(c) - lists.begin(c); left > 0; left -= bits)
                *word++ = first(left);
        }
        state_ = State::all;
    }

 private:
    enum class State { none, all, near };
    State state_ = State::none;
    std::vector<std::size_t> first_;    // [clusters]
    std::vector<std::uint64_t> words_;
};

}  // namespace undertow::sph
