#include "fem_solver/elements/patches.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace undertow::fem {
namespace {

using Neighbors = std::array<std::int32_t, 4>;  // beyond each face; -1: none

std::vector<Neighbors> neighbors_of(const Mesh& mesh, const std::vector<std::int32_t>& elements) {
    std::vector<Neighbors> all(elements.size(), {-1, -1, -1, -1});
    std::map<Quad, std::pair<std::int32_t, int>> open;  // face -> element and its face
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const std::span<const std::int32_t> t = mesh.corners(elements[e]);
        for (int f = 0; f < 4; ++f) {
            const auto& n = tetrahedron_face[f];
            const Quad face = sorted_facet({t[n[0]], t[n[1]], t[n[2]], t[n[2]]});
            const auto [other, is_new] = open.try_emplace(face, std::int32_t(e), f);
            if (is_new) continue;
            all[e][f] = other->second.first;
            all[other->second.first][other->second.second] = std::int32_t(e);
        }
    }
    return all;
}

/// Grows patches one after the other.
class Patches {
 public:
    Patches(const Mesh& mesh, const std::vector<std::int32_t>& elements)
        : mesh_(mesh),
          elements_(elements),
          neighbors_(neighbors_of(mesh, elements)),
          patch_of_(elements.size(), -1),
          node_in_(mesh.x.size(), -1) {}

    std::vector<std::int32_t> make(int target) {
        for (std::size_t e = 0; e < elements_.size(); ++e) {
            if (patch_of_[e] >= 0) continue;
            size_.push_back(0);
            std::vector<std::int32_t> members;
            for (std::int32_t next = std::int32_t(e); next >= 0;) {
                take(next);
                members.push_back(next);
                next = size_.back() < target ? best_beside(members) : -1;
            }
        }
        join_small(target);
        number();
        return patch_of_;
    }

 private:
    void take(std::int32_t e) {
        patch_of_[e] = std::int32_t(size_.size()) - 1;
        ++size_.back();
        for (std::int32_t n : mesh_.corners(elements_[e])) node_in_[n] = patch_of_[e];
    }
    std::int32_t best_beside(const std::vector<std::int32_t>& members) const {
        std::int32_t best = -1;
        int most = 0;
        for (std::int32_t member : members)
            for (std::int32_t e : neighbors_[member]) {
                if (e < 0 || patch_of_[e] >= 0) continue;
                int within = 0;
                for (std::int32_t n : mesh_.corners(elements_[e]))
                    within += node_in_[n] == patch_of_[member];
                if (within > most || (within == most && e < best)) {
                    most = within;
                    best = e;
                }
            }
        return best;
    }
    /// What is left between full patches joins the smallest of them.
    void join_small(int target) {
        for (std::size_t e = 0; e < elements_.size(); ++e) {
            const std::int32_t own = patch_of_[e];
            if (2 * size_[own] > target) continue;
            std::int32_t best = -1;
            for (std::int32_t other : neighbors_[e])
                if (other >= 0 && patch_of_[other] != own &&
                    (best < 0 || size_[patch_of_[other]] < size_[best]))
                    best = patch_of_[other];
            if (best < 0) continue;
            patch_of_[e] = best;
            ++size_[best];
            --size_[own];
        }
    }
    void number() {
        std::vector<std::int32_t> numbered(size_.size(), -1);
        std::int32_t count = 0;
        for (std::int32_t& p : patch_of_) {
            if (numbered[p] < 0) numbered[p] = count++;
            p = numbered[p];
        }
    }

    const Mesh& mesh_;
    const std::vector<std::int32_t>& elements_;
    std::vector<Neighbors> neighbors_;
    std::vector<std::int32_t> patch_of_, node_in_, size_;
};

}  // namespace

std::vector<std::int32_t> make_patches(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                                       int target) {
    return Patches(mesh, elements).make(target);
}

}  // namespace undertow::fem
