#pragma once
// The static pressure of water, taken off the surfaces that contact presses on. Weights are
// submerged, so the structure must feel only what contact does in excess of still water.

#include <vector>

#include "fem_solver/boundary/nodal_load.hpp"
#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// p_h = rho |g| (level - z) below the level, 0 above; it pulls along the outward normal.   [Pa]
class StaticWater {
 public:
    /// Facets with outward normals; weight_density = rho |g| [N/m3], level [m] the z of p = 0.
    StaticWater(const std::vector<Quad>& facets, double weight_density, double level);

    /// f_I = int N_I p_h (x,xi cross x,eta) in the shape x: exact for bilinear facets under water.
    void evaluate(const NodeRows& x);

    NodalLoad load;

 private:
    std::vector<Quad> facets_;  // corners index load.node
    double weight_density_, level_;
};

}  // namespace undertow::fem
