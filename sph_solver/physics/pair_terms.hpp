#pragma once
// The physics of one pair i, j, one line per term, on any number type: float8 (eight i against one j),
// float and double (reference). Sums leave out constants, which pair_factors.hpp applies.
//
//   continuity      d(rho_i)/dt = rho_i sum_j V_j v_ij . grad_i W_ij        [Wang 2024, Eq. 5, V = m/rho]
//   diffusion       + 2 delta h c0 sum_j V_j [(rho_j - rho_i) - hydrostatic part] (-F)
//                                                      [Molteni & Colagrossi 2009; Fourtakas 2019]
//   pressure        dv_i/dt = -1/rho_i sum_j V_j (p_i + p_j) grad_i W_ij   volume-symmetric form of Eq. 6
//                   under tension inside the fluid with p_j - p_i instead, see switch_tension()
//   art. viscosity  p_i + p_j gains -alpha h c0 rho0 min(0, v_ij.x_ij)/r^2         [Monaghan 1992]
//   viscosity       dv_i/dt += 1/rho_i sum_j V_j 2 mu (x_ij . grad_i W_ij)/r^2 v_ij    [Morris 1997]
//     or "strain"   p_i + p_j gains -2 mu (d + 2) v_ij.x_ij/r^2                        [Monaghan 2005]
//                   with the weight of strain_weight.hpp for (d + 2)/r^2
//   shear rate      grad v_i = [sum_j V_j (v_j - v_i) grad_i W_ij] [sum_j V_j (x_j - x_i) grad_i W_ij]^-1
// with x_ij = x_i - x_j, v_ij = v_i - v_j, grad_i W_ij = -scale F x_ij.
//
// Between two fluids: V and rho of each particle's own; c0 rho0 of the artificial viscosity is the
// mean of the two; mu their harmonic mean, which keeps the shear stress steady across the interface
// [Cleary & Monaghan 1999]; no density diffusion. Inside one viscoplastic fluid mu varies without a
// jump, see mean_within.

#include "case/case.hpp"
#include "sph_solver/physics/pair_choices.hpp"
#include "sph_solver/simd.hpp"

namespace undertow::sph {

/// What the pair loop of a cluster must tell apart. The first is the whole loop of most scenes and of
/// most clusters in all others.
enum class Content {
    one_fluid,      // Newtonian, the same for all
    several,        // of constant viscosities
    viscoplastic,   // viscosities differ from particle to particle
    sheared,        // and this cluster needs its own shear rate
    one_viscoplastic,  // the same two inside one viscoplastic fluid
    one_sheared,
};

/// One fluid, the same for all: its constants need no table.
constexpr bool alone(Content c) {
    return c == Content::one_fluid || c == Content::one_viscoplastic || c == Content::one_sheared;
}
constexpr bool finds_shear_rate(Content c) {
    return c == Content::sheared || c == Content::one_sheared;
}
/// Viscosities come with the particles.
constexpr bool variable_viscosity(Content c) {
    return c == Content::viscoplastic || c == Content::one_viscoplastic || finds_shear_rate(c);
}

template <class Scalar>
struct PairConstants {
    Scalar inverse_h;       // [1/unit]
    Scalar tiny;            // [unit^2] keeps r > 0 for a particle and itself
    Scalar shock;           // alpha h c0 rho0 / unit [Pa s]: artificial viscosity of one_fluid
    Scalar gx, gy, gz;      // rho0 g unit [Pa/unit]: hydrostatic part of the pressure difference;
                            // g unit where there are several fluids
    Scalar near, far;       // 2 mu (near, far/h^2) of strain_weight.hpp [Pa s/unit], [Pa s/unit^3];
                            // without mu where that is in the sums
};

/// What particle i shows of itself.
template <class Real>
struct Own {
    Real vx, vy, vz, p;
    Real push;              // p, or -p where tension is switched: what the force takes for p_i
    Real rho0{}, root_mu{};   // [kg/m3], [sqrt(Pa s)] root of mu; unused by one_fluid
};

/// Between particles of different size W_ij = W(r, h_ij) with h_ij = (h_i + h_j)/2, the same for both:
/// forces stay equal and opposite. F is that of the reference length h0 at r h0/h_ij.
template <class Real>
struct PairSize {
    Real length;            // h_ij/h0
    Real nearer2;           // (h0/h_ij)^2
    Real factor;            // (h0/h_ij)^(d+2), by which grad W = -scale F x_ij grows

    /// h_i, h_j: over 2 h0.
    template <class Other>
    PairSize(Real h_i, Other h_j, bool flat) : length(h_i + h_j) {
        const Real nearer = precise_reciprocal(length);
        nearer2 = nearer * nearer;
        factor = flat ? nearer2 * nearer2 : nearer2 * nearer2 * nearer;
    }
};

/// What i has in common with any particle of one fluid.
template <class Real>
struct Meeting {
    Real same;              // 1 if it is i's own fluid, else 0
    Real shock;             // alpha h (mean of c0 rho0) / unit [Pa s]
    Real mu;                // harmonic mean of the constant viscosities [Pa s]
    Real border;            // of grad W, see weight_across
    Real per_border;        // 1/border
};

/// By what grad W(r, h_ij) is multiplied between two fluids whose smoothing lengths at rest are h_i
/// and h_j: h_ij^2/(h_i h_j), 1 for the same size, 1.125 for one twice the other.
///
/// A plane of particles at distance b beyond the border of two sizes would have to add
/// -w'(a/h_i + b/h_j)/(h_i h_j) at distance a before it, w the kernel summed over planes: all of them
/// then add w(a/h_i)/h_i, what i's own side leaves open under even pressure, and w(b/h_j)/h_j at j. At
/// the border, a and b half a spacing, that is the mean h_ij with this factor. Without it even pressure
/// mixes the two, see docs/theory.md. Viscosity is without it.
inline double weight_across(double h_i, double h_j) {
    const double h = 0.5 * (h_i + h_j);
    return h * h / (h_i * h_j);
}

template <class Real>
struct PairSums {
    Real ax{}, ay{}, az{};  // sum V F P x_ij
    Real lx{}, ly{}, lz{};  // sum V F v_ij; where there are several fluids sum V F mu v_ij
    Real divergence{};      // sum V F v_ij . x_ij
    Real diffusion{};       // sum V F (p_j - p_i + rho0 g . x_ij)
};

/// Sums V F v_ij x_ij and V F x_ij x_ij.
template <class Real>
struct ShearSums {
    Real vxx{}, vxy{}, vxz{}, vyx{}, vyy{}, vyz{}, vzx{}, vzy{}, vzz{};
    Real xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
};

/// A symmetric 3 x 3 matrix.
template <class Real>
struct Symmetric {
    Real xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
};

/// 2 a b/(a + b) of two viscosities; 0 if both are.
inline double harmonic_mean(double a, double b) {
    return ((a + a) * b) * reciprocal((a + 1e-30f) + b);
}

// Mean viscosities of pairs [Pa s] from the roots a, b of their viscosities [sqrt(Pa s)]: the same bits
// for b and a, so that the forces of a pair stay opposite.

/// Inside one fluid: (a^2 + 4 a b + b^2)/6, Simpson's rule for the mean of mu along the pair where
/// log mu is linear between the two (the logarithmic mean: 0.2 % above it at a ratio of 5, 9 % at 100).
/// The harmonic mean is too low across a steep gradient of mu: channels in docs/theory.md.
template <class Real, class Other>
inline Real mean_within(Real a, Other b) {
    const Real d = a - b;
    return a * b + (d * d) * (1.0f / 6);
}

/// Between two fluids: the harmonic mean of a^2 and b^2; 0 if both are. To 14 bits, 6e-5: no law of a
/// viscosity is known to that.
template <class Real, class Other>
inline Real mean_between(Real a, Other b) {
    const Real sum = a + b, product = a * b;
    return ((product + product) * product) * reciprocal((sum * sum + 1e-30f) - (product + product));
}

/// same: 1 in one fluid, 0 between two.
template <class Real, class Other>
inline Real mean_viscosity(Real same, Real a, Other b) {
    const Real between = mean_between(a, b);
    return between + same * (mean_within(a, b) - between);
}

/// with, root_mu_j and shear are not looked at unless `content` says so, size unless `sized`, correction
/// unless `gradient` does. Returns F/V: zero beyond the support.
template <class KernelLaw, Terms terms, Content content = Content::one_fluid, bool sized = false,
          Gradient gradient = Gradient::plain, ViscousForm form = ViscousForm::laplacian, class Real,
          class Scalar, class Neighbor>
inline __attribute__((always_inline)) Real add_pair(
    const PairConstants<Scalar>& c, const Own<Real>& i, Real dx, Real dy, Real dz,
    const Neighbor& j, PairSums<Real>& sum, const Meeting<Real>* with = nullptr,
    Scalar root_mu_j = 0, ShearSums<Real>* shear = nullptr, const PairSize<Real>* size = nullptr,
    const Symmetric<Real>* correction = nullptr) {
    constexpr bool rate = terms != Terms::force, force = terms != Terms::rate;
    constexpr bool mixed = !alone(content);
    const Real r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
    Real per_volume, F;
    if constexpr (sized) {
        per_volume = KernelLaw::gradient_factor(r2 * size->nearer2, c.inverse_h);
        F = per_volume * (size->factor * with->border * Scalar(j.volume));
    } else {
        per_volume = KernelLaw::gradient_factor(r2, c.inverse_h);
        F = per_volume * Scalar(j.volume);
    }
    const Real vx = i.vx - Scalar(j.vx), vy = i.vy - Scalar(j.vy), vz = i.vz - Scalar(j.vz);
    const Real approach = vx * dx + vy * dy + vz * dz;
    if constexpr (rate) {
        const Real hydrostatic = c.gx * dx + c.gy * dy + c.gz * dz;
        if constexpr (gradient == Gradient::corrected) {
            const Symmetric<Real>& m = *correction;
            sum.divergence += F * (vx * (m.xx * dx + m.xy * dy + m.xz * dz) +
                                   vy * (m.xy * dx + m.yy * dy + m.yz * dz) +
                                   vz * (m.xz * dx + m.yz * dy + m.zz * dz));
        } else {
            sum.divergence += F * approach;
        }
        if constexpr (sized)
            sum.diffusion += (F * with->same * size->length) *
                             ((Scalar(j.p) - i.p) + i.rho0 * hydrostatic);
        else if constexpr (mixed)
            sum.diffusion += (F * with->same) * ((Scalar(j.p) - i.p) + i.rho0 * hydrostatic);
        else
            sum.diffusion += F * ((Scalar(j.p) - i.p) + hydrostatic);
    }
    if constexpr (force) {
        const Real per_r2 = reciprocal(r2);
        const Real closing = negative_part(approach) * per_r2;
        Real P = i.push + Scalar(j.p);
        [[maybe_unused]] Real FV = F;
        if constexpr (sized)
            P -= closing * (with->shock * size->length);
        else if constexpr (mixed)
            P -= closing * with->shock;
        else
            P -= closing * c.shock;
        if constexpr (form == ViscousForm::strain) {
            Real viscous = approach;
            if constexpr (sized)
                viscous *= positive_part(c.near * per_r2 + c.far * size->nearer2);
            else
                viscous *= positive_part(c.near * per_r2 + c.far);
            if constexpr (variable_viscosity(content) && mixed)
                viscous *= mean_viscosity(with->same, i.root_mu, root_mu_j);
            else if constexpr (variable_viscosity(content))
                viscous *= mean_within(i.root_mu, root_mu_j);
            else if constexpr (mixed)
                viscous *= with->mu;
            if constexpr (sized) viscous *= with->per_border;
            P -= viscous;
        } else {
            if constexpr (variable_viscosity(content) && mixed)
                FV *= mean_viscosity(with->same, i.root_mu, root_mu_j);
            else if constexpr (variable_viscosity(content))
                FV *= mean_within(i.root_mu, root_mu_j);
            else if constexpr (mixed)
                FV *= with->mu;
            if constexpr (sized) FV *= with->per_border;
        }
        const Real FP = F * P;
        sum.ax += FP * dx;
        sum.ay += FP * dy;
        sum.az += FP * dz;
        if constexpr (form == ViscousForm::laplacian) {
            sum.lx += FV * vx;
            sum.ly += FV * vy;
            sum.lz += FV * vz;
        }
        if constexpr (finds_shear_rate(content)) {
            const Real Fx = F * dx, Fy = F * dy, Fz = F * dz;
            shear->vxx += vx * Fx, shear->vxy += vx * Fy, shear->vxz += vx * Fz;
            shear->vyx += vy * Fx, shear->vyy += vy * Fy, shear->vyz += vy * Fz;
            shear->vzx += vz * Fx, shear->vzy += vz * Fy, shear->vzz += vz * Fz;
            shear->xx += dx * Fx, shear->xy += dx * Fy, shear->xz += dx * Fz;
            shear->yy += dy * Fy, shear->yz += dy * Fz, shear->zz += dz * Fz;
        }
    }
    return per_volume;
}

}  // namespace undertow::sph
