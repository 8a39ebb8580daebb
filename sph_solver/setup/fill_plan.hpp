#pragma once
// Which fill has which place: boxes and prisms, overlaps, bodies that fills leave free, and the weight
// that lies above a point.

#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/shapes/solid.hpp"

namespace undertow::sph {

/// Where a fill with a ramp starts: so far behind that it arrives at box and profile when it is let
/// go. A speed that rises as v (3 s^2 - 2 s^3) covers v ramp/2.   [m]
Vec3 ramp_distance(const Fill& fill);

/// Velocity at x [m] when the run begins: a block with a ramp stands still.   [m/s]
Vec3 start_velocity(const Fill& fill, const Vec3& x);

class FillPlan {
 public:
    explicit FillPlan(const Case& input);

    /// Index of the fill that has the place of x [m] at the start: of those around it the last named;
    /// -1 if there is none. y does not count in 2D.
    int owner(const Vec3& x) const;

    /// Moves a particle that lies in the skin of an obstacle or a body, nearer than `clearance` [m], half its
    /// spacing, out to that. False if its center is inside: then there is no particle. Taking centers instead of
    /// whole cells keeps the volume around a curved body right in the mean.
    bool clear_obstacles(Vec3& x, double clearance) const;

    /// Inside an obstacle or in the material of a body.
    bool in_body(const Vec3& x) const;

    /// Pressure at x under everything that lies above it in its column [Pa]. density: [kg/m3] of
    /// each fluid at zero pressure, in the order of [[sph.fluid]]; g: [m/s2] downward.
    double pressure_at(const Vec3& x, const std::vector<double>& density, double g) const;

    double spacing(int fill) const { return spacing_[fill]; }   // [m]
    int fluid(int fill) const { return fluid_[fill]; }   // index into [[sph.fluid]]

 private:
    bool contains(int fill, const Vec3& x) const;

    /// Which cells of a fill's box have their middle in its cylinder or STL file.
    struct Cells {
        int n[3] = {0, 0, 0};
        std::vector<bool> inside;   // [n], empty where the fill has no such shape
    };
    Cells cells_within(const Fill& fill, const Case& input, std::size_t k) const;

    const SphSettings& sph_;
    bool flat_;
    std::vector<Vec3> behind_;    // [m] ramp_distance of each fill
    std::vector<int> fluid_;
    std::vector<double> spacing_;  // [m] of each fill's fluid
    std::vector<Cells> within_;   // [fills]
    std::vector<Solid> obstacle_;
    std::vector<RigidBody> body_;
};

}  // namespace undertow::sph
