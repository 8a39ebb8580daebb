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

    /// What contact presses on the nodes at rest differs from p_h: a fluid of particles bears
    /// unevenly on facets of their own size. observe() adds up the difference while all stands still
    /// (contact [N] on the nodes `node`, increasing; dt [s]), balance() takes its mean into the
    /// static load, so that the structure is let go without a jump.
    void observe(const NodalLoad& contact, double dt);
    void balance(const NodeRows& inverse_mass);

    struct Difference {  // of the nodes that move by themselves: the soil's
        double net = 0;    // of the sum of all nodal forces, over that of p_h
        double nodal = 0;  // root mean square of a node, over that of p_h
    };
    const Difference& difference() const { return difference_; }
    void archive(Archive& a);

    NodalLoad load;

 private:
    std::vector<Quad> facets_;  // corners index load.node
    double weight_density_, level_;
    std::vector<std::int32_t> at_;  // of load.node in the list of the contact forces
    NodeRows sum_, constant_;       // [N s], [N]
    double observed_ = 0;           // [s]
    Difference difference_;
};

}  // namespace undertow::fem
