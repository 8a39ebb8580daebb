#pragma once
// The physics of one pair i, j, one line per term, on any number type: float8 (eight i against one j),
// float and double (reference). Sums leave out constants, which `finish` in pair_sums.cpp applies.
//
//   continuity      d(rho_i)/dt = rho_i sum_j V_j v_ij . grad_i W_ij        [Wang 2024, Eq. 5, V = m/rho]
//   diffusion       + 2 delta h c0 sum_j V_j [(rho_j - rho_i) - hydrostatic part] (-F)
//                                                      [Molteni & Colagrossi 2009; Fourtakas 2019]
//   pressure        dv_i/dt = -1/rho_i sum_j V_j (p_i + p_j) grad_i W_ij   volume-symmetric form of Eq. 6
//   art. viscosity  p_i + p_j gains -alpha h c0 rho0 min(0, v_ij.x_ij)/r^2         [Monaghan 1992]
//   viscosity       dv_i/dt += 1/rho_i sum_j V_j 2 mu (x_ij . grad_i W_ij)/r^2 v_ij    [Morris 1997]
// with x_ij = x_i - x_j, v_ij = v_i - v_j, grad_i W_ij = -scale F x_ij.

#include "sph_solver/simd.hpp"

namespace undertow::sph {

template <class Scalar>
struct PairConstants {
    Scalar inverse_h;       // [1/unit]
    Scalar tiny;            // [unit^2] keeps r > 0 for a particle and itself
    Scalar shock;           // alpha h c0 rho0 / unit [Pa s]: artificial viscosity
    Scalar gx, gy, gz;      // rho0 g unit [Pa/unit]: hydrostatic part of the pressure difference
};

/// What particle i shows of itself.
template <class Real>
struct Own {
    Real vx, vy, vz, p;
};

template <class Real>
struct PairSums {
    Real ax{}, ay{}, az{};  // sum V F P x_ij
    Real lx{}, ly{}, lz{};  // sum V F v_ij
    Real divergence{};      // sum V F v_ij . x_ij
    Real diffusion{};       // sum V F (p_j - p_i + rho0 g . x_ij)
};

enum class Terms { rate, force, both };

template <class KernelLaw, Terms terms, class Real, class Scalar, class Neighbor>
inline __attribute__((always_inline)) void add_pair(const PairConstants<Scalar>& c,
                                                    const Own<Real>& i, Real dx, Real dy, Real dz,
                                                    const Neighbor& j, PairSums<Real>& sum) {
    constexpr bool rate = terms != Terms::force, force = terms != Terms::rate;
    const Real r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
    const Real F = KernelLaw::gradient_factor(r2, c.inverse_h) * Scalar(j.volume);
    const Real vx = i.vx - Scalar(j.vx), vy = i.vy - Scalar(j.vy), vz = i.vz - Scalar(j.vz);
    const Real approach = vx * dx + vy * dy + vz * dz;
    if constexpr (rate) {
        const Real hydrostatic = c.gx * dx + c.gy * dy + c.gz * dz;
        sum.divergence += F * approach;
        sum.diffusion += F * ((Scalar(j.p) - i.p) + hydrostatic);
    }
    if constexpr (force) {
        const Real P = (i.p + Scalar(j.p)) - (negative_part(approach) * reciprocal(r2)) * c.shock;
        const Real FP = F * P;
        sum.ax += FP * dx;
        sum.ay += FP * dy;
        sum.az += FP * dz;
        sum.lx += F * vx;
        sum.ly += F * vy;
        sum.lz += F * vz;
    }
}

}  // namespace undertow::sph
