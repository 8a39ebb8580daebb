#include "wire/data_check.hpp"

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
