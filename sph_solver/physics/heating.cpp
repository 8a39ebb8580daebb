#include "sph_solver/physics/heating.hpp"

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

template <class Real, ViscousForm form, class KernelLaw>
void sum(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
         std::vector<double>& heating) {
    using Wide = Eight<Real>;
    const double unit = neighbors.unit_in<Real>();
    const Mixture<Real> mixture(physics, kernel.scale(), unit);
    const bool variable = physics.viscoplastic(), mixed = physics.mixed(), sized = physics.sized();
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const Real* root_mu = variable ? neighbors.root_viscosity_in<Real>().data() : nullptr;
    const int n = neighbors.fluid_count(), clusters = neighbors.fluid_lists().clusters();
    heating.resize(std::size_t(clusters) * lanes);
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        Lanes<Real> i = load_cluster(records, first, n);
        MixedLanes<Real> m;
        look_up(mixture, records, root_mu, first, n, i.own, m, mixed);
        const OwnSize<Real> own_size(physics, sized ? &neighbors.smoothing_in<Real>() : nullptr,
                                     first, n);
        Wide shock{}, shear{};
        for_each_entry(neighbors, i, cluster, [&](const int* at, const auto& x) {
            const Record<Real>& j = records[*at];
            const Wide dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const Wide vx = i.own.vx - j.vx, vy = i.own.vy - j.vy, vz = i.own.vz - j.vz;
            const Meeting<Wide>& with = m.with[mixed ? FluidTag::of(j) : 0];
            const Wide r2 = (dx * dx + mixture.constants.tiny) + dy * dy + dz * dz;
            Wide F = Wide{} + j.volume, length = Wide{} + Real(1), nearer2 = length,
                 border = length;
            if (sized) {
                const PairSize<Wide> size = own_size.with(*at);
                length = size.length, nearer2 = size.nearer2, border = with.border;
                F *= size.factor *
                     KernelLaw::gradient_factor(r2 * size.nearer2, mixture.constants.inverse_h);
            } else {
                F *= KernelLaw::gradient_factor(r2, mixture.constants.inverse_h);
            }
            const Wide approach = vx * dx + vy * dy + vz * dz, closing = negative_part(approach);
            const Wide per_r2 = precise_reciprocal(r2);
            shock += F * border * with.shock * length * (closing * closing) * per_r2;
            const Wide pair_mu =
                variable ? mean_viscosity(with.same, i.own.root_mu, root_mu[*at]) : with.mu;
            if constexpr (form == ViscousForm::strain) {
                const Wide along = positive_part(mixture.constants.near * per_r2 +
                                                 mixture.constants.far * nearer2);
                shock += F * pair_mu * (approach * approach) * along;
            } else {
                shear += F * pair_mu * (vx * vx + vy * vy + vz * vz);
            }
        });
        const Wide per_rho = i.volume * m.factors.per_mass;
        const Wide heat =
            Real(0.5) * per_rho * (m.factors.gradient * shock + m.factors.viscous * shear);
        for (int k = 0; k < lanes; ++k) heating[first + k] = heat[k];
    }
}

}  // namespace

void dissipation(const PairPhysics& physics, const Neighborhood& neighbors,
                 std::vector<double>& heating) {
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        const auto in = [&]<class Real>() {
            if (physics.explicit_form() == ViscousForm::strain)
                sum<Real, ViscousForm::strain>(kernel, physics, neighbors, heating);
            else
                sum<Real, ViscousForm::laplacian>(kernel, physics, neighbors, heating);
        };
        if (neighbors.exact().used)
            in.template operator()<double>();
        else
            in.template operator()<float>();
    });
}

}  // namespace undertow::sph
