#include "fem_solver/setup/initial_velocities.hpp"

#include <algorithm>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

std::string name_of(const FemInitialVelocity& given) {
    return "fem.initial_velocity of \"" + (given.rigid.empty() ? given.set : given.rigid) + "\"";
}

/// v + spin x (x - center)   [m/s]
Vec3 velocity_at(const FemInitialVelocity& given, const Vec3& x, const Vec3& center) {
    Vec3 v = given.velocity;
    for (std::size_t d = 0; d < given.formulas.size(); ++d)
        v[d] = given.formulas[d](x[0], x[1], x[2]);
    for (int d = 0; d < 3; ++d) {
        const int d1 = (d + 1) % 3, d2 = (d + 2) % 3;
        v[d] += given.spin[d1] * (x[d2] - center[d2]) - given.spin[d2] * (x[d1] - center[d1]);
    }
    return v;
}

Vec3 center_of_mass(const RigidSet& body, const Mesh& mesh) {
    double mass = body.added_mass;
    Vec3 moment;
    for (int d = 0; d < 3; ++d) moment[d] = body.added_mass * body.added_at[d];
    for (std::size_t i = 0; i < body.nodes.size(); ++i) {
        mass += body.mass[i];
        for (int d = 0; d < 3; ++d) moment[d] += body.mass[i] * mesh.x[body.nodes[i]][d];
    }
    for (double& component : moment) component /= mass;
    return moment;
}

void add_nodes(const FemInitialVelocity& given, const Mesh& mesh,
               const std::vector<std::uint8_t>& kind, std::vector<int>& index,
               InitialVelocities& all) {
    for (const std::int32_t n : mesh.nodes_of(given.set, "fem.initial_velocity")) {
        const std::string at = name_of(given) + ": its node at " + point_text(mesh.x[n]);
        if (kind[n] == 2)
            throw InputError(at + " belongs to a rigid body; name the body, by rigid.");
        if (kind[n] == 0)
            throw InputError(at + " belongs to no element; immobile facets cannot move.");
        const InitialVelocities::OfNode one{n, velocity_at(given, mesh.x[n], given.center),
                                            given.spin};
        if (index[n] >= 0) {
            const InitialVelocities::OfNode& other = all.nodes[index[n]];
            if (other.velocity == one.velocity && other.spin == one.spin) continue;
            throw InputError(
                at +
                " is given another velocity by another fem.initial_velocity; let their "
                "sets share no node, or be one.");
        }
        index[n] = int(all.nodes.size());
        all.nodes.push_back(one);
    }
}

}  // namespace

InitialVelocities make_initial_velocities(const Case& c, const Mesh& mesh,
                                          const std::vector<RigidSet>& bodies) {
    InitialVelocities all;
    if (c.fem.initial_velocity.empty()) return all;
    if (c.start.settle > 0)
        throw InputError("fem.initial_velocity: start.settle = " + number_text(c.start.settle) +
                         " s holds the structure at first; leave one of the two out.");
    std::vector<std::uint8_t> kind(mesh.x.size(), 0);  // 1: of an element, 2: of a rigid body
    for (std::size_t e = 0; e < mesh.n_elements(); ++e)
        for (std::int32_t n : mesh.corners(e)) kind[n] = 1;
    for (const RigidSet& body : bodies)
        for (std::int32_t n : body.nodes) kind[n] = 2;
    std::vector<int> index(mesh.x.size(), -1);
    for (const FemInitialVelocity& given : c.fem.initial_velocity) {
        if (given.rigid.empty()) {
            add_nodes(given, mesh, kind, index, all);
            continue;
        }
        const auto body = std::find_if(bodies.begin(), bodies.end(),
                                       [&](const RigidSet& b) { return b.name == given.rigid; });
        const Vec3 center = center_of_mass(*body, mesh);
        all.bodies.push_back({int(body - bodies.begin()),
                              velocity_at(given, center, given.has_center ? given.center : center),
                              given.spin});
    }
    return all;
}

}  // namespace undertow::fem
