#pragma once
// How a rigid body moves: by a constant velocity, by formulas, or by a table.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "case/motion_table.hpp"

namespace undertow::sph {

/// Where a body is and how it moves. Turns are about `center`, which moves along.
struct Pose {
    Vec3 shift{};  // from the place at rest [m]
    double turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    bool turned = false;              // false: `turn` is exactly one
    Vec3 velocity{}, acceleration{};  // of the center [m/s], [m/s2]
    Vec3 spin{}, spin_rate{};         // [rad/s], [rad/s2]
    Vec3 center{};                    // at rest [m]

    Vec3 to_space(const Vec3& at_rest) const;
    Vec3 to_rest(const Vec3& x) const;
    /// A direction given at rest.
    Vec3 direction(const Vec3& at_rest) const;
    Vec3 direction_at_rest(const Vec3& now) const;
    /// Of the body's point at x [m], and its acceleration, centripetal part included.
    Vec3 velocity_at(const Vec3& x) const;
    Vec3 acceleration_at(const Vec3& x) const;
};

class RigidMotion {
 public:
    RigidMotion(const Body& body, const Case& input);

    Pose operator()(double t) const;
    bool moves() const { return moves_; }

 private:
    Body law_;
    std::optional<MotionTable> table_;
    double step_;  // [s] of the differences that give a formula's rates
    bool moves_;
};

}  // namespace undertow::sph
