#include "sph_solver/boundary/body_fluid.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/kernels/kernels.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

struct Continued {
    double weight = 0;                  // sum of W
    double pressure = 0;                // sum of W (p + hydrostatic part)
    double moving = 0;                  // sum of V F
    double u[3] = {0, 0, 0};            // sum of V F v, reflected
    double viscosity = 0;               // sum of W mu
    double share[FluidTag::most] = {};  // of `weight`, by fluid
};

/// Reflected velocity of a record: of a particle, or of its image.   [m/s]
Vec3 shown(int record, const Neighborhood& neighbors, const MirrorPlanes& mirror,
           const std::vector<Vec3>& reflected) {
    if (record < neighbors.fluid_count()) return reflected[record];
    const Extra& extra = neighbors.extras()[record - neighbors.fluid_count()];
    const Vec3& v = reflected[extra.source];
    const auto& m = mirror.reflection(extra.mask).m;
    return {m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
            m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
            m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2]};
}

void set(Bodies& bodies, int d, const Continued& sum) {
    const Pose& pose = bodies.body[bodies.owner[d]].pose();
    Vec3 v = pose.velocity_at({bodies.x[d], bodies.y[d], bodies.z[d]});
    if (sum.moving > 0) v = {sum.u[0] / sum.moving, sum.u[1] / sum.moving, sum.u[2] / sum.moving};
    bodies.vx[d] = v[0], bodies.vy[d] = v[1], bodies.vz[d] = v[2];
    bodies.p[d] = sum.weight > 0 ? std::max(0.0, sum.pressure / sum.weight) : 0;
    bodies.viscosity[d] = sum.weight > 0 ? sum.viscosity / sum.weight : 0;
    bodies.fluid[d] = static_cast<std::uint8_t>(
        std::max_element(sum.share, sum.share + FluidTag::most) - sum.share);
}

template <class Real, class KernelLaw>
void continue_with(const KernelLaw& kernel, const PairPhysics& physics,
                   const Neighborhood& neighbors, const MirrorPlanes& mirror,
                   const std::vector<Vec3>& reflected, Bodies& bodies) {
    const std::vector<int>& targets = neighbors.body_targets();
    const ClusterLists& lists = neighbors.body_lists();
    const std::vector<Record<Real>>& records = neighbors.records_in<Real>();
    const std::vector<Extra>& extras = neighbors.extras();
    const int fluid_count = neighbors.fluid_count();
    const bool sized = physics.sized();
    const bool viscous = physics.viscoplastic(), mixed = physics.mixed();
    const int n = static_cast<int>(targets.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (int k = 0; k < n; ++k) {
        const int d = targets[k];
        const Vec3 at_dummy{bodies.x[d], bodies.y[d], bodies.z[d]};
        const Vec3 a_w = bodies.body[bodies.owner[d]].pose().acceleration_at(
            {bodies.x[d], bodies.y[d], bodies.z[d]});
        const Vec3 g = physics.gravity - a_w;
        Continued sum;
        lists.for_each_seen(k, [&](int record) {
            if (record >= fluid_count && extras[record - fluid_count].from_body) return;
            const Record<Real>& q = records[record];
            const auto [dx, dy, dz] = neighbors.apart(at_dummy, q);
            const double r2 = dx * dx + dy * dy + dz * dz;
            // dummies have the size of sph.spacing
            const double nearer =
                sized ? 2 * physics.h / (physics.h + neighbors.smoothing_in<Real>()[record]) : 1;
            if (r2 * nearer * nearer >= 4 * physics.h * physics.h) return;
            // where sizes differ, a weight counts by volume
            const double w = kernel.value(nearer * std::sqrt(r2)) *
                             (sized ? std::pow(nearer, physics.dimension) * q.volume : 1);
            sum.weight += w;
            const std::uint32_t own = mixed ? FluidTag::of(q) : 0;
            sum.share[own] += w;
            if (viscous) {
                const Real root_mu = neighbors.root_viscosity_in<Real>()[record];
                sum.viscosity += w * root_mu * root_mu;
            }
            sum.pressure +=
                w * (q.p + physics.fluids[own].rho0 * (g[0] * dx + g[1] * dy + g[2] * dz));
            const Vec3 v = shown(record, neighbors, mirror, reflected);
            // the weight of a viscous pair: then the dummy as a whole takes no shear force
            const double f = q.volume * KernelLaw::gradient_factor(r2 * nearer * nearer, 1 / physics.h) *
                             (sized ? std::pow(nearer, physics.dimension + 2) : 1);
            sum.moving += f;
            for (int a = 0; a < 3; ++a) sum.u[a] += f * v[a];
        });
        set(bodies, d, sum);
    }
}

}  // namespace

void continue_into_bodies(const PairPhysics& physics, const Neighborhood& neighbors,
                          const MirrorPlanes& mirror, const std::vector<Vec3>& reflected,
                          Bodies& bodies) {
    with_kernel(physics.kernel, physics.h, physics.dimension, [&](const auto& kernel) {
        if (neighbors.exact().used)
            continue_with<double>(kernel, physics, neighbors, mirror, reflected, bodies);
        else
            continue_with<float>(kernel, physics, neighbors, mirror, reflected, bodies);
    });
}

}  // namespace undertow::sph
