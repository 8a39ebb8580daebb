#pragma once
// Finds the equilibrium of a structure under its own loads, before the first step.

#include <cstdint>
#include <string>
#include <vector>

#include "fem_solver/structure.hpp"

namespace undertow::fem {

/// How the structure settled.
struct Settlement {
    bool complete = false;  // false: the user ended it
    std::int64_t steps = 0;
    int stops = 0;                    // times that all motion was ended at a peak of kinetic energy
    double residual = 0;              // [N] largest component of force left at a node
    double reference = 0;             // [N] mean weight of a node, which tolerance refers to
    double body_residual = 0;         // [-] left on a rigid body, over its weight
    double largest_displacement = 0;  // [m] of a node
    std::vector<Vec3> body_displacement;  // [m] of each rigid body's center
    double wall = 0;                      // [s]

    void archive(Archive& a);
};

/// Explicit steps in which all motion is ended at each peak of the kinetic energy (kinetic
/// damping, Cundall 1976), until no force on a free node exceeds settings.tolerance times the mean
/// weight of a node and no resultant on a rigid body exceeds that share of its weight (moments:
/// times its reach). Without weight the largest force of the start is the reference. Afterwards
/// everything is at rest and displacements, energies and body forces count from there.
/// PhysicsError that says how far it came when settings.max_steps are not enough.
Settlement settle(Structure& structure, const FemSettle& settings);

}  // namespace undertow::fem
