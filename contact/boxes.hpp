#pragma once
// A few boxes around the surface: a particle outside all of them is out of range of every facet.

#include <span>
#include <vector>

#include "contact/surface.hpp"

namespace undertow::contact {

/// (B, 6) xmin ymin zmin xmax ymax zmax [m]: bounding boxes of groups of neighboring facets, each
/// widened by `range` [m] (needs positions only, no velocities). At most `most` boxes: halved along
/// their longest side until small.
std::vector<double> boxes_around(const Surface& surface, double range, std::size_t most = 64);

}  // namespace undertow::contact
