#include "fem_solver/elements/lumps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace undertow::fem {
namespace {

struct Place {
    std::array<std::int32_t, 3> cell;  // of the center, two cells to a mean element along each axis
    std::int32_t element;
};

/// Centers in cells: those of a layer of a regular mesh get the same number, whatever round-off
/// says.
std::vector<Place> places_of(const Mesh& mesh, const std::vector<std::int32_t>& elements) {
    std::vector<Vec3> center(elements.size());
    Vec3 first, mean_extent{};
    first.fill(std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < elements.size(); ++i)
        for (int d = 0; d < 3; ++d) {
            double low = std::numeric_limits<double>::infinity(), high = -low;
            for (std::int32_t n : mesh.corners(elements[i])) {
                low = std::min(low, mesh.x[n][d]);
                high = std::max(high, mesh.x[n][d]);
            }
            center[i][d] = 0.5 * (low + high);
            first[d] = std::min(first[d], center[i][d]);
            mean_extent[d] += (high - low) / double(elements.size());
        }
    std::vector<Place> places(elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i) {
        places[i].element = elements[i];
        for (int d = 0; d < 3; ++d) {
            const double cells = 2 * (center[i][d] - first[d]) / mean_extent[d];
            // a quarter of a cell off the layers of a regular mesh; 0 where the mesh is flat
            places[i].cell[d] = mean_extent[d] > 0 ? std::int32_t(std::min(cells + 0.25, 2e9)) : 0;
        }
    }
    return places;
}

void bisect(std::vector<Place>::iterator begin, std::vector<Place>::iterator end,
            std::size_t size) {
    const std::size_t lumps = (std::size_t(end - begin) + size - 1) / size;
    if (lumps <= 1) {
        std::sort(begin, end, [](const Place& a, const Place& b) { return a.element < b.element; });
        return;
    }
    std::array<std::int32_t, 3> low = begin->cell, high = begin->cell;
    for (auto p = begin; p != end; ++p)
        for (int d = 0; d < 3; ++d) {
            low[d] = std::min(low[d], p->cell[d]);
            high[d] = std::max(high[d], p->cell[d]);
        }
    int axis = 0;
    for (int d = 1; d < 3; ++d)
        if (high[d] - low[d] > high[axis] - low[axis]) axis = d;
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const auto middle = begin + std::ptrdiff_t(lumps / 2 * size);
    std::nth_element(begin, middle, end, [=](const Place& a, const Place& b) {
        return std::tie(a.cell[axis], a.cell[next], a.cell[last], a.element) <
               std::tie(b.cell[axis], b.cell[next], b.cell[last], b.element);
    });
    bisect(begin, middle, size);
    bisect(middle, end, size);
}

}  // namespace

std::vector<std::int32_t> in_lumps(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                                   std::size_t size) {
    std::vector<Place> places = places_of(mesh, elements);
    bisect(places.begin(), places.end(), size);
    std::vector<std::int32_t> order(elements.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = places[i].element;
    return order;
}

}  // namespace undertow::fem
