#include "fem_solver/setup/immobile.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

struct Side {
    std::string set;
    bool rising;  // the facet walks the edge from the lower to the higher node
};

using Edge = std::pair<std::int32_t, std::int32_t>;

void check_edges(const FemSettings& fem, const Mesh& mesh) {
    std::map<Edge, std::vector<Side>> edges;
    for (const FemSurface& surface : fem.surface)
        for (const Quad& q : mesh.facets_of(surface.set, "fem.surface"))
            for (int k = 0; k < 4; ++k) {
                const std::int32_t a = q[k], b = q[(k + 1) % 4];
                if (a != b) edges[{std::min(a, b), std::max(a, b)}].push_back({surface.set, a < b});
            }
    for (const auto& [edge, sides] : edges) {
        if (sides.size() < 2) continue;
        const std::string where = " share the edge from " + point_text(mesh.x[edge.first]) +
                                  " to " + point_text(mesh.x[edge.second]);
        if (sides.size() > 2)
            throw InputError("fem.surface: " + std::to_string(sides.size()) + " facets (of \"" +
                             sides[0].set + "\", \"" + sides[1].set + "\", \"" + sides[2].set +
                             "\")" + where + "; a coupled surface has at most two there.");
        if (sides[0].rising == sides[1].rising)
            throw InputError("fem.surface: facets of \"" + sides[0].set + "\" and \"" +
                             sides[1].set + "\"" + where +
                             " and look to different sides of it; turn the immobile set round in "
                             "the mesh (Gmsh: Reverse Surface), so that its normals point into "
                             "the water.");
    }
}

/// Twin nodes: one of the bed, one of the solid, at the same place.
void check_twins(const FemSettings& fem, const Mesh& mesh) {
    std::vector<bool> of_bed(mesh.x.size(), false), of_solid(mesh.x.size(), false);
    for (std::size_t e = 0; e < mesh.n_elements(); ++e)
        for (std::int32_t n : mesh.corners(e)) of_solid[n] = true;
    Vec3 low = mesh.x.front(), high = low;
    for (const Vec3& x : mesh.x)
        for (int d = 0; d < 3; ++d) {
            low[d] = std::min(low[d], x[d]);
            high[d] = std::max(high[d], x[d]);
        }
    // nodes nearer than this are one point to any mesh generator
    const double same =
        1e-7 * std::sqrt(std::pow(high[0] - low[0], 2) + std::pow(high[1] - low[1], 2) +
                         std::pow(high[2] - low[2], 2));
    for (const FemSurface& surface : fem.surface)
        if (surface.immobile)
            for (std::int32_t n : mesh.nodes_of(surface.set, "fem.surface"))
                of_bed[n] = !of_solid[n];
    std::vector<std::pair<double, std::int32_t>> by_x;
    for (std::size_t n = 0; n < mesh.x.size(); ++n)
        by_x.emplace_back(mesh.x[n][0], std::int32_t(n));
    std::sort(by_x.begin(), by_x.end());
    for (std::size_t i = 0; i < by_x.size(); ++i) {
        if (!of_bed[by_x[i].second]) continue;
        const Vec3& a = mesh.x[by_x[i].second];
        const auto is_twin = [&](std::int32_t n) {
            return of_solid[n] && std::abs(mesh.x[n][1] - a[1]) < same &&
                   std::abs(mesh.x[n][2] - a[2]) < same;
        };
        bool twin = false;
        for (std::size_t j = i; j-- > 0 && by_x[i].first - by_x[j].first < same;)
            twin |= is_twin(by_x[j].second);
        for (std::size_t j = i + 1; j < by_x.size() && by_x[j].first - by_x[i].first < same; ++j)
            twin |= is_twin(by_x[j].second);
        if (twin)
            throw InputError("fem.surface: at " + point_text(a) +
                             " the immobile bed and the solid have a node each, which would leave "
                             "a leak between them; let them share it (Gmsh: Coherence).");
    }
}

}  // namespace

std::vector<std::string> immobile_sets(const FemSettings& fem) {
    std::vector<std::string> sets;
    for (const FemSurface& surface : fem.surface)
        if (surface.immobile) sets.push_back(surface.set);
    return sets;
}

void check_immobile(const FemSettings& fem, const Mesh& mesh) {
    if (immobile_sets(fem).empty()) return;
    check_edges(fem, mesh);
    check_twins(fem, mesh);
}

}  // namespace undertow::fem
