#include "sph_solver/physics/free_surface.hpp"

#include <cmath>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/physics/pair_clusters.hpp"

namespace undertow::sph {

namespace {

// Of lambda inside, d. A lattice has 0.72 in its outermost layer and 0.97 in the next (3D, 1.2 dx).
constexpr double at_surface_2d = 0.75, at_surface_3d = 0.8;
constexpr double spray = 0.5;

/// sized: a particle at rest is as large as its h says.
template <bool sized, class KernelLaw>
void find_surface(const KernelLaw& kernel, const PairPhysics& physics, Neighborhood& neighbors) {
    const double unit = neighbors.fixed().unit;
    FluidLaw first_fluid = physics.fluids[0];
    first_fluid.h = physics.h;
    const auto c = pair_constants<float>(physics, first_fluid, unit);
    const double share = physics.dimension == 2 ? at_surface_2d : at_surface_3d;
    // every particle as large as at rest: a record's volume may not be packed yet
    const double full =
        physics.dimension /
        (kernel.scale() * unit * unit *
         (sized ? std::pow(physics.fluids[0].spacing * physics.h / physics.fluids[0].h,
                           physics.dimension)
                : physics.fluids[0].volume));
    const auto limit = static_cast<float>(share * full), loose = static_cast<float>(spray * full);
    const Packed* records = neighbors.records().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    std::vector<Depth>& depth = neighbors.depth();
#pragma omp parallel for schedule(dynamic, 32)
    for (int cluster = 0; cluster < clusters; ++cluster) {
        const int first = cluster * lanes;
        const Lanes i = load_cluster(records, first, n);
        const OwnSize own_size(physics, sized ? &neighbors.smoothing() : nullptr, first, n);
        float8 lambda{};
        for_each_entry(neighbors, i, cluster, [&](const int* at, const int8& x) {
            const Packed& j = records[*at];
            const float8 dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            const float8 r2 = (dx * dx + c.tiny) + dy * dy + dz * dz;
            if constexpr (sized) {
                const PairSize<float8> size = own_size.with(*at);
                const float h_j = neighbors.smoothing()[*at] / static_cast<float>(physics.h);
                const float volume = physics.dimension == 2 ? h_j * h_j : h_j * h_j * h_j;
                lambda += KernelLaw::gradient_factor(r2 * size.nearer2, c.inverse_h) * r2 *
                          (size.factor * volume);
            } else {
                lambda += KernelLaw::gradient_factor(r2, c.inverse_h) * r2;
            }
        });
        for (int lane = 0; lane < lanes; ++lane)
            depth[first + lane] = lambda[lane] < loose   ? Depth::loose
                                  : lambda[lane] < limit ? Depth::surface
                                                         : Depth::inside;
    }
}

template <bool sized>
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
        const OwnSize own_size(physics, sized ? &neighbors.smoothing() : nullptr, first, n);
        float8 closest = float8{} + reach2;
        for_each_entry(neighbors, i, cluster, [&](const int* at, const int8& x) {
            if (*at >= n || surface[*at] < Depth::surface) return;
            const Packed& j = records[*at];
            const float8 dx = to_real(x - j.x), dy = to_real(i.y - j.y), dz = to_real(i.z - j.z);
            float8 r2 = dx * dx + dy * dy + dz * dz;
            if constexpr (sized) {
                const PairSize<float8> size = own_size.with(*at);
                r2 = r2 * size.nearer2;
            }
            closest = r2 < closest ? r2 : closest;
        });
        for (int lane = 0; lane < lanes; ++lane)
            if (depth[first + lane] == Depth::inside && closest[lane] < reach2)
                depth[first + lane] = Depth::near_surface;
    }
}

}  // namespace

void find_free_surface(const PairPhysics& physics, Neighborhood& neighbors) {
    neighbors.depth().resize(std::size_t(neighbors.fluid_lists().clusters()) * lanes);
    with_kernel(physics.kernel, physics.h, physics.dimension,
                [&](const auto& kernel) {
                    if (physics.sized())
                        find_surface<true>(kernel, physics, neighbors);
                    else
                        find_surface<false>(kernel, physics, neighbors);
                });
    if (physics.sized())
        find_near<true>(physics, neighbors);
    else
        find_near<false>(physics, neighbors);
}

}  // namespace undertow::sph
