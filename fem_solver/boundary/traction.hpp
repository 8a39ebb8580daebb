#pragma once
// A force on facets that keeps its direction and size, however they deform: the load of a test
// machine or of a textbook.

#include "fem_solver/boundary/nodal_load.hpp"
#include "fem_solver/mesh.hpp"

namespace undertow::fem {

class TractionLoad {
 public:
    /// value [Pa] over the facets' area in the shape x [m]; rises within `ramp` [s].
    TractionLoad(const std::vector<Quad>& facets, const std::vector<Vec3>& x, const Vec3& value,
                 double ramp);

    void evaluate(double t);

    NodalLoad load;  // [N]

 private:
    NodeRows full_;  // [N] after the ramp, per node of the load
    double ramp_;    // [s]
};

}  // namespace undertow::fem
