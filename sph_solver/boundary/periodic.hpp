#pragma once
// Periodic axes: what leaves the domain through one face comes in through the opposite one. Particles
// near a face have images by translation, beside the images by reflection of mirror_planes.hpp, which
// combines both. Particles are put back into the domain when lists are rebuilt; in between they may
// stand outside by half the skin.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow::sph {

class Periodic {
 public:
    Periodic() = default;
    /// axes: of "x", "y", "z"; their period is the extent of the domain. Throws InputError without a
    /// domain, or where a period is shorter than twice the support [m]: a particle would meet
    /// another one and its image at once.
    Periodic(const std::vector<std::string>& axes, const std::optional<Box>& domain,
             double support);

    struct Axis {
        int axis;             // 0, 1, 2
        double low, length;   // [m]
    };
    const std::vector<Axis>& axes() const { return axes_; }
    bool along(int axis) const;

    /// Puts a position [m] into the domain, low <= x < low + length.
    void wrap(double x[3]) const {
        for (const Axis& a : axes_)
            if (x[a.axis] < a.low || x[a.axis] >= a.low + a.length) {
                x[a.axis] -= a.length * std::floor((x[a.axis] - a.low) / a.length);
                // a hair below the lower face is rounded up to the upper one
                if (x[a.axis] >= a.low + a.length) x[a.axis] = a.low;
            }
    }


 private:
    std::vector<Axis> axes_;
};

/// Gravity of the case without its components along periodic axes [m/s2]: those drive the flow, and
/// no pressure gradient balances them.
Vec3 balanced_gravity(const Case& input);

}  // namespace undertow::sph
