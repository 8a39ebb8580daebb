#include "fem_solver/elements/batches.hpp"

#include "fem_solver/elements/coloring.hpp"

namespace undertow::fem {

template <int n_corners>
Batches<n_corners>::Batches(const Mesh& mesh, const std::vector<Part>& parts) {
    // 512 elements: their nodes and state stay in a 1 MB second-level cache, and a color holds
    // enough chunks to share
    constexpr std::int32_t batches_per_chunk = 64;
    slot_of_.assign(mesh.n_elements(), -1);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::vector<std::int32_t>& elements = parts[p].elements;
        elements_ += elements.size();
        const std::int32_t first_batch = std::int32_t(batch_.size());
        for (std::size_t e = 0; e < elements.size(); e += n_lanes) {
            Batch batch;
            batch.part = int(p);
            batch.valid = int(std::min<std::size_t>(n_lanes, elements.size() - e));
            for (int l = 0; l < n_lanes; ++l) {
                const std::int32_t element = elements[e + std::min(l, batch.valid - 1)];
                const std::span<const std::int32_t> corners = mesh.corners(element);
                for (int corner = 0; corner < n_corners; ++corner)
                    batch.node[corner][l] = corners[corner];
                if (l < batch.valid) slot_of_[element] = std::int32_t(batch_.size()) * n_lanes + l;
                element_at_.push_back(element);
            }
            batch_.push_back(batch);
        }
        const std::int32_t last_batch = std::int32_t(batch_.size());
        for (std::int32_t b = first_batch; b < last_batch; b += batches_per_chunk)
            chunk_.push_back({b, std::min(b + batches_per_chunk, last_batch)});
    }
    color_chunks(mesh.x.size());
}

template <int n_corners>
void Batches<n_corners>::color_chunks(std::size_t n_nodes) {
    std::vector<std::vector<std::int32_t>> nodes_of_chunk;
    for (const Chunk& chunk : chunk_) {
        std::vector<std::int32_t> nodes;
        for (std::int32_t b = chunk.begin; b < chunk.end; ++b)
            nodes.insert(nodes.end(), &batch_[b].node[0][0],
                         &batch_[b].node[0][0] + n_corners * n_lanes);
        nodes_of_chunk.push_back(std::move(nodes));
    }
    const Coloring coloring = color_by_nodes(nodes_of_chunk, n_nodes);
    std::vector<Chunk> sorted;
    for (std::int32_t c : coloring.order) sorted.push_back(chunk_[c]);
    chunk_ = std::move(sorted);
    color_begin_ = coloring.begin;
    chunk_report_.resize(chunk_.size());
}

template <int n_corners>
ElementsReport Batches<n_corners>::sweep_chunks(
    int threads, const std::function<ElementsReport(const Chunk&)>& step_chunk) {
    for (std::size_t color = 0; color + 1 < color_begin_.size(); ++color) {
        const std::int32_t begin = color_begin_[color], end = color_begin_[color + 1];
        if (threads > 1 && end - begin > 1) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
            for (std::int32_t c = begin; c < end; ++c) chunk_report_[c] = step_chunk(chunk_[c]);
        } else {
            for (std::int32_t c = begin; c < end; ++c) chunk_report_[c] = step_chunk(chunk_[c]);
        }
    }
    ElementsReport total;
    for (const ElementsReport& r : chunk_report_) total += r;
    return total;
}

template class Batches<8>;  // hexahedra
template class Batches<4>;  // tetrahedra and shells

}  // namespace undertow::fem
