#include "fem_solver/setup/sheet_mesh.hpp"

#include <algorithm>
#include <limits>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

const char* const axis_name[3] = {"x", "y", "z"};

/// The axis that the sheet is perpendicular to.
int flat_axis(const FemBlock& block) {
    if (!block.corners.empty())
        throw InputError("fem.block: cells = \"shells\" makes a rectangle; give its box instead of "
                         "corners, or bring a curved shell in a fem.mesh.");
    const auto& n = block.divisions;
    if (std::count(n.begin(), n.end(), 0) != 1)
        throw InputError("fem.block.divisions: cells = \"shells\" makes a sheet; give 0 along the "
                         "one axis that it is perpendicular to, for example [0, 6, 24].");
    const int flat = int(std::find(n.begin(), n.end(), 0) - n.begin());
    for (int k = 0; k < 3; ++k) {
        const double low = block.box.min[k], high = block.box.max[k];
        if (k == flat && low != high)
            throw InputError("fem.block.box: a sheet perpendicular to " +
                             std::string(axis_name[k]) + " lies at one " + axis_name[k] +
                             ", but min = " + number_text(low) + " and max = " +
                             number_text(high) + " m; give its middle surface, and the "
                             "thickness in [[fem.part]].");
        if (k != flat && !(high > low))
            throw InputError("fem.block.box: max must lie beyond min along " +
                             std::string(axis_name[k]) + ", but " + number_text(high) +
                             " <= " + number_text(low) + ".");
    }
    return flat;
}

}  // namespace

Mesh make_sheet(const FemBlock& block) {
    const int flat = flat_axis(block), first = (flat + 1) % 3, second = (flat + 2) % 3;
    const int n = block.divisions[first], m = block.divisions[second];
    if ((n + 1.0) * (m + 1.0) > std::numeric_limits<std::int32_t>::max())
        throw InputError("fem.block.divisions: the sheet has more than 2^31 nodes; use fewer.");

    Mesh mesh;
    mesh.source = "[fem.block]";
    const auto node = [&](int i, int j) { return std::int32_t(i + (n + 1) * j); };
    const auto along = [&](int axis, int i, int count) {  // exact at both ends
        const double s = double(i) / count;
        return (1 - s) * block.box.min[axis] + s * block.box.max[axis];
    };
    const std::string low[2] = {axis_name[first] + std::string("min"),
                                axis_name[second] + std::string("min")};
    const std::string high[2] = {axis_name[first] + std::string("max"),
                                 axis_name[second] + std::string("max")};
    for (int j = 0; j <= m; ++j)
        for (int i = 0; i <= n; ++i) {
            Vec3 x{};
            x[flat] = block.box.min[flat];
            x[first] = along(first, i, n);
            x[second] = along(second, j, m);
            mesh.x.push_back(x);
            if (i == 0) mesh.node_sets[low[0]].push_back(node(i, j));
            if (i == n) mesh.node_sets[high[0]].push_back(node(i, j));
            if (j == 0) mesh.node_sets[low[1]].push_back(node(i, j));
            if (j == m) mesh.node_sets[high[1]].push_back(node(i, j));
        }
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < n; ++i) {
            mesh.volume_sets["block"].push_back(std::int32_t(mesh.shells.size()));
            mesh.element_tag.push_back(std::int64_t(mesh.shells.size()) + 1);
            mesh.shells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
        }
    mesh.facet_sets["block"] = mesh.shells;
    return mesh;
}

}  // namespace undertow::fem
