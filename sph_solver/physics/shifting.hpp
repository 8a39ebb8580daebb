#pragma once
// Particle shifting: a small extra drift from where particles are many to where they are few, which
// keeps them evenly spread.

#include <vector>

#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// Found anew when the lists are rebuilt, constant until the next time: a particle moves a fraction
/// of the spacing meanwhile. Arrays are padded to full clusters.
struct Shift {
    std::vector<double> ux, uy, uz;  // drift beyond the velocity [m/s], [n]
    std::vector<double> rate;        // u . grad rho [kg/m3/s], [n]
    double fastest = 0;             // largest |u| [m/s]

    bool empty() const { return ux.empty(); }
    /// x += dt u.
    void move(double dt, Particles& particles) const;
    /// d(rho)/dt += u . grad rho: the density is that of the place.
    void carry_density(Particles& particles) const;
};

/// u_i = -K 2 h^2 |grad v| sum_j V_j grad W_ij   [m/s]
/// The form of Sun et al. (2017, Eq. 13 over dt; there K = 2) with h |grad v| instead of the
/// largest speed of all: it asks for no more than the strain that makes the disorder, does not
/// depend on the frame, and one fast drop does not shake the tank. |grad v|^2 = sum_j V_j |v_ij|^2
/// (-grad W_ij . x_ij)/r^2. At most h |grad v|, and K 2 h^2 |grad v| interval <= h^2/2, the stable
/// limit of such a diffusion [Lind et al. 2012]. Without its part along the normal at the free
/// surface and near it [Sun et al. 2018]; zero for spray and for particles that see another fluid.
/// Velocities stay, so momentum is conserved to the last bit; angular momentum is not. Reads the
/// packed records and Neighborhood::depth. interval: until the next time [s].
void find_shift(const PairPhysics& physics, const Neighborhood& neighbors, double interval,
                Shift& shift);

}  // namespace undertow::sph
