#include "sph_solver/physics/gradient_correction.hpp"

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

template <class KernelLaw, class Real>
void find(const KernelLaw& kernel, const PairPhysics& physics, Neighborhood& neighbors,
          std::vector<Real>& found) {
    using Wide = Eight<Real>;
    const double unit = neighbors.unit_in<Real>();
    const auto c = pair_constants<Real>(physics, physics.fluids[0], unit);
    const auto to_moment = static_cast<Real>(kernel.scale() / physics.lattice_moment * unit * unit);
    const Record<Real>* records = neighbors.records_in<Real>().data();
    const int n = neighbors.fluid_count(), clusters = neighbors.fluid_lists().clusters();
    found.resize(std::size_t(clusters) * 6 * lanes);
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const auto i = load_cluster(records, cluster * lanes, n);
        Symmetric<Wide> m;
        for_each_entry(neighbors, i, cluster, [&](const int* at, const auto& x) {
            const Record<Real>& j = records[*at];
            const Wide dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const Wide r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
            const Wide F = KernelLaw::gradient_factor(r2, c.inverse_h) * (j.volume * to_moment);
            const Wide Fx = F * dx, Fy = F * dy, Fz = F * dz;
            m.xx += dx * Fx, m.xy += dx * Fy, m.xz += dx * Fz;
            m.yy += dy * Fy, m.yz += dy * Fz, m.zz += dz * Fz;
        });
        const auto inverse = divergence_correction<Real>(m, physics.dimension);
        __builtin_memcpy(&found[std::size_t(cluster) * 6 * lanes], &inverse, sizeof inverse);
    }
}

}  // namespace

void find_gradient_correction(const PairPhysics& physics, Neighborhood& neighbors) {
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        if (neighbors.exact().used)
            find(kernel, physics, neighbors, neighbors.exact().gradient_correction);
        else
            find(kernel, physics, neighbors, neighbors.gradient_correction());
    });
}

}  // namespace undertow::sph
