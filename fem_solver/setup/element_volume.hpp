#pragma once

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// [m3] of an element of the undeformed mesh; of a shell its area times `thickness` [m].
double element_volume(const Mesh& mesh, std::int32_t element, double thickness);

}  // namespace undertow::fem
