#include "sph_solver/physics/pair_loops.hpp"

namespace undertow::sph {

template void sum_in<double>(const PairPhysics&, const Neighborhood&, const NoSlipImages&, Terms,
                             Particles&, ShearRate);

}  // namespace undertow::sph
