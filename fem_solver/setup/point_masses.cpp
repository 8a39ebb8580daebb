#include "fem_solver/setup/point_masses.hpp"

#include <algorithm>
#include <string>

#include "fem_solver/setup/model.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {

std::vector<PointMass> make_point_masses(const Case& c, const Mesh& mesh,
                                         const std::vector<RigidSet>& bodies) {
    std::vector<PointMass> masses;
    if (c.fem.mass.empty()) return masses;
    std::vector<bool> has_element(mesh.x.size(), false);
    for (std::size_t e = 0; e < mesh.n_elements(); ++e)
        for (std::int32_t n : mesh.corners(e)) has_element[n] = true;
    for (const FemMass& m : c.fem.mass) {
        PointMass mass{m.set.empty() ? std::vector<std::int32_t>{nearest_node(mesh, m.point)}
                                     : mesh.nodes_of(m.set, "fem.mass"),
                       m.mass};
        const std::string name =
            "fem.mass " + (m.set.empty() ? "at " + point_text(m.point) : "\"" + m.set + "\"");
        if (mass.nodes.empty()) throw InputError(name + ": the set has no nodes.");
        for (std::int32_t n : mass.nodes) {
            if (!has_element[n])
                throw InputError(name + ": the node at " + point_text(mesh.x[n]) +
                                 " belongs to no element (it is of an immobile surface); name "
                                 "nodes of the structure.");
            for (const RigidSet& body : bodies)
                if (std::binary_search(body.nodes.begin(), body.nodes.end(), n))
                    throw InputError(name + ": the node at " + point_text(mesh.x[n]) +
                                     " belongs to the rigid body \"" + body.name +
                                     "\"; give that body its added_mass and added_at instead.");
        }
        masses.push_back(std::move(mass));
    }
    return masses;
}

void add_point_masses(const std::vector<PointMass>& masses, std::vector<double>& mass) {
    for (const PointMass& m : masses)
        for (std::int32_t n : m.nodes) mass[n] += m.mass / double(m.nodes.size());
}

}  // namespace undertow::fem
