#include "fem_solver/elements/chunk_queue.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace undertow::fem {

ChunkQueue::ChunkQueue(const std::vector<std::vector<std::int32_t>>& nodes_of_group,
                       std::size_t n_nodes, std::size_t middle)
    : begin_{0}, done_(nodes_of_group.size(), 0), middle_(std::int32_t(middle)) {
    std::vector<std::vector<std::int32_t>> groups_at(n_nodes);
    std::vector<std::int32_t> own;
    for (std::size_t g = 0; g < nodes_of_group.size(); ++g) {
        own.clear();
        for (std::int32_t n : nodes_of_group[g]) {
            for (std::int32_t other : groups_at[n])
                if (other != std::int32_t(g)) own.push_back(other);
            if (groups_at[n].empty() || groups_at[n].back() != std::int32_t(g))
                groups_at[n].push_back(std::int32_t(g));
        }
        std::sort(own.begin(), own.end());
        own.erase(std::unique(own.begin(), own.end()), own.end());
        before_.insert(before_.end(), own.begin(), own.end());
        begin_.push_back(std::int32_t(before_.size()));
    }
}

void ChunkQueue::run(int threads, const std::function<void(std::int32_t)>& work) {
    const std::int32_t n = std::int32_t(size());
    if (threads <= 1 || n <= 1) {
        for (std::int32_t g = 0; g < n; ++g) work(g);
        return;
    }
    ++sweep_;
    std::atomic<std::int32_t> next[2] = {0, middle_};
    const std::int32_t end[2] = {middle_, n};
#pragma omp parallel num_threads(threads)
    {
        // The first half never waits for the second, so that somebody is always at work, even where
        // fewer threads come than were asked for.
        const int own = 2 * omp_get_thread_num() / omp_get_num_threads();
        for (int half : {own, 1 - own})
            for (std::int32_t g;
                 (g = next[half].fetch_add(1, std::memory_order_relaxed)) < end[half];) {
                for (std::int32_t i = begin_[g]; i < begin_[g + 1]; ++i) wait_for(before_[i]);
                work(g);
                std::atomic_ref(done_[g]).store(sweep_, std::memory_order_release);
            }
    }
}

void ChunkQueue::wait_for(std::int32_t g) {
    // about as long as a chunk takes; after that its thread may not be running at all
    constexpr int looks = 20000;
    for (int i = 0; std::atomic_ref(done_[g]).load(std::memory_order_acquire) != sweep_; ++i)
        if (i >= looks) std::this_thread::yield();
}

}  // namespace undertow::fem
