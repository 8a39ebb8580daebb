#pragma once
// Pressure that follows the deforming facets.

#include <string>
#include <vector>

#include "fem_solver/boundary/nodal_load.hpp"
#include "fem_solver/mesh.hpp"

namespace undertow::fem {

class PressureLoad {
 public:
    /// Facets with outward normals; value [Pa] pushes against them, ramp [s] of the smooth rise.
    PressureLoad(const std::vector<Quad>& facets, double value, double ramp);

    /// Forces at time t in the shape x. They are consistent with the bilinear facet (the derivative
    /// of the enclosed volume), so that a uniform pressure meets a uniform stress exactly.
    void evaluate(double t, const NodeRows& x);
    double pressure(double t) const;  // [Pa]

    NodalLoad load;

 private:
    std::vector<Quad> facets_;  // corners index load.node
    double value_, ramp_;
};

}  // namespace undertow::fem
