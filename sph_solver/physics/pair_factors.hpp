#pragma once
// Constants of the pair terms, and what multiplies the finished sums.

#include <cmath>
#include <type_traits>

#include "sph_solver/particles.hpp"
#include "sph_solver/physics/pair_sums.hpp"
#include "sph_solver/physics/pair_terms.hpp"

namespace undertow::sph {

/// Constants that multiply the finished sums; OfOwn where they depend on the particle's fluid.
template <class Scalar, class OfOwn = Scalar>
struct Factors {
    Scalar gradient;  // scale * unit: of sums with x_ij [1/m^(d+1)]
    Scalar viscous;   // 2 mu scale [Pa s/m^(d+2)]; 2 scale where mu is in the sums
    OfOwn diffusive;  // 2 delta h scale / c0 [s/m^(d+2)]: from pressure to density differences
    OfOwn per_mass;   // 1/(rho0 V0): 1/rho_i = V_i/(rho0 V0) exactly, so that pair forces are
                      // equal and opposite
};

/// Keeps r > 0 for a particle and itself [h^2]. In double so little that loops which scale it with
/// lengths of their own (see PairSize), or do without, agree to round-off.
template <class Scalar>
inline constexpr double tiny_share = std::is_same_v<Scalar, float> ? 1e-6 : 1e-14;

/// Constants of the loop over one fluid. scale: of its kernel, see scale_of.
template <class Scalar>
PairConstants<Scalar> pair_constants(const PairPhysics& p, const FluidLaw& f, double unit) {
    const double h = f.h / unit;
    const double strain = p.implicit_viscosity ? 0 : 2 * f.mu / unit;
    return {Scalar(1 / h),
            Scalar(tiny_share<Scalar> * h * h),
            Scalar(p.artificial_viscosity * f.h * f.c0 * f.rho0 / unit),
            Scalar(f.rho0 * p.gravity[0] * unit),
            Scalar(f.rho0 * p.gravity[1] * unit),
            Scalar(f.rho0 * p.gravity[2] * unit),
            Scalar(strain * p.strain_weight.near),
            Scalar(strain * p.strain_weight.far / (h * h))};
}

template <class Scalar>
Factors<Scalar> factors(const PairPhysics& p, const FluidLaw& f, double scale, double unit) {
    scale /= p.lattice_moment;
    return {Scalar(scale * unit), Scalar(p.implicit_viscosity ? 0 : 2 * f.mu * scale),
            Scalar(2 * p.density_diffusion * f.h * scale / f.c0), Scalar(1 / (f.rho0 * f.volume))};
}

/// Of a fluid whose h is another than that of `scale`: proportional to h^-(d+2).
inline double scale_of(const PairPhysics& p, const FluidLaw& f, double scale) {
    return f.h == p.h ? scale : scale * std::pow(p.h / f.h, p.dimension + 2);
}

/// What the loop over several fluids looks up by their indices.
template <class Scalar>
struct Mixture {
    int fluids = 0;
    bool sized = false;
    PairConstants<Scalar> constants{};
    Scalar gradient = 0, viscous = 0;  // as in Factors
    Scalar rho0[FluidTag::most], diffusive[FluidTag::most], per_mass[FluidTag::most];
    Meeting<Scalar> meeting[FluidTag::most][FluidTag::most];  // [i][j]

    Mixture(const PairPhysics& p, double scale, double unit)
        : fluids(static_cast<int>(p.fluids.size())), sized(p.sized()) {
        FluidLaw none;  // its part of the constants is in the tables
        none.rho0 = 1, none.c0 = 0, none.h = p.h, none.mu = 1;
        constants = pair_constants<Scalar>(p, none, unit);
        gradient = Scalar(scale / p.lattice_moment * unit);
        viscous = Scalar(p.implicit_viscosity ? 0 : 2 * scale / p.lattice_moment);
        for (int a = 0; a < fluids; ++a) {
            FluidLaw f = p.fluids[a];
            f.h = p.h;  // lengths of pairs are relative to it, see PairSize
            const auto own = factors<Scalar>(p, f, scale, unit);
            rho0[a] = Scalar(f.rho0), diffusive[a] = own.diffusive, per_mass[a] = own.per_mass;
            for (int b = 0; b < fluids; ++b) {
                const FluidLaw& other = p.fluids[b];
                const double impedance = 0.5 * (f.c0 * f.rho0 + other.c0 * other.rho0);
                const double mu = f.mu + other.mu > 0 ? 2 * f.mu * other.mu / (f.mu + other.mu) : 0;
                const double across = weight_across(p.fluids[a].h, other.h);
                meeting[a][b] = {Scalar(a == b ? 1 : 0),
                                 Scalar(p.artificial_viscosity * p.h * impedance / unit),
                                 Scalar(mu), Scalar(across), Scalar(1 / across)};
            }
        }
    }
};

template <class Real, class Scalar, class OfOwn>
Real density_rate(const Factors<Scalar, OfOwn>& k, Real per_rho, const PairSums<Real>& s) {
    return k.diffusive * s.diffusion - (k.gradient * s.divergence) / per_rho;
}

template <class Real, class Scalar, class OfOwn>
void acceleration(const Factors<Scalar, OfOwn>& k, Real per_rho, const PairSums<Real>& s, Real& ax,
                  Real& ay, Real& az) {
    ax = per_rho * (k.gradient * s.ax - k.viscous * s.lx);
    ay = per_rho * (k.gradient * s.ay - k.viscous * s.ly);
    az = per_rho * (k.gradient * s.az - k.viscous * s.lz);
}

/// M^-1 of M ~ sum V F x_ij x_ij, about one (in 2D with yy = 1). M is not inverted, but taken for one,
/// where the neighbors lie nearly in a plane or on a line (drops, sheets one particle thin):
/// det M < 0.05 (tr M/3)^3, a measure of shape that surfaces, edges and corners of a body pass.
template <class Scalar, class Real>
Symmetric<Real> inverse_moment(const Symmetric<Real>& m) {
    const Real cxx = m.yy * m.zz - m.yz * m.yz, cxy = m.xz * m.yz - m.xy * m.zz,
               cxz = m.xy * m.yz - m.xz * m.yy, cyy = m.xx * m.zz - m.xz * m.xz,
               cyz = m.xy * m.xz - m.xx * m.yz, czz = m.xx * m.yy - m.xy * m.xy;
    const Real det = m.xx * cxx + m.xy * cxy + m.xz * cxz;
    const Real trace = m.xx + m.yy + m.zz;
    const auto surrounded = det > Scalar(0.05 / 27) * trace * trace * trace;
    const Real none = det * Scalar(0), one = none + Scalar(1),
               per_det = one / (surrounded ? det : one);
    return {surrounded ? cxx * per_det : one,  surrounded ? cxy * per_det : none,
            surrounded ? cxz * per_det : none, surrounded ? cyy * per_det : one,
            surrounded ? cyz * per_det : none, surrounded ? czz * per_det : one};
}

/// M^-1 for the continuity equation: one at the free surface, around voids and in spray, tr M < 0.75 d
/// [Lee et al. 2008]. Corrected there, densities answer to motions that the pressure hardly resists: a
/// vortex with a cavity blew up.
template <class Scalar, class Real>
Symmetric<Real> divergence_correction(Symmetric<Real> m, int dimension) {
    const auto inside = m.xx + m.yy + m.zz > Scalar(0.75 * dimension);
    m.yy += Scalar(dimension == 2 ? 1 : 0);
    const Symmetric<Real> c = inverse_moment<Scalar>(m);
    const Real none = m.xx * Scalar(0), one = none + Scalar(1);
    return {inside ? c.xx : one, inside ? c.xy : none, inside ? c.xz : none,
            inside ? c.yy : one, inside ? c.yz : none, inside ? c.zz : one};
}

/// gd = sqrt(2 D':D') of the deviatoric strain rate D', with grad v = G M^-1, which is exact in a
/// linear field for any arrangement of neighbors: G ~ sum V F v_ij x_ij, M ~ sum V F x_ij x_ij.
/// [1/s] to_gradient: scale unit [1/(m^d unit)]; to_moment: scale unit^2.
template <class Real, class Scalar>
Real shear_rate(const ShearSums<Real>& s, Scalar to_gradient, Scalar to_moment, int dimension) {
    const Symmetric<Real> m{to_moment * s.xx,
                            to_moment * s.xy,
                            to_moment * s.xz,
                            to_moment * s.yy + Scalar(dimension == 2 ? 1 : 0),
                            to_moment * s.yz,
                            to_moment * s.zz};
    const auto [ixx, ixy, ixz, iyy, iyz, izz] = inverse_moment<Scalar>(m);
    const Real vx_x = s.vxx * ixx + s.vxy * ixy + s.vxz * ixz,
               vx_y = s.vxx * ixy + s.vxy * iyy + s.vxz * iyz,
               vx_z = s.vxx * ixz + s.vxy * iyz + s.vxz * izz,
               vy_x = s.vyx * ixx + s.vyy * ixy + s.vyz * ixz,
               vy_y = s.vyx * ixy + s.vyy * iyy + s.vyz * iyz,
               vy_z = s.vyx * ixz + s.vyy * iyz + s.vyz * izz,
               vz_x = s.vzx * ixx + s.vzy * ixy + s.vzz * ixz,
               vz_y = s.vzx * ixy + s.vzy * iyy + s.vzz * iyz,
               vz_z = s.vzx * ixz + s.vzy * iyz + s.vzz * izz;
    const Real mean = (vx_x + vy_y + vz_z) * Scalar(1.0 / 3);
    const Real dxx = vx_x - mean, dyy = vy_y - mean, dzz = vz_z - mean;
    const Real gxy = vx_y + vy_x, gxz = vx_z + vz_x, gyz = vy_z + vz_y;  // 2 D_ab
    return to_gradient * square_root(Scalar(2) * (dxx * dxx + dyy * dyy + dzz * dzz) + gxy * gxy +
                                     gxz * gxz + gyz * gyz);
}

}  // namespace undertow::sph
