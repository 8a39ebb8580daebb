#pragma once
// [[fem.mass]]: masses on nodes, in inertia, weight, energies and the stable step alike.

#include <vector>

#include "fem_solver/mesh.hpp"
#include "fem_solver/rigid/rigid_set.hpp"

namespace undertow::fem {

struct PointMass {
    std::vector<std::int32_t> nodes;  // of the mesh, increasing
    double mass = 0;                  // [kg] in all, shared alike
};

/// InputError for unknown sets, and for nodes without elements or of rigid bodies.
std::vector<PointMass> make_point_masses(const Case& c, const Mesh& mesh,
                                         const std::vector<RigidSet>& bodies);

/// [kg] adds the masses to those of their nodes.
void add_point_masses(const std::vector<PointMass>& masses, std::vector<double>& mass);

}  // namespace undertow::fem
