#pragma once
// Mass scaling, by request alone: elements that are heavier than their material, so that they allow
// a longer step. Weight stays that of the material.

#include <string>
#include <vector>

#include "fem_solver/elements/part.hpp"
#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// What it did to a part.
struct ScaledPart {
    std::string part;
    double mass = 0;           // [kg] of the material, of all its elements
    double added = 0;          // [kg] of inertia
    std::size_t elements = 0;  // that are heavier
};

/// Applies fem.part's mass_factor and fem.mass_scaling to `parts`, which are without the elements
/// of rigid bodies; elements that fem.mass_scaling makes heavier move to parts of the same name,
/// the factors of the mass rounded up to powers of 1.1. InputError where it has no effect.
std::vector<ScaledPart> scale_masses(const Case& c, const Mesh& mesh, std::vector<Part>& parts,
                                     const BulkViscosity& viscosity);

}  // namespace undertow::fem
