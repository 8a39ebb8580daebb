#pragma once
// Clusters of eight particles as the lanes of the pair loop, of one fluid or of several.

#include <algorithm>
#include <bit>
#include <vector>

#include "sph_solver/physics/pair_factors.hpp"
#include "sph_solver/simd.hpp"

namespace undertow::sph {

template <class Real>
struct Lanes {
    typename EightOf<Real>::Place x, y, z;
    Own<Eight<Real>> own;
    Eight<Real> volume;
};

template <class AnyRecord>
inline Lanes<typename AnyRecord::Real> load_cluster(const AnyRecord* records, int first, int last) {
    Lanes<typename AnyRecord::Real> c;
    for (int k = 0; k < lanes; ++k) {
        const AnyRecord& q = records[std::min(first + k, last - 1)];
        c.x[k] = q.x, c.y[k] = q.y, c.z[k] = q.z;
        c.own.vx[k] = q.vx, c.own.vy[k] = q.vy, c.own.vz[k] = q.vz;
        c.own.p[k] = q.p, c.volume[k] = q.volume;
    }
    c.own.push = c.own.p;
    return c;
}

/// Calls f(at, x) for all entries of a cluster's list, x where its lanes stand or, if they do not see
/// an entry, are put.
template <class Real, class F>
inline __attribute__((always_inline)) void for_each_entry(const Neighborhood& neighbors,
                                                          const Lanes<Real>& i, int cluster, F&& f) {
    const ClusterLists& lists = neighbors.fluid_lists();
    const int parts = lists.parts(cluster);
    for (int k = 0; k < parts; ++k) {
        const ClusterLists::Part part = lists.part(cluster, k);
        const auto x = hide(i.x, part.hidden, neighbors.out_of_reach<Real>());
        for (const int* at = part.begin; at != part.end; ++at) f(at, x);
    }
}

/// Inside the fluid a particle under tension is pushed by p_j - p_i = p_j + |p_i| instead of p_j + p_i:
/// the same gradient, without the pull that makes particles clump.  [Sun, Colagrossi, Marrone, Antuono,
/// Zhang 2018, Eq. 14]  The two forces of such a pair are not opposite: what is left is
/// -2 p_i V_i sum_j V_j grad W_ij, zero where neighbors are evenly spread.
template <class Wide>
inline void switch_tension(const PairPhysics& physics, const Neighborhood& neighbors, int first,
                           Own<Wide>& own) {
    if (physics.tension_control != TensionControl::switched) return;
    for (int k = 0; k < lanes; ++k)
        if (neighbors.depth()[first + k] == Depth::inside)
            own.push[k] = std::abs(own.p[k]);
}

/// What the lanes of a cluster look up in a Mixture.
template <class Real>
struct MixedLanes {
    Factors<Real, Eight<Real>> factors;
    Meeting<Eight<Real>> with[FluidTag::most];  // by the fluid of j
};

/// root_mu: of the records, or null where viscosities are constant. tagged: records name their
/// fluids.
template <class Real>
inline void look_up(const Mixture<Real>& mixture, const Record<Real>* records, const Real* root_mu,
                    int first, int last, Own<Eight<Real>>& own, MixedLanes<Real>& m,
                    bool tagged = true) {
    m.factors.gradient = mixture.gradient, m.factors.viscous = mixture.viscous;
    for (int k = 0; k < lanes; ++k) {
        const int i = std::min(first + k, last - 1);
        const auto fluid = tagged ? FluidTag::of(records[i]) : 0;
        own.rho0[k] = mixture.rho0[fluid];
        own.root_mu[k] = root_mu ? root_mu[i] : 0;
        m.factors.diffusive[k] = mixture.diffusive[fluid];
        m.factors.per_mass[k] = mixture.per_mass[fluid];
        for (int b = 0; b < mixture.fluids; ++b) {
            const Meeting<Real>& meeting = mixture.meeting[fluid][b];
            m.with[b].same[k] = meeting.same;
            m.with[b].shock[k] = meeting.shock;
            m.with[b].mu[k] = meeting.mu;
            if (!mixture.sized) continue;
            m.with[b].border[k] = meeting.border, m.with[b].per_border[k] = meeting.per_border;
        }
    }
}

/// Smoothing lengths of the lanes, to meet those of the records.
template <class Real>
class OwnSize {
 public:
    /// smoothing: [m] of the records, or null where no size is asked for.
    OwnSize(const PairPhysics& physics, const std::vector<Real>* smoothing, int first, int last)
        : flat_(physics.dimension == 2), per_length_(static_cast<Real>(0.5 / physics.h)) {
        if (!smoothing) return;
        of_ = smoothing->data();
        for (int k = 0; k < lanes; ++k) own_[k] = of_[std::min(first + k, last - 1)] * per_length_;
    }
    PairSize<Eight<Real>> with(int record) const {
        return {own_, of_[record] * per_length_, flat_};
    }

 private:
    bool flat_;
    Real per_length_;  // 1/(2 h0) [1/m]
    const Real* of_ = nullptr;
    Eight<Real> own_{};
};

/// What an image behind a no-slip plane adds to viscous forces and shear rate, see no_slip_images.hpp.
template <class KernelLaw, Content content, ViscousForm form, class Real, class Change>
inline void add_no_slip_image(const PairConstants<Real>& c, const Lanes<Real>& i, const Change& v,
                              const Record<Real>& j, const Meeting<Eight<Real>>* with,
                              Real root_mu_j, PairSums<Eight<Real>>& sum,
                              ShearSums<Eight<Real>>* shear = nullptr) {
    using Wide = Eight<Real>;
    const Wide dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
    const Wide r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
    const Wide F = KernelLaw::gradient_factor(r2, c.inverse_h) * j.volume;
    Wide FV = F;
    if constexpr (content == Content::several)
        FV *= with[FluidTag::of(j)].mu;
    else if constexpr (variable_viscosity(content) && alone(content))
        FV *= mean_within(i.own.root_mu, root_mu_j);
    else if constexpr (variable_viscosity(content))
        FV *= mean_viscosity(with[FluidTag::of(j)].same, i.own.root_mu, root_mu_j);
    if constexpr (form == ViscousForm::strain) {
        const Wide approach = v.x * dx + v.y * dy + v.z * dz;
        const Wide FP = FV * approach * positive_part(c.near * reciprocal(r2) + c.far);
        sum.ax += FP * dx, sum.ay += FP * dy, sum.az += FP * dz;
    } else {
        sum.lx -= FV * v.x, sum.ly -= FV * v.y, sum.lz -= FV * v.z;
    }
    if constexpr (finds_shear_rate(content)) {
        const Wide Fx = F * dx, Fy = F * dy, Fz = F * dz;
        shear->vxx -= v.x * Fx, shear->vxy -= v.x * Fy, shear->vxz -= v.x * Fz;
        shear->vyx -= v.y * Fx, shear->vyy -= v.y * Fy, shear->vyz -= v.y * Fz;
        shear->vzx -= v.z * Fx, shear->vzy -= v.z * Fy, shear->vzz -= v.z * Fz;
    }
}

/// What makes the force along x_ij of such a pair one half along x_ij and half along its reflection,
/// see no_slip_images.hpp. v: its velocity minus the record's.
template <class KernelLaw, Content content, class Real, class Change>
inline void turn_no_slip_image(const PairConstants<Real>& c, const Lanes<Real>& i, const Change& v,
                               const NoSlipImages::Matrix& reflection, const Record<Real>& j,
                               const Meeting<Eight<Real>>* with, Real root_mu_j,
                               PairSums<Eight<Real>>& sum) {
    using Wide = Eight<Real>;
    const Wide dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
    const Wide r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
    Wide half = KernelLaw::gradient_factor(r2, c.inverse_h) * (Real(0.5) * j.volume) *
                positive_part(c.near * reciprocal(r2) + c.far);
    if constexpr (content == Content::several)
        half *= with[FluidTag::of(j)].mu;
    else if constexpr (variable_viscosity(content) && alone(content))
        half *= mean_within(i.own.root_mu, root_mu_j);
    else if constexpr (variable_viscosity(content))
        half *= mean_viscosity(with[FluidTag::of(j)].same, i.own.root_mu, root_mu_j);
    const auto along = [&](int a) {
        const auto& m = reflection[a];
        return Real(m[0]) * dx + Real(m[1]) * dy + Real(m[2]) * dz;
    };
    const Wide ex = along(0), ey = along(1), ez = along(2);
    const Wide vx = i.own.vx - (j.vx + v.x), vy = i.own.vy - (j.vy + v.y),
               vz = i.own.vz - (j.vz + v.z);
    const Wide on_d = half * (vx * dx + vy * dy + vz * dz),
               on_e = half * (vx * ex + vy * ey + vz * ez);
    sum.ax += on_d * dx - on_e * ex;
    sum.ay += on_d * dy - on_e * ey;
    sum.az += on_d * dz - on_e * ez;
}

template <class KernelLaw, Content content, ViscousForm form, class Real>
inline void add_no_slip(const PairConstants<Real>& c, Lanes<Real> i,
                        const NoSlipImages& no_slip, const Neighborhood& neighbors, int cluster,
                        const Meeting<Eight<Real>>* with, const Real* root_mu,
                        PairSums<Eight<Real>>& sum, ShearSums<Eight<Real>>* shear = nullptr) {
    constexpr bool variable = variable_viscosity(content);
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const auto x = i.x;
    for (const auto* at = no_slip.begin(cluster); at != no_slip.end(cluster); ++at) {
        i.x = hide(x, at->hidden, neighbors.out_of_reach<Real>());
        const Real root_mu_j = variable ? root_mu[at->record] : Real(0);
        add_no_slip_image<KernelLaw, content, form>(c, i, no_slip.change<Real>(at->image),
                                                    records[at->record], with, root_mu_j, sum,
                                                    shear);
        if constexpr (form == ViscousForm::strain)
            turn_no_slip_image<KernelLaw, content>(c, i, no_slip.change<Real>(at->image),
                                                   no_slip.reflection(at->image),
                                                   records[at->record], with, root_mu_j, sum);
    }
}

/// What the sums of a cluster must contain, from what it holds and meets.
class ContentOf {
 public:
    ContentOf(const PairPhysics& physics, ShearRate shear_rate)
        : found_(shear_rate == ShearRate::found) {
        for (std::size_t k = 0; k < physics.fluids.size(); ++k)
            if (physics.fluids[k].viscoplastic()) plastic_ |= FluidBits(1u << k);
    }

    Content operator()(FluidBits held, FluidBits met, Terms terms) const {
        const bool single = std::has_single_bit(met);
        if (terms == Terms::rate) return single ? Content::one_fluid : Content::several;
        if (!(met & plastic_)) return single ? Content::one_fluid : Content::several;
        if (found_ && (held & plastic_)) return single ? Content::one_sheared : Content::sheared;
        return single ? Content::one_viscoplastic : Content::viscoplastic;
    }

 private:
    bool found_;
    FluidBits plastic_ = 0;
};

inline int only_fluid(FluidBits met) {
    return std::countr_zero(met);
}

}  // namespace undertow::sph
