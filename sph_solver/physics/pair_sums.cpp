#include "sph_solver/physics/pair_sums.hpp"

#include <vector>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/gradient_correction.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

inline void store(float* a, float8 value) { __builtin_memcpy(a, &value, sizeof value); }

template <Terms terms, class OfOwn>
void store_results(const Factors<float, OfOwn>& k, float8 volume, const PairSums<float8>& sum,
                   int first, Particles& particles) {
    const float8 per_rho = volume * k.per_mass;
    if constexpr (terms != Terms::force)
        store(&particles.drho_dt[first], density_rate(k, per_rho, sum));
    if constexpr (terms != Terms::rate) {
        float8 ax, ay, az;
        acceleration(k, per_rho, sum, ax, ay, az);
        store(&particles.ax[first], ax);
        store(&particles.ay[first], ay);
        store(&particles.az[first], az);
    }
}

/// Viscosities of the next step, of the viscoplastic ones among the eight.
void take_shear_rate(const PairPhysics& physics, const Packed* records, int first, int members,
                     float8 rate, Particles& particles) {
    for (int lane = 0; lane < members; ++lane) {
        const FluidLaw& fluid = physics.fluids[FluidTag::of(records[first + lane])];
        if (!fluid.viscoplastic()) continue;
        particles.shear_rate[first + lane] = rate[lane];
        particles.viscosity[first + lane] = fluid.rheology(rate[lane]);
    }
}

void take_shear_rate(const PairPhysics& physics, const Neighborhood& neighbors, float gradient,
                     const ShearSums<float8>& shear, int first, Particles& particles) {
    const auto to_moment = static_cast<float>(gradient * neighbors.fixed().unit);
    take_shear_rate(physics, neighbors.records().data(), first,
                    std::min(lanes, neighbors.fluid_count() - first),
                    shear_rate(shear, gradient, to_moment, physics.dimension), particles);
}

template <class KernelLaw, Terms terms, Gradient gradient, ViscousForm form,
          Content content = Content::one_fluid>
inline void sum_pure_cluster(const PairPhysics& physics, const PairConstants<float>& c,
                             const Factors<float>& k,
                             const Neighborhood& neighbors, const NoSlipImages& no_slip,
                             int cluster, Particles& particles) {
    constexpr bool variable = variable_viscosity(content);
    const Packed* records = neighbors.records().data();
    const float* root_mu = variable ? neighbors.root_viscosity().data() : nullptr;
    const ClusterLists& lists = neighbors.fluid_lists();
    const int first = cluster * lanes, n = neighbors.fluid_count();
    Lanes i = load_cluster(records, first, n);
    if (terms != Terms::rate) switch_tension(physics, neighbors, first, i.own);
    if constexpr (variable)
        for (int lane = 0; lane < lanes; ++lane)
            i.own.root_mu[lane] = root_mu[std::min(first + lane, n - 1)];
    const Meeting<float8>* no_tables = nullptr;
    const PairSize<float8>* no_sizes = nullptr;
    Symmetric<float8> correction;
    if constexpr (gradient == Gradient::corrected) correction = correction_of(neighbors, cluster);
    PairSums<float8> sum;
    ShearSums<float8> shear;
    const int* end = lists.end(cluster);
    for (const int* at = lists.begin(cluster); at != end; ++at) {
        const Packed& j = records[*at];
        const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        add_pair<KernelLaw, terms, content, false, gradient, form>(c, i.own, dx, dy, dz, j, sum,
                                                             no_tables, variable ? root_mu[*at] : 0.0f,
                                                             &shear, no_sizes, &correction);
    }
    if constexpr (terms != Terms::rate)
        if (!no_slip.empty())
            add_no_slip<KernelLaw, content, form>(c, i, no_slip, records, cluster, no_tables, root_mu, sum,
                                            &shear);
    store_results<terms>(k, i.volume, sum, first, particles);
    if constexpr (finds_shear_rate(content))
        take_shear_rate(physics, neighbors, k.gradient, shear, first, particles);
}

template <class KernelLaw, Terms terms, Gradient gradient, ViscousForm form>
void sum_clusters(const KernelLaw& kernel, const PairPhysics& physics,
                  const Neighborhood& neighbors, const NoSlipImages& no_slip,
                  Particles& particles) {
    const double unit = neighbors.fixed().unit;
    const FluidLaw& fluid = physics.fluids[0];
    const auto c = pair_constants<float>(physics, fluid, unit);
    const auto k = factors<float>(physics, fluid, kernel.scale(), unit);
    const int clusters = neighbors.fluid_lists().clusters();
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster)
        sum_pure_cluster<KernelLaw, terms, gradient, form>(physics, c, k, neighbors, no_slip, cluster,
                                                     particles);
}

template <class KernelLaw, Terms terms, Gradient gradient, ViscousForm form, Content content,
          bool sized = false>
void sum_mixed_cluster(const PairPhysics& physics, const Mixture<float>& mixture,
                       const Neighborhood& neighbors, const NoSlipImages& no_slip,
                              int cluster, Particles& particles) {
    constexpr bool variable = variable_viscosity(content);
    const Packed* records = neighbors.records().data();
    const float* root_mu = variable ? neighbors.root_viscosity().data() : nullptr;
    const ClusterLists& lists = neighbors.fluid_lists();
    const int first = cluster * lanes, n = neighbors.fluid_count();
    Lanes i = load_cluster(records, first, n);
    if (terms != Terms::rate) switch_tension(physics, neighbors, first, i.own);
    MixedLanes m;
    look_up(mixture, records, root_mu, first, n, i.own, m);
    const OwnSize own_size(physics, sized ? &neighbors.smoothing() : nullptr, first, n);
    Symmetric<float8> correction;
    if constexpr (gradient == Gradient::corrected) correction = correction_of(neighbors, cluster);
    PairSums<float8> sum;
    ShearSums<float8> shear;
    const int* end = lists.end(cluster);
    for (const int* at = lists.begin(cluster); at != end; ++at) {
        const Packed& j = records[*at];
        const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
        const auto add = [&](const PairSize<float8>* size) __attribute__((always_inline)) {
            add_pair<KernelLaw, terms, content, sized, gradient, form>(mixture.constants, i.own, dx, dy, dz, j, sum,
                                                       &m.with[FluidTag::of(j)],
                                                       variable ? root_mu[*at] : 0.0f, &shear, size,
                                                       &correction);
        };
        if constexpr (sized) {
            const PairSize<float8> size = own_size.with(*at);
            add(&size);
        } else {
            add(nullptr);
        }
    }
    if constexpr (terms != Terms::rate)
        if (!no_slip.empty())
            add_no_slip<KernelLaw, content, form>(mixture.constants, i, no_slip, records, cluster, m.with,
                                            root_mu, sum, &shear);
    store_results<terms>(m.factors, i.volume, sum, first, particles);
    if constexpr (finds_shear_rate(content))
        take_shear_rate(physics, neighbors, mixture.gradient, shear, first, particles);
}

/// Each cluster by what it holds and meets: a cluster inside one Newtonian fluid runs as if there were
/// no other.
template <class KernelLaw, Terms terms, Gradient gradient, ViscousForm form>
void sum_mixed_clusters(const KernelLaw& kernel, const PairPhysics& physics,
                        const Neighborhood& neighbors, const NoSlipImages& no_slip,
                        ShearRate shear_rate, Particles& particles) {
    const double unit = neighbors.fixed().unit;
    const Mixture<float> mixture(physics, kernel.scale(), unit);
    PairConstants<float> c[FluidTag::most];
    Factors<float> k[FluidTag::most];
    for (std::size_t f = 0; f < physics.fluids.size(); ++f) {
        FluidLaw law = physics.fluids[f];
        if (law.viscoplastic()) law.mu = 1;   // mu is in the sums
        c[f] = pair_constants<float>(physics, law, unit);
        k[f] = factors<float>(physics, physics.fluids[f],
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
                sum_mixed_cluster<KernelLaw, terms, Gradient::plain, form, Content::several, true>(
                    physics, mixture, neighbors, no_slip, cluster, particles);
            else if constexpr (terms != Terms::rate)
                sum_mixed_cluster<KernelLaw, terms, Gradient::plain, form, Content::sheared, true>(
                    physics, mixture, neighbors, no_slip, cluster, particles);
            continue;
        }
        switch (content) {
            case Content::one_fluid: {
                const int f = only_fluid(met);
                sum_pure_cluster<KernelLaw, terms, gradient, form>(physics, c[f], k[f], neighbors,
                                                             no_slip, cluster, particles);
                break;
            }
            case Content::one_viscoplastic: {
                const int f = only_fluid(met);
                sum_pure_cluster<KernelLaw, terms, gradient, form, Content::one_viscoplastic>(
                    physics, c[f], k[f], neighbors, no_slip, cluster, particles);
                break;
            }
            case Content::one_sheared: {
                const int f = only_fluid(met);
                sum_pure_cluster<KernelLaw, terms, gradient, form, Content::one_sheared>(
                    physics, c[f], k[f], neighbors, no_slip, cluster, particles);
                break;
            }
            case Content::several:
                sum_mixed_cluster<KernelLaw, terms, gradient, form, Content::several>(
                    physics, mixture, neighbors, no_slip, cluster, particles);
                break;
            case Content::viscoplastic:
                sum_mixed_cluster<KernelLaw, terms, gradient, form, Content::viscoplastic>(
                    physics, mixture, neighbors, no_slip, cluster, particles);
                break;
            case Content::sheared:
                sum_mixed_cluster<KernelLaw, terms, gradient, form, Content::sheared>(
                    physics, mixture, neighbors, no_slip, cluster, particles);
                break;
        }
    }
}

template <Terms terms, Gradient gradient, ViscousForm form, class KernelLaw>
void sum_with(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
             const NoSlipImages& no_slip, ShearRate shear_rate, Particles& particles) {
    if (physics.mixed())
        sum_mixed_clusters<KernelLaw, terms, gradient, form>(kernel, physics, neighbors, no_slip,
                                                       shear_rate, particles);
    else
        sum_clusters<KernelLaw, terms, gradient, form>(kernel, physics, neighbors, no_slip, particles);
}

template <Terms terms, ViscousForm form, class KernelLaw>
void sum_all(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
             const NoSlipImages& no_slip, ShearRate shear_rate, Particles& particles) {
    if constexpr (terms != Terms::force)
        if (physics.gradient_correction) {
            sum_with<terms, Gradient::corrected, form>(kernel, physics, neighbors, no_slip,
                                                       shear_rate, particles);
            return;
        }
    sum_with<terms, Gradient::plain, form>(kernel, physics, neighbors, no_slip, shear_rate,
                                           particles);
}

}  // namespace

void sum_over_neighbors(const PairPhysics& physics, const Neighborhood& neighbors,
                        const NoSlipImages& no_slip, Terms terms, Particles& particles,
                        ShearRate shear_rate) {
    constexpr auto laplacian = ViscousForm::laplacian, strain = ViscousForm::strain;
    const bool along_pairs = physics.explicit_form() == strain;
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        const auto sum = [&]<Terms which, ViscousForm form>() {
            sum_all<which, form>(kernel, physics, neighbors, no_slip, shear_rate, particles);
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
}

}  // namespace undertow::sph
