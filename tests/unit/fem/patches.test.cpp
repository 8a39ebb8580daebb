// Patches of tetrahedra: each element in one, none torn apart, about as large as asked for.

#include "fem_solver/elements/patches.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "fem_solver/setup/block_mesh.hpp"

namespace undertow::fem {
namespace {

/// Whether the elements share enough nodes to walk from the first to all others through faces.
bool hangs_together(const Mesh& mesh, std::vector<std::int32_t> elements) {
    std::vector<std::int32_t> reached{elements.back()};
    elements.pop_back();
    for (std::size_t k = 0; k < reached.size(); ++k)
        for (std::size_t i = 0; i < elements.size();) {
            int shared = 0;
            for (std::int32_t n : mesh.corners(elements[i]))
                for (std::int32_t m : mesh.corners(reached[k])) shared += n == m;
            if (shared < 3) {
                ++i;
                continue;
            }
            reached.push_back(elements[i]);
            elements.erase(elements.begin() + std::ptrdiff_t(i));
        }
    return elements.empty();
}

TEST_CASE("patches of tetrahedra cover the part, hang together and are of one size") {
    const Mesh mesh = make_block({{{0, 0, 0}, {1, 1, 1}}, {5, 4, 3}, {}, BlockCells::tetrahedra});
    std::vector<std::int32_t> part(mesh.tetrahedra.size());
    std::iota(part.begin(), part.end(), 0);
    std::reverse(part.begin(), part.end());  // in any order
    const int target = GENERATE(1, 6, 8);
    const std::vector<std::int32_t> patch = make_patches(mesh, part, target);
    REQUIRE(patch.size() == part.size());
    const int count = 1 + *std::max_element(patch.begin(), patch.end());
    std::vector<std::vector<std::int32_t>> members(count);
    for (std::size_t i = 0; i < patch.size(); ++i) members[patch[i]].push_back(part[i]);
    std::size_t largest = 0;
    for (const auto& elements : members) {
        REQUIRE(!elements.empty());
        CHECK(hangs_together(mesh, elements));
        largest = std::max(largest, elements.size());
    }
    WARN("patches of " << target << ": " << count << " for " << part.size()
                       << " tetrahedra, largest " << largest);
    CHECK(count >= int(part.size()) / (2 * target));
    CHECK(count <= int(1.35 * double(part.size()) / target) + 1);
    CHECK(largest <= std::size_t(2 * target));
}

TEST_CASE("tetrahedra that touch nothing are patches of their own") {
    Mesh mesh;
    for (int k = 0; k < 2; ++k) {
        const double x = 5 * k;
        mesh.x.insert(mesh.x.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x, 0, 1}});
        mesh.tetrahedra.push_back({4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3});
    }
    CHECK(make_patches(mesh, {0, 1}, 8) == std::vector<std::int32_t>{0, 1});
    CHECK(make_patches(mesh, {1}, 8) == std::vector<std::int32_t>{0});
}

}  // namespace
}  // namespace undertow::fem
