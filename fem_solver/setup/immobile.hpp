#pragma once
// Coupled facets that belong to no element: a rigid bed that continues the surface of the solid.

#include "fem_solver/setup/model.hpp"

namespace undertow::fem {

/// Facet sets of [[fem.surface]] with immobile = true.
std::vector<std::string> immobile_sets(const FemSettings& fem);

/// Checks the coupled surface where it has immobile facets. InputError when two facets that share
/// an edge disagree on which side is wet, when more than two meet there, or when the bed has a node
/// of its own where the solid has one (a leak).
void check_immobile(const FemSettings& fem, const Mesh& mesh);

}  // namespace undertow::fem
