#include "fem_solver/elements/batches.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "checkpoint/archive.hpp"
#include "fem_solver/elements/coloring.hpp"
#include "fem_solver/elements/lumps.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

// 512 elements: their nodes and state stay in a 1 MB second-level cache, and a large mesh has enough
// chunks to share
constexpr std::size_t elements_per_chunk = 512;
// From here on a run has two threads (structure.cpp), and each begins with a half of the mesh.
constexpr std::size_t halved_mesh = 8192;
// From here on a mesh comes from memory in every step. Below, the order of the mesh is as good.
constexpr std::size_t large_mesh = 16384;
// Chunks. Colors follow each other within a window, so that the nodes of its chunks stay in the
// third-level cache until the last of them is through; a color of it holds a dozen chunks to share.
constexpr std::size_t window = 128;
// All chunks of a small mesh.
constexpr std::size_t one_window = std::numeric_limits<std::size_t>::max();

/// Sorts the first half's groups so that those that share nodes with the second come first, and
/// the second half's so that those that share nodes with the first come last: a thread at work on
/// each half hardly ever waits for the other. Begin and end of the groups away from the seam.
std::pair<std::size_t, std::size_t> put_seam_apart(
    const std::vector<std::vector<std::int32_t>>& nodes_of_group, std::size_t n_nodes,
    std::size_t middle, std::vector<std::int32_t>& order) {
    std::vector<char> in_first(n_nodes, 0), in_second(n_nodes, 0);
    for (std::size_t g = 0; g < nodes_of_group.size(); ++g)
        for (std::int32_t n : nodes_of_group[g]) (g < middle ? in_first : in_second)[n] = 1;
    const auto at_seam = [&](std::int32_t g) {
        return std::any_of(nodes_of_group[g].begin(), nodes_of_group[g].end(),
                           [&](std::int32_t n) { return in_first[n] && in_second[n]; });
    };
    const auto begin = order.begin(), second = begin + std::ptrdiff_t(middle);
    const auto first_away = std::stable_partition(begin, second, at_seam);
    const auto last_away = std::stable_partition(second, order.end(), std::not_fn(at_seam));
    return {std::size_t(first_away - begin), std::size_t(last_away - begin)};
}

}  // namespace

template <int n_corners>
Batches<n_corners>::Batches(const Mesh& mesh, const std::vector<Part>& parts,
                            ElementOrder order_of_large, Fetch fetch_of_large) {
    for (const Part& part : parts) elements_ += part.elements.size();
    const bool large = elements_ >= large_mesh;
    std::vector<Group> groups;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::vector<std::int32_t> elements =
            large && order_of_large == ElementOrder::lumps
                ? in_lumps(mesh, parts[p].elements, elements_per_chunk)
                : parts[p].elements;
        for (std::size_t e = 0; e < elements.size(); e += elements_per_chunk)
            groups.push_back(
                {int(p), {elements.begin() + std::ptrdiff_t(e),
                          elements.begin() + std::ptrdiff_t(std::min(e + elements_per_chunk,
                                                                     elements.size()))}});
    }
    put_in_order(mesh, groups, large ? window : one_window);
    for (const Group& group : groups) add_chunk(mesh, group);
    slot_of_.assign(mesh.n_elements(), -1);
    for (std::size_t b = 0; b < batch_.size(); ++b)
        for (int l = 0; l < batch_[b].valid; ++l)
            slot_of_[element_at_[b * n_lanes + l]] = std::int32_t(b) * n_lanes + l;
    if (large && fetch_of_large == Fetch::ahead) list_new_nodes(mesh.x.size());
    chunk_report_.resize(chunk_.size());
}

template <int n_corners>
void Batches<n_corners>::put_in_order(const Mesh& mesh, std::vector<Group>& groups,
                                      std::size_t chunks_per_window) {
    std::vector<std::vector<std::int32_t>> nodes_of_group;
    for (const Group& group : groups) {
        std::vector<std::int32_t> nodes;
        for (std::int32_t e : group.elements)
            nodes.insert(nodes.end(), mesh.corners(e).begin(), mesh.corners(e).end());
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        nodes_of_group.push_back(std::move(nodes));
    }
    const bool halves = elements_ >= halved_mesh;
    const std::size_t middle = halves ? groups.size() / 2 : groups.size();
    std::vector<std::int32_t> order(groups.size());
    std::iota(order.begin(), order.end(), 0);
    std::pair<std::size_t, std::size_t> away{0, groups.size()};
    if (halves) away = put_seam_apart(nodes_of_group, mesh.x.size(), middle, order);
    std::vector<Group> sorted;
    std::vector<std::vector<std::int32_t>> nodes_of_sorted;
    const auto add_colored = [&](std::size_t first, std::size_t last) {
        std::vector<std::vector<std::int32_t>> nodes;
        for (std::size_t i = first; i < last; ++i) nodes.push_back(nodes_of_group[order[i]]);
        for (std::int32_t i : color_by_nodes(nodes, mesh.x.size(), chunks_per_window).order) {
            const std::int32_t g = order[first + std::size_t(i)];
            sorted.push_back(std::move(groups[g]));
            nodes_of_sorted.push_back(std::move(nodes_of_group[g]));
        }
    };
    add_colored(0, away.first);
    add_colored(away.first, middle);
    add_colored(middle, away.second);
    add_colored(away.second, order.size());
    groups = std::move(sorted);
    queue_ = ChunkQueue(nodes_of_sorted, mesh.x.size(), middle);
}

template <int n_corners>
void Batches<n_corners>::add_chunk(const Mesh& mesh, const Group& group) {
    const std::vector<std::int32_t>& elements = group.elements;
    const std::int32_t first_batch = std::int32_t(batch_.size());
    for (std::size_t e = 0; e < elements.size(); e += n_lanes) {
        Batch batch;
        batch.part = group.part;
        batch.valid = int(std::min<std::size_t>(n_lanes, elements.size() - e));
        for (int l = 0; l < n_lanes; ++l) {
            const std::int32_t element = elements[e + std::min(l, batch.valid - 1)];
            const std::span<const std::int32_t> corners = mesh.corners(element);
            for (int corner = 0; corner < n_corners; ++corner)
                batch.node[corner][l] = corners[corner];
            element_at_.push_back(element);
        }
        batch_.push_back(batch);
    }
    chunk_.push_back({first_batch, std::int32_t(batch_.size())});
}

template <int n_corners>
void Batches<n_corners>::list_new_nodes(std::size_t n_nodes) {
    new_begin_ = {0};
    std::vector<std::int32_t> last_chunk(n_nodes, -1);
    for (std::size_t c = 0; c < chunk_.size(); ++c)
        for (std::int32_t b = chunk_[c].begin; b < chunk_[c].end; ++b) {
            for (int corner = 0; corner < n_corners; ++corner)
                for (int l = 0; l < n_lanes; ++l) {
                    const std::int32_t n = batch_[b].node[corner][l];
                    if (last_chunk[n] == std::int32_t(c)) continue;
                    last_chunk[n] = std::int32_t(c);
                    new_node_.push_back(n);
                }
            new_begin_.push_back(std::int32_t(new_node_.size()));
        }
}

template <int n_corners>
ElementsReport Batches<n_corners>::sweep_chunks(
    int threads, const std::function<ElementsReport(const Chunk&)>& step_chunk) {
    const auto step = [&](std::int32_t c) { chunk_report_[c] = step_chunk(chunk_[c]); };
    queue_.run(threads, std::ref(step));
    ElementsReport total;
    for (const ElementsReport& r : chunk_report_) total += r;
    return total;
}

template <int n_corners>
void Batches<n_corners>::archive_order(Archive& a) const {
    // Small meshes are taken as they are, by every version, and need no mark. Their checkpoints of
    // before there was one can be read.
    if (elements_ < halved_mesh) return;
    std::uint64_t mark = 14695981039346656037u;  // FNV-1a over the elements, batch by batch
    for (std::int32_t e : element_at_) mark = (mark ^ std::uint64_t(e)) * 1099511628211u;
    if (!a.same("order", mark))
        throw InputError(
            "the checkpoint holds the elements of a mesh of " + std::to_string(elements_) +
            " in another order than this version of the program has; resume with the version that "
            "wrote it, or start anew.");
}

template class Batches<8>;  // hexahedra
template class Batches<4>;  // tetrahedra and shells

}  // namespace undertow::fem
