#pragma once
// Work on groups of elements by any number of threads, with sums at shared nodes in one order.
//
// Threads take the groups from one queue. A group waits until those before it that share a node
// with it are done, so that what a node gets is added in the order of the queue: same bits for any
// number of threads. Those it waits for have been taken by then, hence somebody is always at work.
// When neighbors stand far apart in the queue (colors do that), hardly anybody waits, and a sweep
// over all groups wakes the threads once.
//
// Two threads begin with a half of the queue each, and whoever is through helps in the other half:
// what a thread takes next is then next in memory, too, and has been asked for ahead. From one
// queue for both it would be every second group. More threads share the halves.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace undertow::fem {

class ChunkQueue {
 public:
    ChunkQueue() = default;
    /// Nodes of each group, in the order of the queue; its second half begins with group `middle`.
    ChunkQueue(const std::vector<std::vector<std::int32_t>>& nodes_of_group, std::size_t n_nodes,
               std::size_t middle);
    /// Without halves.
    ChunkQueue(const std::vector<std::vector<std::int32_t>>& nodes_of_group, std::size_t n_nodes)
        : ChunkQueue(nodes_of_group, n_nodes, nodes_of_group.size()) {}

    std::size_t size() const { return done_.size(); }
    /// First group of the second half; size() without halves.
    std::size_t middle() const { return std::size_t(middle_); }
    /// Groups before g that share a node with it.
    std::vector<std::int32_t> before(std::size_t g) const {
        return {before_.begin() + begin_[g], before_.begin() + begin_[g + 1]};
    }

    /// work(g) for every group; returns when all are done. Nothing may throw.
    void run(int threads, const std::function<void(std::int32_t)>& work);

 private:
    void wait_for(std::int32_t g);

    std::vector<std::int32_t> begin_, before_;  // of group g: before_[begin_[g] .. begin_[g + 1])
    std::vector<std::uint32_t> done_;           // the last sweep in which a group was done
    std::int32_t middle_ = 0;                   // first group of the second half
    std::uint32_t sweep_ = 0;
};

}  // namespace undertow::fem
