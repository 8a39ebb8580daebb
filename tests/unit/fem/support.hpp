#pragma once
// Small models for the tests, built the way a case file builds them.

#include <array>
#include <functional>

#include "fem_solver/structure.hpp"

namespace undertow::fem {

struct BlockCase {
    Vec3 size{1, 1, 1};  // [m]
    std::array<int, 3> divisions{1, 1, 1};
    double young_modulus = 1e9;  // [Pa]
    double poisson_ratio = 0.3;
    double density = 1000;  // [kg/m3]
    ElementFormulation element = ElementFormulation::automatic;
    BlockCells cells = BlockCells::hexahedra;

    /// An [fem] table with one part, no viscosity, no loads, no weight.
    Case settings() const;
    Part part(const Mesh& mesh) const;
};

/// Moves the inner nodes of a block by up to `amount` of an element's edges, the same way each
/// time.
void distort(Mesh& mesh, const BlockCase& block, double amount);

/// Takes `steps` steps of `dt`; `each(n)` runs after the kick of step n.
void march(
    Structure& structure, double dt, int steps, const std::function<void(int)>& each = [](int) {});

/// All free nodes set moving, each direction on its own, by up to 1e-3 m/s; then steps at the step
/// that the structure offers. [J] what moves and is stored, springs of contact included: the
/// largest of the first hundredth of the march (after 100 steps) and of its last. Energy that grows
/// is what an unstable spring makes.
struct ShakenEnergy {
    double early = 0, late = 0;
};
ShakenEnergy march_shaken(Structure& structure, int steps);

/// First root of 1 + cos x cosh x: the clamped-free beam.
inline constexpr double first_cantilever_root = 1.8751040687119611;

}  // namespace undertow::fem
