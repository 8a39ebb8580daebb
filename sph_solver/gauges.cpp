#include "sph_solver/gauges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sph_solver/kernels/kernels.hpp"

namespace undertow::sph {

namespace {

template <class Real, class KernelLaw>
PointValue interpolate_with(const KernelLaw& kernel, const FluidSystem& fluid, const Vec3& point) {
    const Neighborhood& near = fluid.neighbors();
    const FixedPoint& fixed = near.fixed();
    const bool exact = near.exact().used;
    const double unit = near.unit_in<Real>();
    const Vec3 origin = exact ? Vec3{} : Vec3{fixed.x0, fixed.y0, fixed.z0};
    PointValue value{0, 0};
    near.for_each_near(point[0], point[1], point[2], near.support() + fluid.reach(), [&](int j) {
        const Record<Real>& q = near.records_in<Real>()[j];
        const double dx = origin[0] + q.x * unit - point[0], dy = origin[1] + q.y * unit - point[1],
                     dz = origin[2] + q.z * unit - point[2];
        double r = std::sqrt(dx * dx + dy * dy + dz * dz), w = q.volume;
        if (fluid.plates().any() &&
            fluid.plates().between(point, {point[0] + dx, point[1] + dy, point[2] + dz}))
            return;
        if (!near.smoothing().empty()) {   // W of the record's own length
            const double nearer = fluid.physics().h / near.smoothing()[j];
            r *= nearer, w *= std::pow(nearer, fluid.physics().dimension);
        }
        w *= kernel.value(r);
        value.filled += w;
        value.p += w * q.p;
    });
    value.p = value.filled > 0 ? value.p / value.filled : 0;
    return value;
}

bool has_neighbor(const FluidSystem& fluid, std::size_t i) {
    const Particles& p = fluid.particles;
    const double r2 = fluid.support() * fluid.support();
    const int own = static_cast<int>(i), count = fluid.neighbors().fluid_count();
    const ClusterLists& lists = fluid.neighbors().fluid_lists();
    bool any = false;
    lists.for_each_seen(own, [&](int j) {
        if (any || j == own || j >= count) return;
        const double dx = p.x[i] - p.x[j], dy = p.y[i] - p.y[j], dz = p.z[i] - p.z[j];
        any = dx * dx + dy * dy + dz * dz < r2;
    });
    return any;
}

}  // namespace

PointValue interpolate(const FluidSystem& fluid, const Vec3& point) {
    return with_kernel(fluid.physics().kernel, fluid.physics().h, fluid.physics().dimension,
                       [&](const auto& kernel) {
                           return fluid.neighbors().exact().used
                                      ? interpolate_with<double>(kernel, fluid, point)
                                      : interpolate_with<float>(kernel, fluid, point);
                       });
}

double front_position(const FluidSystem& fluid, const Vec3& direction) {
    const Particles& p = fluid.particles;
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    const auto along = [&](std::size_t i) {
        return (p.x[i] * direction[0] + p.y[i] * direction[1] + p.z[i] * direction[2]) / length;
    };
    // One sweep: a particle is asked for neighbors only if it lies ahead of the best one so far.
    double best = -std::numeric_limits<double>::infinity(), half = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (along(i) > best && has_neighbor(fluid, i))
            best = along(i), half = 0.5 * fluid.fluid_of(i).spacing;
    return best + half;
}

double water_level(const FluidSystem& fluid, double x, double y) {
    const Particles& p = fluid.particles;
    const double reach = fluid.support();
    double top = -std::numeric_limits<double>::infinity(), bottom = -top;
    for (std::size_t i = 0; i < p.size(); ++i) {
        bottom = std::min(bottom, p.z[i]);
        const double dx = p.x[i] - x, dy = p.y[i] - y;
        if (dx * dx + dy * dy < reach * reach) top = std::max(top, p.z[i]);
    }
    const double floor = bottom - 0.5 * fluid.spacing();
    if (top < bottom) return floor;   // dry
    const double step = 0.25 * fluid.spacing();
    double above = top + reach, value_above = 0;
    while (above > floor) {
        const double z = above - step;
        const double value = interpolate(fluid, {x, y, z}).filled;
        if (value >= 0.5)   // linear between the two samples
            return z + step * (value - 0.5) / std::max(1e-12, value - value_above);
        above = z, value_above = value;
    }
    return floor;
}

}  // namespace undertow::sph
