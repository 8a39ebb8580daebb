#include "sph_solver/physics/gradient_correction.hpp"

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

template <class KernelLaw>
void find(const KernelLaw& kernel, const PairPhysics& physics, Neighborhood& neighbors) {
    const double unit = neighbors.fixed().unit;
    const auto c = pair_constants<float>(physics, physics.fluids[0], unit);
    const auto to_moment = static_cast<float>(kernel.scale() / physics.lattice_moment * unit * unit);
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    std::vector<float>& found = neighbors.gradient_correction();
    found.resize(std::size_t(clusters) * 6 * lanes);
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const Lanes i = load_cluster(records, cluster * lanes, n);
        Symmetric<float8> m;
        for (const int* at = lists.begin(cluster); at != lists.end(cluster); ++at) {
            const Packed& j = records[*at];
            const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const float8 r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
            const float8 F = KernelLaw::gradient_factor(r2, c.inverse_h) * (j.volume * to_moment);
            const float8 Fx = F * dx, Fy = F * dy, Fz = F * dz;
            m.xx += dx * Fx, m.xy += dx * Fy, m.xz += dx * Fz;
            m.yy += dy * Fy, m.yz += dy * Fz, m.zz += dz * Fz;
        }
        const auto inverse = divergence_correction<float>(m, physics.dimension);
        __builtin_memcpy(&found[std::size_t(cluster) * 6 * lanes], &inverse, sizeof inverse);
    }
}

}  // namespace

void find_gradient_correction(const PairPhysics& physics, Neighborhood& neighbors) {
    with_kernel(physics.kernel, physics.h, physics.dimension,
                [&](const auto& kernel) { find(kernel, physics, neighbors); });
}

}  // namespace undertow::sph
