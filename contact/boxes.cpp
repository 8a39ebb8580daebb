#include "contact/boxes.hpp"

#include <algorithm>
#include <numeric>

namespace undertow::contact {

namespace {

// Fewer facets are not worth a box of their own: each particle is tested against every box.
constexpr std::size_t smallest_group = 16;

struct Bounds {
    Vec low = Vec::Constant(1e300), high = Vec::Constant(-1e300);
    void add(const Vec& x) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
};

void halve(const Surface& surface, const std::vector<Vec>& center, std::span<std::uint32_t> facets,
           std::size_t largest_group, double range, std::vector<double>& boxes) {
    if (facets.size() <= largest_group) {
        Bounds bounds;
        for (std::uint32_t facet : facets)
            for (const Vec& corner : surface.shape(facet).x) bounds.add(corner);
        for (int axis = 0; axis < 3; ++axis) boxes.push_back(bounds.low[axis] - range);
        for (int axis = 0; axis < 3; ++axis) boxes.push_back(bounds.high[axis] + range);
        return;
    }
    Bounds bounds;
    for (std::uint32_t facet : facets) bounds.add(center[facet]);
    int longest = 0;
    (bounds.high - bounds.low).maxCoeff(&longest);
    const std::size_t half = facets.size() / 2;
    std::nth_element(facets.begin(), facets.begin() + half, facets.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return center[a][longest] != center[b][longest]
                                    ? center[a][longest] < center[b][longest]
                                    : a < b;
                     });
    halve(surface, center, facets.first(half), largest_group, range, boxes);
    halve(surface, center, facets.subspan(half), largest_group, range, boxes);
}

}  // namespace

std::vector<double> boxes_around(const Surface& surface, double range, std::size_t most) {
    std::vector<Vec> center(surface.facets());
    for (std::uint32_t f = 0; f < center.size(); ++f) {
        const Corners c = surface.shape(f);
        center[f] = 0.25 * (c.x[0] + c.x[1] + c.x[2] + c.x[3]);
    }
    std::vector<std::uint32_t> facets(surface.facets());
    std::iota(facets.begin(), facets.end(), 0u);
    // Halving stops at or below the limit: groups end up between half of it and all of it.
    const std::size_t largest_group = std::max(smallest_group, 2 * facets.size() / most);
    std::vector<double> boxes;
    if (!facets.empty()) halve(surface, center, facets, largest_group, range, boxes);
    return boxes;
}

}  // namespace undertow::contact
