#pragma once
// The loops over clusters and their lists in the precision Real; pair_sums_float.cpp and
// pair_sums_double.cpp each compile one.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/gradient_correction.hpp"
#include "sph_solver/physics/pair_clusters.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// sum_over_neighbors in one precision; records of the other are not looked at.
template <class Real>
void sum_in(const PairPhysics& physics, const Neighborhood& neighbors, const NoSlipImages& no_slip,
            Terms terms, Particles& particles, ShearRate shear_rate);

namespace {

/// Double takes mixtures in two passes where float takes one: loops that find both terms of all
/// contents would double the time of compiling them, for runs that want few digits' difference.
template <class Real>
inline constexpr bool both_of_mixtures = std::is_same_v<Real, float>;

template <class Real>
inline void store(Real* a, Eight<Real> value) {
    __builtin_memcpy(a, &value, sizeof value);
}

template <Terms terms, class Real, class OfOwn>
void store_results(const Factors<Real, OfOwn>& k, Eight<Real> volume,
                   const PairSums<Eight<Real>>& sum, int first, Particles& particles) {
    const Eight<Real> per_rho = volume * k.per_mass;
    if constexpr (terms != Terms::force)
        store(particles.drho_dt.data<Real>() + first, density_rate(k, per_rho, sum));
    if constexpr (terms != Terms::rate) {
        Eight<Real> ax, ay, az;
        acceleration(k, per_rho, sum, ax, ay, az);
        store(particles.ax.data<Real>() + first, ax);
        store(particles.ay.data<Real>() + first, ay);
        store(particles.az.data<Real>() + first, az);
    }
}

/// Viscosities of the next step, of the viscoplastic ones among the eight.
template <class AnyRecord>
void take_shear_rate(const PairPhysics& physics, const AnyRecord* records, int first, int members,
                     Eight<typename AnyRecord::Real> rate, Particles& particles) {
    for (int lane = 0; lane < members; ++lane) {
        const FluidLaw& fluid = physics.fluids[FluidTag::of(records[first + lane])];
        if (!fluid.viscoplastic()) continue;
        particles.shear_rate[first + lane] = rate[lane];
        particles.viscosity[first + lane] = fluid.rheology(rate[lane]);
    }
}

template <class Real>
void take_shear_rate(const PairPhysics& physics, const Neighborhood& neighbors, Real gradient,
                     const ShearSums<Eight<Real>>& shear, int first, Particles& particles) {
    const auto to_moment = static_cast<Real>(gradient * neighbors.unit_in<Real>());
    take_shear_rate(physics, neighbors.records_in<Real>().data(), first,
                    std::min(lanes, neighbors.fluid_count() - first),
                    shear_rate(shear, gradient, to_moment, physics.dimension), particles);
}

/// Calls add(j, x) for the entries of a cluster's list, x where the lanes stand or, if they do not see
/// it, are put: for rates all, marking those for which it gives anything but zeros; for forces the
/// marked ones, and all that some do not see. Records are fetched ahead of their use: those of 27,000
/// particles and their walls fill a core's cache, those of more do not fit.
template <Terms terms, class AnyRecord, class Place, class Add>
inline __attribute__((always_inline)) void walk(const Neighborhood& neighbors,
                                                const AnyRecord* records, int cluster,
                                                const Place& all_x, Add&& add) {
    const ClusterLists& lists = neighbors.fluid_lists();
    Place x = all_x;
    const auto one = [&](const int* at) __attribute__((always_inline)) {
        __builtin_prefetch(records + at[ClusterLists::ahead]);
        return add(*at, x);
    };
    const int* at = lists.begin(cluster);
    const int* end = lists.end(cluster);
    std::uint64_t spare = 0, *word = terms == Terms::both ? &spare : neighbors.marked().of(cluster);
    for (int part = 1;; ++part) {
        if constexpr (terms == Terms::both) {
            for (; at != end; ++at) one(at);
        } else {
            for (; at < end; at += MarkedEntries::bits) {
                const auto n = std::min<std::ptrdiff_t>(MarkedEntries::bits, end - at);
                if constexpr (terms == Terms::rate) {
                    std::uint64_t marks = 0;
                    for (int k = 0; k < n; ++k)
                        marks |= std::uint64_t(any_nonzero(one(at + k))) << k;
                    *word = marks;
                } else {
                    for (std::uint64_t marks = part == 1 ? *word : MarkedEntries::first(n); marks;
                         marks &= marks - 1)
                        one(at + std::countr_zero(marks));
                }
                if (part == 1) ++word;
            }
        }
        if (part >= lists.parts(cluster)) return;
        const ClusterLists::Part next = lists.part(cluster, part);
        at = next.begin, end = next.end, word = &spare;
        x = hide(all_x, next.hidden, neighbors.out_of_reach<typename AnyRecord::Real>());
    }
}

template <class Real, class KernelLaw, Terms terms, Gradient gradient, ViscousForm form,
          Content content = Content::one_fluid>
inline void sum_pure_cluster(const PairPhysics& physics, const PairConstants<Real>& c,
                             const Factors<Real>& k, const Neighborhood& neighbors,
                             const NoSlipImages& no_slip, int cluster, Particles& particles) {
    using Wide = Eight<Real>;
    constexpr bool variable = variable_viscosity(content);
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const Real* root_mu = variable ? neighbors.root_viscosity_in<Real>().data() : nullptr;
    const int first = cluster * lanes, n = neighbors.fluid_count();
    Lanes<Real> i = load_cluster(records, first, n);
    if (terms != Terms::rate) switch_tension(physics, neighbors, first, i.own);
    if constexpr (variable)
        for (int lane = 0; lane < lanes; ++lane)
            i.own.root_mu[lane] = root_mu[std::min(first + lane, n - 1)];
    const Meeting<Wide>* no_tables = nullptr;
    const PairSize<Wide>* no_sizes = nullptr;
    Symmetric<Wide> correction;
    if constexpr (gradient == Gradient::corrected)
        correction = correction_of<Real>(neighbors, cluster);
    PairSums<Wide> sum;
    ShearSums<Wide> shear;
    const auto one = [&](int at, const auto& x) __attribute__((always_inline)) {
        const Record<Real>& j = records[at];
        const Wide dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        return add_pair<KernelLaw, terms, content, false, gradient, form>(
            c, i.own, dx, dy, dz, j, sum, no_tables, variable ? root_mu[at] : Real(0), &shear,
            no_sizes, &correction);
    };
    walk<terms>(neighbors, records, cluster, i.x, one);
    if constexpr (terms != Terms::rate)
        if (!no_slip.empty())
            add_no_slip<KernelLaw, content, form>(c, i, no_slip, neighbors, cluster, no_tables,
                                                  root_mu, sum, &shear);
    store_results<terms>(k, i.volume, sum, first, particles);
    if constexpr (finds_shear_rate(content))
        take_shear_rate(physics, neighbors, k.gradient, shear, first, particles);
}

template <class Real, class KernelLaw, Terms terms, Gradient gradient, ViscousForm form>
void sum_clusters(const KernelLaw& kernel, const PairPhysics& physics,
                  const Neighborhood& neighbors, const NoSlipImages& no_slip,
                  Particles& particles) {
    const double unit = neighbors.unit_in<Real>();
    const FluidLaw& fluid = physics.fluids[0];
    const auto c = pair_constants<Real>(physics, fluid, unit);
    const auto k = factors<Real>(physics, fluid, kernel.scale(), unit);
    const int clusters = neighbors.fluid_lists().clusters();
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster)
        sum_pure_cluster<Real, KernelLaw, terms, gradient, form>(physics, c, k, neighbors, no_slip,
                                                                 cluster, particles);
}

template <class Real, class KernelLaw, Terms terms, Gradient gradient, ViscousForm form,
          Content content, bool sized = false>
void sum_mixed_cluster(const PairPhysics& physics, const Mixture<Real>& mixture,
                       const Neighborhood& neighbors, const NoSlipImages& no_slip, int cluster,
                       Particles& particles) {
    using Wide = Eight<Real>;
    constexpr bool variable = variable_viscosity(content);
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const Real* root_mu = variable ? neighbors.root_viscosity_in<Real>().data() : nullptr;
    const int first = cluster * lanes, n = neighbors.fluid_count();
    Lanes<Real> i = load_cluster(records, first, n);
    if (terms != Terms::rate) switch_tension(physics, neighbors, first, i.own);
    MixedLanes<Real> m;
    look_up(mixture, records, root_mu, first, n, i.own, m);
    const OwnSize<Real> own_size(physics, sized ? &neighbors.smoothing_in<Real>() : nullptr, first,
                                 n);
    Symmetric<Wide> correction;
    if constexpr (gradient == Gradient::corrected)
        correction = correction_of<Real>(neighbors, cluster);
    PairSums<Wide> sum;
    ShearSums<Wide> shear;
    const auto one = [&](int at, const auto& x) __attribute__((always_inline)) {
        const Record<Real>& j = records[at];
        const Wide dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const auto add = [&](const PairSize<Wide>* size) __attribute__((always_inline)) {
            return add_pair<KernelLaw, terms, content, sized, gradient, form>(
                mixture.constants, i.own, dx, dy, dz, j, sum, &m.with[FluidTag::of(j)],
                variable ? root_mu[at] : Real(0), &shear, size, &correction);
        };
        if constexpr (sized) {
            const PairSize<Wide> size = own_size.with(at);
            return add(&size);
        } else {
            return add(nullptr);
        }
    };
    walk<terms>(neighbors, records, cluster, i.x, one);
    if constexpr (terms != Terms::rate)
        if (!no_slip.empty())
            add_no_slip<KernelLaw, content, form>(mixture.constants, i, no_slip, neighbors,
                                                  cluster, m.with, root_mu, sum, &shear);
    store_results<terms>(m.factors, i.volume, sum, first, particles);
    if constexpr (finds_shear_rate(content))
        take_shear_rate(physics, neighbors, mixture.gradient, shear, first, particles);
}

/// Of a cluster whose viscosities differ. c, k: of the only fluid it meets, if it is one.
template <class Real, class KernelLaw, Terms terms, Gradient gradient, ViscousForm form>
void sum_viscous_cluster(const PairPhysics& physics, Content content, const Mixture<Real>& mixture,
                         const PairConstants<Real>& c, const Factors<Real>& k,
                         const Neighborhood& neighbors, const NoSlipImages& no_slip, int cluster,
                         Particles& particles) {
    if (content == Content::one_viscoplastic)
        sum_pure_cluster<Real, KernelLaw, terms, gradient, form, Content::one_viscoplastic>(
            physics, c, k, neighbors, no_slip, cluster, particles);
    else if (content == Content::one_sheared)
        sum_pure_cluster<Real, KernelLaw, terms, gradient, form, Content::one_sheared>(
            physics, c, k, neighbors, no_slip, cluster, particles);
    else if (content == Content::viscoplastic)
        sum_mixed_cluster<Real, KernelLaw, terms, gradient, form, Content::viscoplastic>(
            physics, mixture, neighbors, no_slip, cluster, particles);
    else
        sum_mixed_cluster<Real, KernelLaw, terms, gradient, form, Content::sheared>(
            physics, mixture, neighbors, no_slip, cluster, particles);
}

/// Each cluster by what it holds and meets: a cluster inside one Newtonian fluid runs as if there
/// were no other.
template <class Real, class KernelLaw, Terms terms, Gradient gradient, ViscousForm form>
void sum_mixed_clusters(const KernelLaw& kernel, const PairPhysics& physics,
                        const Neighborhood& neighbors, const NoSlipImages& no_slip,
                        ShearRate shear_rate, Particles& particles) {
    const double unit = neighbors.unit_in<Real>();
    const Mixture<Real> mixture(physics, kernel.scale(), unit);
    PairConstants<Real> c[FluidTag::most];
    Factors<Real> k[FluidTag::most];
    for (std::size_t f = 0; f < physics.fluids.size(); ++f) {
        FluidLaw law = physics.fluids[f];
        if (law.viscoplastic()) law.mu = 1;  // mu is in the sums
        c[f] = pair_constants<Real>(physics, law, unit);
        k[f] = factors<Real>(physics, physics.fluids[f],
                             scale_of(physics, physics.fluids[f], kernel.scale()), unit);
        if (physics.fluids[f].viscoplastic()) k[f].viscous = mixture.viscous;
    }
    const ContentOf content_of(physics, shear_rate);
    const bool sized = physics.sized();
    const int clusters = neighbors.fluid_lists().clusters();
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const FluidBits held = neighbors.held(cluster), met = neighbors.met(cluster);
        const Content content = content_of(held, met, terms);
        if (sized && (physics.variable_smoothing || content != Content::one_fluid)) {
            if (terms == Terms::rate || !physics.viscoplastic())
                sum_mixed_cluster<Real, KernelLaw, terms, Gradient::plain, form, Content::several,
                                  true>(physics, mixture, neighbors, no_slip, cluster, particles);
            else if constexpr (terms != Terms::rate)
                sum_mixed_cluster<Real, KernelLaw, terms, Gradient::plain, form, Content::sheared,
                                  true>(physics, mixture, neighbors, no_slip, cluster, particles);
            continue;
        }
        switch (content) {
            case Content::one_fluid: {
                const int f = only_fluid(met);
                sum_pure_cluster<Real, KernelLaw, terms, gradient, form>(
                    physics, c[f], k[f], neighbors, no_slip, cluster, particles);
                break;
            }
            case Content::several:
                sum_mixed_cluster<Real, KernelLaw, terms, gradient, form, Content::several>(
                    physics, mixture, neighbors, no_slip, cluster, particles);
                break;
            default:   // viscosities are of no concern to rates
                if constexpr (terms != Terms::rate)
                    sum_viscous_cluster<Real, KernelLaw, terms, gradient, form>(
                        physics, content, mixture, c[only_fluid(met)], k[only_fluid(met)],
                        neighbors, no_slip, cluster, particles);
        }
    }
}

template <class Real, Terms terms, Gradient gradient, ViscousForm form, class KernelLaw>
void sum_with(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
              const NoSlipImages& no_slip, ShearRate shear_rate, Particles& particles) {
    if constexpr (terms != Terms::both || both_of_mixtures<Real>)
        if (physics.mixed()) {
            sum_mixed_clusters<Real, KernelLaw, terms, gradient, form>(
                kernel, physics, neighbors, no_slip, shear_rate, particles);
            return;
        }
    sum_clusters<Real, KernelLaw, terms, gradient, form>(kernel, physics, neighbors, no_slip,
                                                         particles);
}

template <class Real, Terms terms, ViscousForm form, class KernelLaw>
void sum_all(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
             const NoSlipImages& no_slip, ShearRate shear_rate, Particles& particles) {
    if constexpr (terms != Terms::force)
        if (physics.gradient_correction) {
            sum_with<Real, terms, Gradient::corrected, form>(kernel, physics, neighbors, no_slip,
                                                             shear_rate, particles);
            return;
        }
    sum_with<Real, terms, Gradient::plain, form>(kernel, physics, neighbors, no_slip, shear_rate,
                                                 particles);
}

}  // namespace

template <class Real>
void sum_in(const PairPhysics& physics, const Neighborhood& neighbors, const NoSlipImages& no_slip,
            Terms terms, Particles& particles, ShearRate shear_rate) {
    constexpr auto laplacian = ViscousForm::laplacian, strain = ViscousForm::strain;
    if (terms == Terms::both && physics.mixed() && !both_of_mixtures<Real>) {
        for (const Terms one : {Terms::rate, Terms::force})
            sum_in<Real>(physics, neighbors, no_slip, one, particles, shear_rate);
        return;
    }
    if (terms == Terms::force) neighbors.marked().need(neighbors.fluid_lists());
    const bool along_pairs = physics.explicit_form() == strain;
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        const auto sum = [&]<Terms which, ViscousForm form>() {
            sum_all<Real, which, form>(kernel, physics, neighbors, no_slip, shear_rate, particles);
        };
        if (terms == Terms::rate)
            sum.template operator()<Terms::rate, laplacian>();
        else if (terms == Terms::both && along_pairs)
            sum.template operator()<Terms::both, strain>();
        else if (terms == Terms::both)
            sum.template operator()<Terms::both, laplacian>();
        else if (along_pairs)
            sum.template operator()<Terms::force, strain>();
        else
            sum.template operator()<Terms::force, laplacian>();
    });
    // smoothing lengths that follow from density are others when forces are summed
    if (terms == Terms::rate && !physics.variable_smoothing) neighbors.marked().found();
}

}  // namespace undertow::sph
