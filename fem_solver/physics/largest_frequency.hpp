#pragma once
// The largest eigenfrequency of the assembled and supported mesh, for a stable step that wastes
// nothing: the element bound is up to a third too careful.

#include "fem_solver/elements/element_groups.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

struct LargestFrequency {
    double omega = 0;    // [1/s] from below; within 0.1 % when converged
    int iterations = 0;  // force evaluations spent
    bool converged = false;
};

/// Lanczos iteration on M^-1/2 K M^-1/2 in the present shape, K from the elements' tangent forces.
LargestFrequency find_largest_frequency(const Elements& elements, const Nodes& nodes);

}  // namespace undertow::fem
