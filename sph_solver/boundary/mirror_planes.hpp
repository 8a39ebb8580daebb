#pragma once
// Plane rigid walls by mirror images: a particle near a wall sees its neighbors' images behind it, so
// that the kernel is complete there and the impermeable, free-slip wall is met exactly. An image costs
// a record, not a pair loop of its own. Corners need images of images: planes must be perpendicular
// or parallel to each other.

#include <array>
#include <cstdint>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/periodic.hpp"

namespace undertow::sph {

/// Bit k: mirrored at plane k. Above the planes two bits per periodic axis: moved by one period up, or
/// down. A normal has no component along a periodic axis, so the two kinds commute.
using PlaneMask = std::uint32_t;

/// x' = M x + t, v' = M v: no flow through the wall. The friction of a no-slip wall is added as a
/// stress (wall_friction.hpp): a reversed tangential velocity would disturb the continuity sum.
struct Reflection {
    double m[3][3], t[3];   // [-], [m]
};

/// Reflections at axis-parallel planes and translations in fixed-point coordinates: X' = sign X + offset, v' = sign v.
struct FixedReflection {
    bool diagonal = false;             // false: some plane is slanted, use Reflection
    std::int32_t sign[3] = {1, 1, 1};
    std::int32_t offset[3] = {0, 0, 0};   // [unit]
};

class MirrorPlanes {
 public:
    /// Throws InputError when two planes are neither parallel nor perpendicular, or one is not along
    /// the periodic axes.
    explicit MirrorPlanes(const std::vector<PlaneWall>& planes, const Periodic& periodic = {});

    int size() const { return static_cast<int>(planes_.size()); }
    const PlaneWall& plane(int k) const { return planes_[k]; }
    const Periodic& periodic() const { return periodic_; }

    /// Signed distance from plane k, positive on the fluid's side [m].
    double distance(int k, double x, double y, double z) const {
        const PlaneWall& w = planes_[k];
        return (x - w.point[0]) * w.normal[0] + (y - w.point[1]) * w.normal[1] +
               (z - w.point[2]) * w.normal[2];
    }

    bool behind(double x, double y, double z) const {
        for (int k = 0; k < size(); ++k)
            if (distance(k, x, y, z) < 0) return true;
        return false;
    }

    /// Appends the masks of all images of a point that lie within `range` behind their walls, or
    /// beyond a face of a periodic axis.
    void images_of(double x, double y, double z, double range, std::vector<PlaneMask>& masks) const;

    const Reflection& reflection(PlaneMask mask) const { return table_[mask]; }

    /// The table of reflections for positions stored as (x - origin)/unit, [masks].
    void to_fixed(const double origin[3], double unit, std::vector<FixedReflection>& table) const;

    /// A particle that got behind a wall is put back to its mirror position with its normal velocity
    /// reversed. Returns true if it was behind any wall.
    bool put_back(double& x, double& y, double& z, double& vx, double& vy, double& vz) const;

 private:
    std::vector<PlaneWall> planes_;
    Periodic periodic_;
    std::vector<Reflection> table_;   // [masks] = [2^(planes + 2 periodic axes)]
};

}  // namespace undertow::sph
