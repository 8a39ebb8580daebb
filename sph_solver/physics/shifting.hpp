#pragma once
// Particle shifting: a small extra drift from where particles are many to where they are few, which
// keeps them evenly spread.

#include <vector>

#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// Found anew when the lists are rebuilt, constant until the next time: a particle moves a fraction of
/// the spacing meanwhile. Arrays are padded to full clusters.
struct Shift {
    std::vector<float> ux, uy, uz;   // drift beyond the velocity [m/s], [n]
    std::vector<float> rate;         // u . grad rho [kg/m3/s], [n]
    double fastest = 0;              // largest |u| [m/s]

    bool empty() const { return ux.empty(); }
    void resize(std::size_t n) {
        for (auto* a : {&ux, &uy, &uz, &rate}) a->resize(n);
    }
};

/// u_i = -K 2h U sum_j V_j grad W_ij, U the largest speed   [m/s]   [Sun et al. 2017, Eq. 13 over dt;
/// their strength is K = 2]
/// at most U/5; without its part along the normal at the free surface and near it [Sun et al. 2018]; zero
/// for particles with less than half their neighbors and for those that see another fluid. The density
/// of the place goes with it, d(rho)/dt += u . grad rho. Velocities stay: momentum is conserved to the
/// last bit, angular momentum is not. Reads the packed records and Neighborhood::depth.
void find_shift(const PairPhysics& physics, const Neighborhood& neighbors, double largest_speed,
                Shift& shift);

}  // namespace undertow::sph
