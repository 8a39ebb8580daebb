#pragma once
// Elements in batches of eight, one element per vector lane, each batch within one part.
//
// Batches form chunks of neighboring elements; chunks that share a node have different colors. A
// step walks them color by color, in large meshes one window of chunks after the other in each half
// of the mesh, and threads share them out of a queue (chunk_queue.hpp): forces on a node are always
// added in the same order, so results have the same bits for any number of threads.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "fem_solver/elements/chunk_queue.hpp"
#include "fem_solver/elements/element_group.hpp"
#include "fem_solver/elements/part.hpp"
#include "fem_solver/mesh.hpp"

namespace undertow {
class Archive;
}

namespace undertow::fem {

struct Chunk {
    std::int32_t begin, end;  // batches, of one part
};

enum class ElementOrder { of_the_mesh, lumps };
enum class Fetch { by_the_processor, ahead };

template <int n_corners>
class Batches {
 public:
    struct Batch {
        std::int32_t node[n_corners][n_lanes];  // corner, lane
        int valid = 0;                          // lanes in use; the others repeat the last one
        int part = 0;
    };

    Batches() = default;
    /// Small meshes are taken as they are, whatever is asked for.
    Batches(const Mesh& mesh, const std::vector<Part>& parts,
            ElementOrder order_of_large = ElementOrder::of_the_mesh,
            Fetch fetch_of_large = Fetch::by_the_processor);

    std::size_t size() const { return batch_.size(); }
    const Batch& operator[](std::size_t b) const { return batch_[b]; }
    const std::vector<Batch>& batches() const { return batch_; }
    std::size_t elements() const { return elements_; }
    std::int32_t element(std::size_t b, int lane) const { return element_at_[b * n_lanes + lane]; }
    /// Batch * 8 + lane of an element of the mesh; -1 when it is of no part here.
    std::int32_t slot(std::size_t element) const { return slot_of_[element]; }
    std::size_t chunks() const { return chunk_.size(); }
    const ChunkQueue& queue() const { return queue_; }

    /// Whether to ask memory for what batches ahead need (fetch_ahead.hpp).
    bool fetches_ahead() const { return !new_begin_.empty(); }
    /// Nodes of batch b that no batch before it in its chunk has; none beyond the last.
    std::span<const std::int32_t> new_nodes(std::size_t b) const {
        if (b >= batch_.size()) return {};
        return {&new_node_[0] + new_begin_[b], &new_node_[0] + new_begin_[b + 1]};
    }

    /// Calls set(batch, lane) for each lane that holds the element, padding too.
    template <class Set>
    void at_lanes_of(std::int32_t element, Set&& set) const {
        const std::int32_t first = slot_of_[element] / n_lanes * n_lanes;
        for (std::int32_t slot = first; slot < first + n_lanes; ++slot)
            if (element_at_[slot] == element) set(slot / n_lanes, slot % n_lanes);
    }
    /// Calls each(element, batch, lane) for all elements, each once, in the mesh's order.
    template <class Each>
    void for_each_element(Each&& each) const {
        for (std::size_t e = 0; e < slot_of_.size(); ++e)
            if (slot_of_[e] >= 0) each(e, slot_of_[e] / n_lanes, slot_of_[e] % n_lanes);
    }

    /// What is stored by batch means nothing in another order of the elements: that of a large mesh
    /// is kept with it. InputError when it is not the present one.
    void archive_order(Archive& a) const;

    /// Runs step_chunk(chunk) -> ElementsReport over all chunks; the sum is taken in the order of
    /// the chunks, always.
    template <class StepChunk>
    ElementsReport sweep(int threads, StepChunk&& step_chunk) {
        return sweep_chunks(threads, std::ref(step_chunk));  // a reference: nothing is allocated
    }

    /// [kg] of the elements, mass(batch) in lanes, an n_corners-th at each corner; times
    /// share(part).
    template <class Mass, class Share>
    void add_masses(std::vector<double>& nodal, Mass&& mass, Share&& share) const {
        for (std::size_t b = 0; b < batch_.size(); ++b) {
            const double ratio = share(batch_[b].part);
            for (int l = 0; l < batch_[b].valid; ++l)
                for (int corner = 0; corner < n_corners; ++corner)
                    nodal[batch_[b].node[corner][l]] += ratio * mass(b)[l] / n_corners;
        }
    }

    /// Element with the largest of the lanes' values, the first in the mesh of those alike.
    ExtremeElement largest(const std::vector<Lanes>& value) const {
        const auto at = [&](std::size_t slot) { return value[slot / n_lanes][slot % n_lanes]; };
        std::size_t best = 0;
        for (std::size_t slot = 1; slot < element_at_.size(); ++slot)
            if (at(slot) > at(best) ||
                (at(slot) == at(best) && element_at_[slot] < element_at_[best]))
                best = slot;
        return {std::size_t(element_at_[best]), at(best)};
    }
    /// Element with the smallest value(batch, lane); a NaN is the worst of all.
    template <class Value>
    ExtremeElement smallest(Value&& value) const {
        ExtremeElement worst{0, 1e300};
        for (std::size_t slot = 0; slot < element_at_.size(); ++slot) {
            const double v = value(slot / n_lanes, int(slot % n_lanes));
            if (v >= worst.value) continue;
            worst = {std::size_t(element_at_[slot]), v};
            if (!(v == v)) break;
        }
        return worst;
    }

 private:
    ElementsReport sweep_chunks(int threads,
                                const std::function<ElementsReport(const Chunk&)>& step_chunk);
    /// The elements of a chunk.
    struct Group {
        int part;
        std::vector<std::int32_t> elements;
    };
    void put_in_order(const Mesh& mesh, std::vector<Group>& groups, std::size_t chunks_per_window);
    void add_chunk(const Mesh& mesh, const Group& group);
    void list_new_nodes(std::size_t n_nodes);

    std::vector<Batch> batch_;
    std::vector<std::int32_t> slot_of_;     // element of the mesh -> batch * 8 + lane
    std::vector<std::int32_t> element_at_;  // and back; padding repeats its element
    std::size_t elements_ = 0;
    std::vector<Chunk> chunk_;  // in the order of the queue
    ChunkQueue queue_;
    std::vector<std::int32_t> new_begin_, new_node_;  // see new_nodes()
    std::vector<ElementsReport> chunk_report_;
};

template <int n_corners>
UNDERTOW_KERNEL void gather_corners(const NodeRow* rows,
                                    const std::int32_t (&node)[n_corners][n_lanes],
                                    Lanes (&out)[3][n_corners]) {
#pragma GCC unroll 8
    for (int corner = 0; corner < n_corners; ++corner)
        gather(rows, node[corner], out[0][corner], out[1][corner], out[2][corner]);
}

template <int n_corners>
UNDERTOW_KERNEL void scatter_corners(NodeRow* rows, const std::int32_t (&node)[n_corners][n_lanes],
                                     int valid, const Lanes (&f)[3][n_corners]) {
#pragma GCC unroll 8
    for (int corner = 0; corner < n_corners; ++corner)
        scatter_subtract(rows, node[corner], valid, f[0][corner], f[1][corner], f[2][corner]);
}

}  // namespace undertow::fem
