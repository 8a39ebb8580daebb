#pragma once
// The viscous forces as a linear map of the velocities, on the cluster lists of the pair sums:
//   (K u)_i = sum_j w_ij (u_i - u_j)                                  laplacian  [Morris 1997]
//   (K u)_i = sum_j s w_ij [(u_i - u_j) . x_ij] x_ij                  strain     [Monaghan 2005,
//   Eq. 8.9, s = (d + 2)/r^2 there, here as in strain_weight.hpp]
//   w_ij = 2 mu_ij V_i V_j scale F(r)  [kg/s per m^(3-d)],  mu_ij as in pair_terms.hpp
// w_ij = w_ji >= 0, and an image of j behind a plane stands to i as the image of i stands to j,
// behind a no-slip plane with the strain form by no_slip_images.hpp: K is symmetric and positive
// semidefinite. The implicit update solves (M + dt K) u = M u*.

#include <cstdint>
#include <vector>

#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/boundary/no_slip_images.hpp"
#include "sph_solver/physics/pair_sums.hpp"
#include "sph_solver/simd.hpp"

namespace undertow::sph {

/// A vector per particle, padded to full clusters of eight.
template <class Real>
struct Field3 {
    std::vector<Real> x, y, z;

    void resize(std::size_t n) {
        for (auto* a : {&x, &y, &z}) a->resize((n + lanes - 1) / lanes * lanes, Real(0));
    }
};

/// In the precision Real of sph.precision. Sums over particles are taken cluster by cluster and
/// then in order: the same bits for any number of threads.
template <class Real>
class ViscousOperator {
 public:
    /// Takes positions and viscosities as packed for this step. Free-slip bodies carry no stress, a
    /// no-slip body's dummy shows 2 v_wall - u_i.
    void prepare(const PairPhysics& physics, const Neighborhood& neighbors,
                 const MirrorPlanes& mirror, const NoSlipImages& no_slip, const Bodies& bodies,
                 const Particles& particles);

    enum class Walls { moving, still };  // with their velocities; or the linear part alone
    /// out = mass_factor M u + dt K u  [kg m/s per m^(3-d)]. Returns u . out.
    double apply(const Field3<Real>& u, Walls walls, double mass_factor, double dt,
                 Field3<Real>& out);
    /// out = dt K u, with moving walls. Returns what friction dissipates in dt, dt sum_ij
    /// w_ij |u_i - u_j|^2/2 [J per m^(3-d)], an image counted by half.
    double rub(const Field3<Real>& u, double dt, Field3<Real>& out);
    /// out[i] = M_i + dt sum_j w_ij c, c = 1 (laplacian) or s r^2/d (strain): near the diagonal.
    void diagonal(double dt, std::vector<Real>& out);

    const std::vector<Real>& mass() const { return mass_; }  // rho0 V0 of each particle

 private:
    void pack(const Field3<Real>& u, Walls walls);
    enum class Returns { product, dissipation };
    template <class KernelLaw, ViscousForm form, bool several>
    double apply_as(const Field3<Real>& u, double mass_factor, double dt, Field3<Real>& out,
                    Returns returns);
    double apply(const Field3<Real>& u, double mass_factor, double dt, Field3<Real>& out,
                 Returns returns);
    template <class Body>
    double over_clusters(Body&& body);

    const PairPhysics* physics_ = nullptr;
    const Neighborhood* neighbors_ = nullptr;
    const MirrorPlanes* mirror_ = nullptr;
    const NoSlipImages* no_slip_ = nullptr;
    std::vector<Record<Real>> records_;  // velocity: of u; p: root of the viscosity [sqrt(Pa s)]
    std::vector<ViscousImage> image_;    // [extras]
    std::vector<Real> mass_;             // [particles], padded
    std::vector<double> part_;           // [clusters]
};

}  // namespace undertow::sph
