#pragma once
// The sums over neighbors: rates of density and accelerations for all particles.

#include <vector>

#include "case/case.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"
#include "sph_solver/physics/pair_terms.hpp"

namespace undertow::sph {

struct PairPhysics {
    Kernel kernel = Kernel::wendland_c2;
    double h = 0;                     // smoothing length [m]
    int dimension = 3;
    double artificial_viscosity = 0;  // alpha
    double density_diffusion = 0;     // delta
    Vec3 gravity{};                   // [m/s2]
    FluidLaw fluid;
};

/// Writes particles.drho_dt (rate), particles.ax, ay, az (force) or both from the packed records.
void sum_over_neighbors(const PairPhysics& physics, const Neighborhood& neighbors, Terms terms,
                        Particles& particles);

/// The same in double precision, one pair at a time: the readable reference of the fast loop.
void sum_over_neighbors_reference(const PairPhysics& physics, const Neighborhood& neighbors,
                                  Particles& particles, std::vector<double>& rate,
                                  std::vector<Vec3>& acceleration);

/// Normal force of the fluid on each mirror plane, positive against the fluid's side, from the pairs
/// of particles with images: -sum_i m_i a_i . n_k.  [N], [planes]
std::vector<double> plane_forces(const PairPhysics& physics, const Neighborhood& neighbors,
                                 const MirrorPlanes& mirror);

}  // namespace undertow::sph
