#pragma once
// A start whose particles fit curved bodies: before t = 0 they are shifted until they are evenly
// spread.

#include "case/case.hpp"

namespace undertow::sph {

class FluidSystem;

struct Relaxation {
    int iterations = 0;
    double before = 0, after = 0;  // rms of dx |sum V grad W| of those that may move: 0 = even
};

/// x -= C h^2 sum_j V_j grad W_ij [Lind et al. 2012], fluid, images and dummies in the sum; the sum
/// is the acceleration under a pressure that is the same everywhere. Whoever has empty space within
/// its support (a free surface) stays. Pressures are set anew for the new places.
Relaxation relax(FluidSystem& fluid, const Case& input);

}  // namespace undertow::sph
