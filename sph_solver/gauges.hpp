#pragma once
// Point gauges: where the front is, how high the water stands, what the pressure is.

#include "case/case.hpp"
#include "sph_solver/fluid_system.hpp"

namespace undertow::sph {

/// Furthest point of the fluid along `direction` [m]: the foremost particle that has at least one
/// other particle within its support, plus half a spacing.
double front_position(const FluidSystem& fluid, const Vec3& direction);

/// sum V W and the Shepard mean of the pressure at a point.
struct PointValue {
    double filled;   // 0 outside the fluid, about 1 inside
    double p;        // [Pa], 0 where there is no fluid
};
PointValue interpolate(const FluidSystem& fluid, const Vec3& point);

/// Height of the free surface above the column (x, y) [m]: the highest z with sum V W >= 1/2; the
/// lowest particle's floor (-infinity is never returned: 0 filled gives z_min) when it is dry.
double water_level(const FluidSystem& fluid, double x, double y);

}  // namespace undertow::sph
