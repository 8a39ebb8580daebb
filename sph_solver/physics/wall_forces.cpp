// What the fluids press on rigid walls, from the same pair terms as the sums.

#include "sph_solver/physics/wall_forces.hpp"

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

/// Calls f(extra, ax, ay, az) with the accelerations that the eight get from each image and dummy.
template <class KernelLaw, Content content, class OfOwn, class F>
void for_each_image(const PairConstants<float>& c, const Factors<float, OfOwn>& k, const Lanes& i,
                    const Meeting<float8>* with, const Neighborhood& neighbors, int cluster,
                    PlaneMask planes, F&& f) {
    constexpr bool variable = content == Content::viscoplastic;
    const float* mu = variable ? neighbors.viscosity().data() : nullptr;
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count();
    for (const int* at = lists.begin(cluster); at != lists.end(cluster); ++at) {
        if (*at < n) continue;
        const Extra& extra = neighbors.extras()[*at - n];
        if ((extra.mask & planes) == 0 && !extra.from_body) continue;  // by translation only
        const Packed& j = records[*at];
        PairSums<float8> sum;
        add_pair<KernelLaw, Terms::force, content>(
            c, i.own, to_real(i.x - j.x), to_real(i.y - j.y), to_real(i.z - j.z), j, sum,
            with ? with + FluidTag::of(j) : nullptr, variable ? mu[*at] : 0.0f);
        const float8 per_rho = i.volume * k.per_mass;
        float8 ax, ay, az;
        acceleration(k, per_rho, sum, ax, ay, az);
        f(extra, ax, ay, az);
    }
}

template <class KernelLaw>
std::vector<Vec3> force_on_walls(const KernelLaw& kernel, const PairPhysics& physics,
                                 const Neighborhood& neighbors, const MirrorPlanes& mirror,
                                 const Bodies& bodies) {
    const double unit = neighbors.fixed().unit;
    const FluidLaw& first_fluid = physics.fluids[0];
    const auto c = pair_constants<float>(physics, first_fluid, unit);
    const auto k = factors<float>(physics, first_fluid, kernel.scale(), unit);
    const Mixture<float> mixture(physics, kernel.scale(), unit);
    const bool mixed = physics.mixed(), variable = physics.viscoplastic();
    const Packed* records = neighbors.records().data();
    const int n = neighbors.fluid_count(), clusters = neighbors.fluid_lists().clusters();
    const std::size_t planes = mirror.size(), fluids = physics.fluids.size();
    const PlaneMask any_plane = (PlaneMask(1) << planes) - 1;
    const std::size_t all = (planes + bodies.count()) * fluids;
    // per cluster first, then summed in order: the same bits for any number of threads
    std::vector<Vec3> part(clusters * all, Vec3{});

#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes, members = std::min(lanes, n - first);
        Lanes i = load_cluster(records, first, n);
        Vec3* force = &part[cluster * all];
        const auto add = [&](const Extra& extra, float8 ax, float8 ay, float8 az) {
            double a[FluidTag::most][3] = {};
            for (int lane = 0; lane < members; ++lane) {
                double* of = a[mixed ? FluidTag::of(records[first + lane]) : 0];
                of[0] += ax[lane], of[1] += ay[lane], of[2] += az[lane];
            }
            for (std::size_t p = 0; p < planes; ++p) {
                if (!(extra.mask >> p & 1)) continue;
                const Vec3& normal = mirror.plane(static_cast<int>(p)).normal;
                for (std::size_t f = 0; f < fluids; ++f) {
                    const double along =
                        a[f][0] * normal[0] + a[f][1] * normal[1] + a[f][2] * normal[2];
                    for (int b = 0; b < 3; ++b) {
                        force[p * fluids + f][b] -= physics.fluids[f].mass * along * normal[b];
                        if (extra.from_body) a[f][b] -= along * normal[b];
                    }
                }
            }
            if (!extra.from_body) return;
            const std::size_t w = planes + bodies.owner[extra.source];
            for (std::size_t f = 0; f < fluids; ++f)
                for (int b = 0; b < 3; ++b)
                    force[w * fluids + f][b] -= physics.fluids[f].mass * a[f][b];
        };
        if (!mixed) {
            for_each_image<KernelLaw, Content::one_fluid>(c, k, i, nullptr, neighbors, cluster,
                                                          any_plane, add);
            continue;
        }
        MixedLanes m;
        look_up(mixture, records, variable ? neighbors.viscosity().data() : nullptr, first, n,
                i.own, m);
        if (variable)
            for_each_image<KernelLaw, Content::viscoplastic>(
                mixture.constants, m.factors, i, m.with, neighbors, cluster, any_plane, add);
        else
            for_each_image<KernelLaw, Content::several>(mixture.constants, m.factors, i, m.with,
                                                        neighbors, cluster, any_plane, add);
    }
    std::vector<Vec3> force(all, Vec3{});
    for (int cluster = 0; cluster < clusters; ++cluster)
        for (std::size_t p = 0; p < all; ++p)
            for (int b = 0; b < 3; ++b) force[p][b] += part[cluster * all + p][b];
    return force;
}

}  // namespace

std::vector<Vec3> wall_forces(const PairPhysics& physics, const Neighborhood& neighbors,
                              const MirrorPlanes& mirror, const Bodies& bodies) {
    return with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        return force_on_walls(kernel, physics, neighbors, mirror, bodies);
    });
}

}  // namespace undertow::sph
