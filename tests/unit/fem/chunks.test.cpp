// How elements are laid out and shared among threads: lumps, colors within windows, the queue.

#include <atomic>
#include <catch2/catch.hpp>
#include <random>
#include <set>
#include <thread>

#include "fem_solver/elements/batches.hpp"
#include "fem_solver/elements/chunk_queue.hpp"
#include "fem_solver/elements/coloring.hpp"
#include "fem_solver/elements/corners.hpp"
#include "fem_solver/elements/lumps.hpp"
#include "fem_solver/setup/block_mesh.hpp"
#include "support.hpp"

namespace undertow::fem {
namespace {

using Groups = std::vector<std::vector<std::int32_t>>;

Groups random_groups(std::size_t groups, int nodes, int nodes_of_group) {
    std::mt19937 random(5);
    Groups all(groups);
    for (auto& group : all)
        for (int k = 0; k < nodes_of_group; ++k) group.push_back(std::int32_t(random() % nodes));
    return all;
}

double nodes_per_element(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                         std::size_t size) {
    std::size_t sum = 0;
    for (std::size_t first = 0; first < elements.size(); first += size) {
        std::set<std::int32_t> nodes;
        for (std::size_t i = first; i < std::min(first + size, elements.size()); ++i)
            nodes.insert(mesh.corners(elements[i]).begin(), mesh.corners(elements[i]).end());
        sum += nodes.size();
    }
    return double(sum) / double(elements.size());
}

TEST_CASE("lumps hold all elements once and touch few nodes, whatever the order of the mesh") {
    const std::array<int, 3> divisions =
        GENERATE(std::array{32, 32, 32}, std::array{40, 24, 20}, std::array{100, 90, 2});
    const double thin = GENERATE(1.0, 0.1);  // elements ten times as wide as high
    Mesh mesh = make_block(
        FemBlock{{{0, 0, 0}, {double(divisions[0]), double(divisions[1]), thin * divisions[2]}},
                 divisions,
                 {},
                 BlockCells::hexahedra});
    std::mt19937 random(7);
    std::shuffle(mesh.hexahedra.begin(), mesh.hexahedra.end(), random);
    std::vector<std::int32_t> elements(mesh.hexahedra.size());
    for (std::size_t e = 0; e < elements.size(); ++e) elements[e] = std::int32_t(e);

    const std::vector<std::int32_t> order = in_lumps(mesh, elements, 512);
    std::vector<std::int32_t> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    CHECK(sorted == elements);
    CHECK(order == in_lumps(mesh, elements, 512));
    // a cube of 8 x 8 x 8 has (9/8)^3 = 1.42; a plate two high 3/2 (17/16)^2 = 1.69
    const double touched = nodes_per_element(mesh, order, 512);
    INFO(divisions[0] << " x " << divisions[1] << " x " << divisions[2] << ", " << touched);
    CHECK(touched < (divisions[2] == 2 ? 1.8 : 1.65));
    if (divisions[0] == 32) CHECK(touched == 729.0 / 512);
    CHECK(nodes_per_element(mesh, elements, 512) > 4);
}

TEST_CASE("colors follow each other within windows, and a window of all groups is no window") {
    const Groups groups = random_groups(60, 90, 4);
    const Coloring all = color_by_nodes(groups, 90), same = color_by_nodes(groups, 90, 60),
                   windows = color_by_nodes(groups, 90, 16);
    CHECK(all.order == same.order);
    CHECK(all.begin == same.begin);
    for (std::size_t i = 0; i < windows.order.size(); ++i)
        CHECK(std::size_t(windows.order[i]) / 16 == i / 16);
    for (std::size_t c = 0; c + 1 < windows.begin.size(); ++c) {
        std::vector<int> owner(90, -1);
        for (std::int32_t i = windows.begin[c]; i < windows.begin[c + 1]; ++i)
            for (std::int32_t n : groups[windows.order[i]]) {
                CHECK((owner[n] == -1 || owner[n] == windows.order[i]));
                owner[n] = windows.order[i];
            }
    }
}

TEST_CASE("groups that share a node run one after the other, in the order of the queue") {
    const int n_nodes = GENERATE(40, 4000);  // nearly all share a node; few do
    const Groups groups = random_groups(400, n_nodes, 5);
    const std::size_t middle = GENERATE(400u, 200u, 3u);  // no halves; halves; very unequal ones
    const int threads = GENERATE(2, 3, 4);
    ChunkQueue queue(groups, std::size_t(n_nodes), middle);
    CHECK(queue.middle() == middle);
    std::vector<std::vector<std::int32_t>> seen(n_nodes);
    std::atomic<int> running{0}, most{0};
    for (int sweep = 0; sweep < 3; ++sweep) {
        for (auto& order : seen) order.clear();
        queue.run(threads, [&](std::int32_t g) {
            most = std::max(int(most), ++running);
            // no lock: the queue keeps others off these nodes, or bits and sizes come out wrong
            for (std::int32_t n : groups[g]) seen[n].push_back(g);
            if (g % 7 == 0) std::this_thread::yield();
            --running;
        });
        std::size_t count = 0;
        for (const auto& order : seen) {
            CHECK(std::is_sorted(order.begin(), order.end()));
            count += order.size();
        }
        CHECK(count == 400u * 5);
    }
    CHECK(most >= 1);
    CHECK(most <= threads);
    CHECK(queue.before(0).empty());
    if (n_nodes == 40) CHECK(queue.before(399).size() > 100);
}

TEST_CASE("halves of a large mesh meet at the first half's beginning and at the second's end") {
    const Mesh mesh = make_block(FemBlock{{{0, 0, 0}, {40, 32, 32}}, {40, 32, 32}, {}});
    Part part;
    for (std::size_t e = 0; e < mesh.n_elements(); ++e) part.elements.push_back(std::int32_t(e));
    const Batches<8> batches(mesh, {part}, ElementOrder::lumps);
    const ChunkQueue& queue = batches.queue();
    const std::size_t chunks = batches.chunks(), middle = queue.middle();
    REQUIRE(chunks == 80);
    REQUIRE(middle == 40);
    // halves of 20 x 32 x 32 share a face: lumps of 10 x 8 x 6 or 7 leave at most 20 at it
    std::set<std::size_t> of_first, of_second;
    for (std::size_t g = middle; g < chunks; ++g)
        for (std::int32_t before : queue.before(g))
            if (std::size_t(before) < middle) {
                of_first.insert(std::size_t(before));
                of_second.insert(g);
            }
    REQUIRE(!of_first.empty());
    CHECK(of_first.size() <= 20);
    CHECK(of_second.size() <= 20);
    CHECK(*of_first.rbegin() + 1 == of_first.size());
    CHECK(*of_second.begin() + of_second.size() == chunks);

    part.elements.resize(8192);
    CHECK(Batches<8>(mesh, {part}, ElementOrder::lumps).queue().middle() == 8);
    part.elements.resize(8191);  // below 8,192 elements one thread does it
    CHECK(Batches<8>(mesh, {part}, ElementOrder::lumps).queue().middle() == 16);
}

TEST_CASE("the corner that has folded most is found wherever it is, by one thread and by two") {
    const Mesh mesh =
        make_block(FemBlock{{{0, 0, 0}, {26, 26, 26}}, {26, 26, 26}, {}, BlockCells::hexahedra});
    // elements are looked at in blocks: folded ones in the first, in the middle and in the last
    const std::size_t folded = GENERATE(3u, 9000u, 17000u);
    const std::int32_t node = mesh.hexahedra[folded][6];
    NodeRows x(mesh.x.size());
    for (std::size_t n = 0; n < x.size(); ++n)
        for (int d = 0; d < 3; ++d) x[n].c[d] = mesh.x[n][d];
    CHECK(worst_corner(mesh, x, 2).share == 1);
    for (int d = 0; d < 3; ++d) x[node].c[d] -= 0.9;  // along a diagonal of 1, 1, 1
    const WorstCorner one = worst_corner(mesh, x, 1), two = worst_corner(mesh, x, 2);
    CHECK(one.element == folded);
    CHECK(one.node == node);
    CHECK(one.share == Approx(-1.7));  // det of its edges, 0.9 everywhere less the unit matrix
    CHECK(two.element == one.element);
    CHECK(two.node == one.node);
    CHECK(two.share == one.share);
}

}  // namespace
}  // namespace undertow::fem
