#pragma once
// What the elements of a part have in common.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "fem_solver/materials/material.hpp"

namespace undertow::fem {

/// One [[fem.part]] with its material.
struct Part {
    std::string name;                    // its volume set
    std::vector<std::int32_t> elements;  // of the mesh
    double density = 0;                  // [kg/m3]
    Material material;
    std::optional<double> weight_density{};  // [kg/m3] that gravity acts on; none = density
    ElementFormulation element = ElementFormulation::automatic;
    double thickness = 0;   // [m] of shells
    bool implicit = false;  // limits no step, see fem_solver/implicit
};

struct BulkViscosity {
    double linear = 0.06;    // b1: damps the ringing of the highest modes
    double quadratic = 1.2;  // b2: smears a shock over a few elements
};

}  // namespace undertow::fem
