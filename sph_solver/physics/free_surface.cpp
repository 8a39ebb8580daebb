#include "sph_solver/physics/free_surface.hpp"

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

// Of lambda inside, d. A lattice has 0.72 in its outermost layer and 0.97 in the next (3D, 1.2 dx).
constexpr double at_surface_2d = 0.75, at_surface_3d = 0.8;
constexpr double spray = 0.5;

template <class KernelLaw>
void find_surface(const KernelLaw& kernel, const PairPhysics& physics, Neighborhood& neighbors) {
    const double unit = neighbors.fixed().unit;
    const auto c = pair_constants<float>(physics, physics.fluids[0], unit);
    const double share = physics.dimension == 2 ? at_surface_2d : at_surface_3d;
    // every particle as large as at rest: a record's volume may not be packed yet
    const double full =
        physics.dimension / (kernel.scale() * unit * unit * physics.fluids[0].volume);
    const auto limit = static_cast<float>(share * full), loose = static_cast<float>(spray * full);
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    std::vector<Depth>& depth = neighbors.depth();
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        const Lanes i = load_cluster(records, first, n);
        float8 lambda{};
        for (const int* at = lists.begin(cluster); at != lists.end(cluster); ++at) {
            const Packed& j = records[*at];
            const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const float8 r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
            lambda += KernelLaw::gradient_factor(r2, c.inverse_h) * r2;
        }
        for (int lane = 0; lane < lanes; ++lane)
            depth[first + lane] = lambda[lane] < loose   ? Depth::loose
                                  : lambda[lane] < limit ? Depth::surface
                                                         : Depth::inside;
    }
}

void find_near(const PairPhysics& physics, Neighborhood& neighbors) {
    const double reach = 2 * physics.h / neighbors.fixed().unit;
    const auto reach2 = static_cast<float>(reach * reach);
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    std::vector<Depth>& depth = neighbors.depth();
    const std::vector<Depth> surface = depth;  // to read from while others write
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        const Lanes i = load_cluster(records, first, n);
        float8 closest = float8{} + reach2;
        for (const int* at = lists.begin(cluster); at != lists.end(cluster); ++at) {
            if (*at >= n || surface[*at] < Depth::surface) continue;
            const Packed& j = records[*at];
            const float8 dx = to_real(i.x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const float8 r2 = dx * dx + dy * dy + dz * dz;
            closest = r2 < closest ? r2 : closest;
        }
        for (int lane = 0; lane < lanes; ++lane)
            if (depth[first + lane] == Depth::inside && closest[lane] < reach2)
                depth[first + lane] = Depth::near_surface;
    }
}

}  // namespace

void find_free_surface(const PairPhysics& physics, Neighborhood& neighbors) {
    neighbors.depth().resize(std::size_t(neighbors.fluid_lists().clusters()) * lanes);
    with_kernel(physics.kernel, physics.h, physics.dimension,
                [&](const auto& kernel) { find_surface(kernel, physics, neighbors); });
    find_near(physics, neighbors);
}

}  // namespace undertow::sph
