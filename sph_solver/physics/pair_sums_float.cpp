// Sums over neighbors: in float here, in double next door.

#include "sph_solver/physics/pair_loops.hpp"

namespace undertow::sph {

extern template void sum_in<double>(const PairPhysics&, const Neighborhood&, const NoSlipImages&,
                                    Terms, Particles&, ShearRate);

void sum_over_neighbors(const PairPhysics& physics, const Neighborhood& neighbors,
                        const NoSlipImages& no_slip, Terms terms, Particles& particles,
                        ShearRate shear_rate) {
    if (neighbors.exact().used)
        sum_in<double>(physics, neighbors, no_slip, terms, particles, shear_rate);
    else
        sum_in<float>(physics, neighbors, no_slip, terms, particles, shear_rate);
}

}  // namespace undertow::sph
