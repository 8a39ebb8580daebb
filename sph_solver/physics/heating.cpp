#include "sph_solver/physics/heating.hpp"

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

template <ViscousForm form, class KernelLaw>
void sum(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors,
         std::vector<float>& heating) {
    const double unit = neighbors.fixed().unit;
    const Mixture<float> mixture(physics, kernel.scale(), unit);
    const bool variable = physics.viscoplastic(), mixed = physics.mixed(), sized = physics.sized();
    const Packed* records = neighbors.records().data();
    const float* root_mu = variable ? neighbors.root_viscosity().data() : nullptr;
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    heating.resize(std::size_t(clusters) * lanes);
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        Lanes i = load_cluster(records, first, n);
        MixedLanes m;
        look_up(mixture, records, root_mu, first, n, i.own, m, mixed);
        const OwnSize own_size(physics, sized ? &neighbors.smoothing() : nullptr, first, n);
        float8 shock{}, shear{};
        for (const int* at = lists.begin(cluster); at != lists.end(cluster); ++at) {
            const Packed& j = records[*at];
            const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const float8 vx = i.own.vx - j.vx, vy = i.own.vy - j.vy, vz = i.own.vz - j.vz;
            const Meeting<float8>& with = m.with[mixed ? FluidTag::of(j) : 0];
            const float8 r2 = (dx * dx + mixture.constants.tiny) + dy * dy + dz * dz;
            float8 F = float8{} + j.volume, length = float8{} + 1.0f, nearer2 = length;
            if (sized) {
                const PairSize<float8> size = own_size.with(*at);
                length = size.length, nearer2 = size.nearer2;
                F *= size.factor * KernelLaw::gradient_factor(r2 * size.nearer2,
                                                              mixture.constants.inverse_h);
            } else {
                F *= KernelLaw::gradient_factor(r2, mixture.constants.inverse_h);
            }
            const float8 approach = vx * dx + vy * dy + vz * dz, closing = negative_part(approach);
            const float8 per_r2 = precise_reciprocal(r2);
            shock += F * with.shock * length * (closing * closing) * per_r2;
            const float8 pair_mu =
                variable ? mean_viscosity(with.same, i.own.root_mu, root_mu[*at]) : with.mu;
            if constexpr (form == ViscousForm::strain) {
                const float8 along = positive_part(mixture.constants.near * per_r2 +
                                                   mixture.constants.far * nearer2);
                shock += F * pair_mu * (approach * approach) * along;
            } else {
                shear += F * pair_mu * (vx * vx + vy * vy + vz * vz);
            }
        }
        const float8 per_rho = i.volume * m.factors.per_mass;
        const float8 heat =
            0.5f * per_rho * (m.factors.gradient * shock + m.factors.viscous * shear);
        for (int k = 0; k < lanes; ++k) heating[first + k] = heat[k];
    }
}

}  // namespace

void dissipation(const PairPhysics& physics, const Neighborhood& neighbors,
                 std::vector<float>& heating) {
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        if (physics.explicit_form() == ViscousForm::strain)
            sum<ViscousForm::strain>(kernel, physics, neighbors, heating);
        else
            sum<ViscousForm::laplacian>(kernel, physics, neighbors, heating);
    });
}

}  // namespace undertow::sph
