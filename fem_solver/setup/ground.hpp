#pragma once
// What a scene on soil and under water says, resolved on the mesh: stress at rest, far field,
// static water.

#include <optional>
#include <vector>

#include "case/case.hpp"
#include "fem_solver/boundary/absorbing.hpp"
#include "fem_solver/boundary/static_water.hpp"
#include "fem_solver/elements/part.hpp"

namespace undertow::fem {

struct InitialStress {
    std::int32_t element = 0;
    Symmetric<double> stress{};  // [Pa]
};

/// sigma_v = -rho_w |g| (surface - z) at each element's center, sigma_h = K0 sigma_v, rho_w the
/// density that weighs. InputError when gravity is not along -z, an element lies above the surface,
/// or its strength cannot bear the difference of the two.
std::vector<InitialStress> geostatic_stress(const Case& c, const Mesh& mesh,
                                            const std::vector<Part>& parts);

/// Facets of [[fem.absorbing]], each once, with the impedances of the material behind them.
AbsorbingBoundary make_far_field(const FemSettings& fem, const Mesh& mesh,
                                 const std::vector<Part>& parts);

/// Facets of the coupled surfaces that are not immobile, under the water of [fem.water]; nothing
/// without it. InputError when gravity is not along -z.
std::optional<StaticWater> make_static_water(const Case& c, const Mesh& mesh);

}  // namespace undertow::fem
