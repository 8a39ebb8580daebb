#include "sph_solver/boundary/body_fluid.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

struct Continued {
    double weight = 0;              // sum of W
    double pressure = 0;            // sum of W (p + hydrostatic part)
    double u[3] = {0, 0, 0};        // sum of W v
    double viscosity = 0;           // sum of W mu
    Vec3 offset{};                  // sum of W (x_f - x_w) [m]
    double share[FluidTag::most] = {};   // of `weight`, by fluid
};

void set(Bodies& bodies, int d, double h, const Continued& sum) {
    const Pose& pose = bodies.body[bodies.owner[d]].pose();
    const Vec3 wall = pose.velocity_at({bodies.x[d], bodies.y[d], bodies.z[d]});
    Vec3 v = wall;
    if (sum.weight > 0) {
        const double off = length(sum.offset);
        const Vec3 away = off > 0.1 * h * sum.weight ? (1 / off) * sum.offset
                                                     : pose.direction(bodies.away_at_rest[d]);
        const Vec3 mean{sum.u[0] / sum.weight, sum.u[1] / sum.weight, sum.u[2] / sum.weight};
        v = mean - 2 * dot(mean - wall, away) * away;
    }
    bodies.vx[d] = v[0], bodies.vy[d] = v[1], bodies.vz[d] = v[2];
    bodies.p[d] = sum.weight > 0 ? std::max(0.0, sum.pressure / sum.weight) : 0;
    bodies.viscosity[d] = static_cast<float>(sum.weight > 0 ? sum.viscosity / sum.weight : 0);
    bodies.fluid[d] = static_cast<std::uint8_t>(
        std::max_element(sum.share, sum.share + FluidTag::most) - sum.share);
}

template <class KernelLaw>
void continue_with(const KernelLaw& kernel, const PairPhysics& physics, const Neighborhood& neighbors, Bodies& bodies) {
    const std::vector<int>& targets = neighbors.body_targets();
    const ClusterLists& lists = neighbors.body_lists();
    const std::vector<Packed>& records = neighbors.records();
    const std::vector<Extra>& extras = neighbors.extras();
    const FixedPoint& fixed = neighbors.fixed();
    const int fluid_count = neighbors.fluid_count();
    const double r_max2 = 4 * physics.h * physics.h;
    const bool viscous = physics.viscoplastic(), mixed = physics.mixed();
    const int n = static_cast<int>(targets.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (int k = 0; k < n; ++k) {
        const int d = targets[k];
        const double px = (bodies.x[d] - fixed.x0) / fixed.unit,
                     py = (bodies.y[d] - fixed.y0) / fixed.unit,
                     pz = (bodies.z[d] - fixed.z0) / fixed.unit;
        const Vec3 a_w = bodies.body[bodies.owner[d]].pose().acceleration_at(
            {bodies.x[d], bodies.y[d], bodies.z[d]});
        const Vec3 g = physics.gravity - a_w;
        Continued sum;
        for (const int* at = lists.begin(k / lanes); at != lists.end(k / lanes); ++at) {
            if (*at >= fluid_count && extras[*at - fluid_count].from_body) continue;
            const Packed& q = records[*at];
            const double dx = (px - q.x) * fixed.unit, dy = (py - q.y) * fixed.unit,
                         dz = (pz - q.z) * fixed.unit;
            const double r2 = dx * dx + dy * dy + dz * dz;
            if (r2 >= r_max2) continue;
            const double w = kernel.value(std::sqrt(r2));
            sum.weight += w;
            const std::uint32_t own = mixed ? FluidTag::of(q) : 0;
            sum.share[own] += w;
            if (viscous) sum.viscosity += w * neighbors.viscosity()[*at];
            sum.pressure +=
                w * (q.p + physics.fluids[own].rho0 * (g[0] * dx + g[1] * dy + g[2] * dz));
            sum.offset = sum.offset - w * Vec3{dx, dy, dz};
            sum.u[0] += w * q.vx, sum.u[1] += w * q.vy, sum.u[2] += w * q.vz;
        }
        set(bodies, d, physics.h, sum);
    }
}

}  // namespace

void continue_into_bodies(const PairPhysics& physics, const Neighborhood& neighbors,
                          Bodies& bodies) {
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        continue_with(kernel, physics, neighbors, bodies);
    });
}

}  // namespace undertow::sph
