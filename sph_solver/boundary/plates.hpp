#pragma once
// Rigid plates (gates, blocks) as dummy particles on a lattice, at rest or moving. A dummy carries the
// pressure of the fluid next to it, extrapolated along gravity.

#include <cstdint>
#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow::sph {

struct Plates {
    std::vector<double> x, y, z;             // position now [m], [dummies]
    std::vector<double> x0, y0, z0;          // position at rest [m], [dummies]
    std::vector<double> vx, vy, vz;          // what the pair loop sees [m/s], [dummies]
    std::vector<double> p;                   // extrapolated pressure [Pa], [dummies]
    std::vector<float> viscosity;            // of the fluid next to it [Pa s], [dummies]
    std::vector<std::uint8_t> fluid;         // the fluid that is most of what is near, [dummies]
    std::vector<int> plate;                  // owner, [dummies]
    std::vector<PlateWall> walls;

    int size() const { return static_cast<int>(x.size()); }

    /// Velocity of plate k at time t [m/s].
    Vec3 velocity(int k, double t) const;
    /// Moves all dummies to time t.
    void move_to(double t);
    /// Index of the axis along which plate k is thinnest: its faces' normal.
    int thin_axis(int k) const;
};

/// Fills each plate with dummies at the given spacing; the layers start half a spacing inside the
/// faces, so that fluid cells and dummy cells share a regular lattice. In 2D one layer in y.
Plates make_plates(const std::vector<PlateWall>& walls, double spacing, int dimension);

}  // namespace undertow::sph
