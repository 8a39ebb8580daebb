#include "wire/data_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::wire {

namespace {

void check_particles(const Mesh& mesh) {
    if (!(mesh.radius > 0)) {
        throw PeerError("E_NONFINITE", "mesh " + mesh.mesh + ": the contact radius r = " +
                                           number_text(mesh.radius) + " m must be > 0");
    }
    if (!mesh.x.empty() || !mesh.quad.empty()) {
        throw PeerError("E_MESH", "mesh " + mesh.mesh +
                                      ": particles announce no nodes and no facets; their places "
                                      "come with PROBE and STATE");
    }
}

/// Twice the area of a facet, and its longest edge squared.  [m^2]
std::array<double, 2> extent_of(const Mesh& mesh, std::size_t facet) {
    const auto corner = [&](int k) { return &mesh.x[3 * std::size_t(mesh.quad[4 * facet + k])]; };
    double diagonal[2][3], longest2 = 0;
    for (int k = 0; k < 4; ++k) {
        double edge2 = 0;
        for (int d = 0; d < 3; ++d) edge2 += std::pow(corner((k + 1) % 4)[d] - corner(k)[d], 2);
        longest2 = std::max(longest2, edge2);
    }
    for (int d = 0; d < 3; ++d) {
        diagonal[0][d] = corner(2)[d] - corner(0)[d];
        diagonal[1][d] = corner(3)[d] - corner(1)[d];
    }
    const auto& [p, q] = diagonal;
    return {
        std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]),
        longest2};
}

/// A facet without area has no normal: particles would pass it or get NaN.
void check_areas(const Mesh& mesh) {
    constexpr double flat = 1e-9;  // of the square of the longest edge
    for (std::size_t facet = 0; facet < mesh.group.size(); ++facet) {
        const auto [area, edge2] = extent_of(mesh, facet);
        if (area > flat * edge2) continue;
        throw PeerError("E_MESH", "mesh " + mesh.mesh + ": facet " + std::to_string(facet) +
                                      " is degenerate: its area is " + number_text(0.5 * area) +
                                      " m2, its longest edge " + number_text(std::sqrt(edge2)) +
                                      " m");
    }
}

/// Neighbors pass their common edge in opposite directions, or one of the two shows its back to the
/// particles. Edges of one facet or of more than two (where shells meet) say nothing.
void check_orientation(const Mesh& mesh) {
    struct Edge {
        std::int32_t low, high;
        bool rising;
        std::size_t facet;
    };
    std::vector<Edge> edges;
    edges.reserve(mesh.quad.size());
    for (std::size_t i = 0; i < mesh.quad.size(); ++i) {
        const std::int32_t a = mesh.quad[i], b = mesh.quad[i % 4 == 3 ? i - 3 : i + 1];
        if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b, i / 4});
    }
    const auto same = [](const Edge& e, const Edge& f) {
        return e.low == f.low && e.high == f.high;
    };
    std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
        return std::array<std::int64_t, 3>{e.low, e.high, std::int64_t(e.facet)} <
               std::array<std::int64_t, 3>{f.low, f.high, std::int64_t(f.facet)};
    });
    for (std::size_t i = 0, next; i < edges.size(); i = next) {
        for (next = i + 1; next < edges.size() && same(edges[i], edges[next]);) ++next;
        if (next != i + 2 || edges[i].rising != edges[i + 1].rising) continue;
        throw PeerError(
            "E_MESH", "mesh " + mesh.mesh + ": facets " + std::to_string(edges[i].facet) + " and " +
                          std::to_string(edges[i + 1].facet) + " share the edge of nodes " +
                          std::to_string(edges[i].low) + " and " + std::to_string(edges[i].high) +
                          " in the same direction: one of them is inverted; order the nodes of "
                          "both counter-clockwise seen from the particles' side");
    }
}

void check_surface(const Mesh& mesh) {
    const std::size_t n_nodes = mesh.mass.size();
    const std::size_t n_facets = mesh.group.size();
    if (n_nodes == 0 || n_facets == 0) {
        throw PeerError("E_MESH", "mesh " + mesh.mesh + " has " + std::to_string(n_nodes) +
                                      " nodes and " + std::to_string(n_facets) +
                                      " facets; a surface needs both");
    }
    for (std::size_t a = 0; a < n_nodes; ++a) {
        if (mesh.mass[a] > 0) continue;
        throw PeerError("E_NONFINITE", "mesh " + mesh.mesh + ": the mass of node " +
                                           std::to_string(a) + " is " + number_text(mesh.mass[a]) +
                                           " kg; it must be > 0");
    }
    for (std::size_t i = 0; i < mesh.quad.size(); ++i) {
        if (mesh.quad[i] >= 0 && static_cast<std::size_t>(mesh.quad[i]) < n_nodes) continue;
        throw PeerError("E_MESH", "mesh " + mesh.mesh + ": facet " + std::to_string(i / 4) +
                                      " names node " + std::to_string(mesh.quad[i]) +
                                      ", but there are " + std::to_string(n_nodes));
    }
    for (std::size_t facet = 0; facet < n_facets; ++facet) {
        const std::int32_t group = mesh.group[facet];
        if (group >= 0 && static_cast<std::size_t>(group) < mesh.groups.size()) continue;
        throw PeerError("E_MESH", "mesh " + mesh.mesh + ": facet " + std::to_string(facet) +
                                      " belongs to group " + std::to_string(group) +
                                      ", but there are " + std::to_string(mesh.groups.size()));
    }
    check_areas(mesh);
    check_orientation(mesh);
}

}  // namespace

void check_mesh(const Mesh& mesh, const std::string& role) {
    if (mesh.kind != role) {
        throw PeerError("E_MESH", "mesh " + mesh.mesh + " is of kind '" + mesh.kind +
                                      "', but the participant's role is '" + role + "'");
    }
    if (mesh.revision != 0) {
        throw PeerError("E_MESH", "mesh " + mesh.mesh + " has revision " +
                                      std::to_string(mesh.revision) +
                                      "; this version takes revision 0 only");
    }
    if (mesh.thickness < 0) {
        throw PeerError("E_MESH", "mesh " + mesh.mesh + ": the thickness " +
                                      number_text(mesh.thickness) + " m must be >= 0");
    }
    if (role == "particles")
        check_particles(mesh);
    else
        check_surface(mesh);
}

void check_probe(const Probe& probe, const Mesh& mesh) {
    const double largest_radius = mesh.radius * (1 + 1e-9);  // both may be rounded differently
    for (std::size_t i = 0; i < probe.id.size(); ++i) {
        const auto refuse = [&](const char* code, const std::string& what) {
            throw PeerError(code, "PROBE(" + std::to_string(probe.n) + "): particle " +
                                      std::to_string(probe.id[i]) + " has the " + what);
        };
        if (!(probe.mass[i] > 0))
            refuse("E_NONFINITE", "mass " + number_text(probe.mass[i]) + " kg");
        if (!(probe.radius[i] > 0))
            refuse("E_NONFINITE", "radius " + number_text(probe.radius[i]) + " m");
        if (!(probe.stiffness[i] >= 0)) {
            refuse("E_NONFINITE", "stiffness " + number_text(probe.stiffness[i]) + " N/m");
        }
        if (probe.radius[i] > largest_radius) {
            refuse("E_MESH", "radius " + number_text(probe.radius[i]) +
                                 " m; MESH announced at most " + number_text(mesh.radius));
        }
        if (probe.phase[i] >= mesh.groups.size()) {
            refuse("E_MESH", "phase " + std::to_string(probe.phase[i]) + "; MESH announced " +
                                 std::to_string(mesh.groups.size()) + " groups");
        }
    }
}

}  // namespace undertow::wire
