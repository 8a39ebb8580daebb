#include "sph_solver/flux_meter.hpp"

#include <cmath>

namespace undertow::sph {

namespace {

/// True volume of particle i, with the thickness in 2D [m3].
double volume_of(const FluidSystem& fluid, std::size_t i) {
    const FluidLaw& law = fluid.fluid_of(i);
    return law.mass / (law.rho0 + fluid.particles.drho[i]);
}

}  // namespace

FluxMeter::FluxMeter(const SphGauge& gauge) : box_(gauge.box), normal_(0) {
    for (int a = 1; a < 3; ++a)
        if (std::abs(gauge.direction[a]) > std::abs(gauge.direction[normal_])) normal_ = a;
    forward_ = gauge.direction[normal_] > 0 ? 1 : -1;
}

/// beyond: distance past the rectangle's plane [m].
bool FluxMeter::inside(const FluidSystem& fluid, std::size_t i, double& beyond) const {
    const Particles& p = fluid.particles;
    const double at[3] = {p.x[i], p.y[i], p.z[i]};
    beyond = forward_ * (at[normal_] - box_.min[normal_]);
    for (int a = 0; a < 3; ++a) {
        if (a == normal_ || (a == 1 && fluid.physics().dimension == 2)) continue;
        if (at[a] < box_.min[a] || at[a] > box_.max[a]) return false;
    }
    return true;
}

void FluxMeter::count(const FluidSystem& fluid) {
    const double near = 2 * fluid.widest_spacing();  // further than any step
    const Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.id[i] >= static_cast<std::int64_t>(side_.size())) side_.resize(p.id[i] + 1, 0);
        std::int8_t& side = side_[p.id[i]];
        double beyond;
        if (!inside(fluid, i, beyond) || std::abs(beyond) > near) {
            side = 0;
            continue;
        }
        const std::int8_t now = beyond < 0 ? -1 : 1;
        if (side != 0 && side != now) total_ += now * volume_of(fluid, i);
        side = now;
    }
}

double FluxMeter::rate(const FluidSystem& fluid) const {
    const double h = fluid.physics().h;
    const Particles& p = fluid.particles;
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        double beyond;
        if (!inside(fluid, i, beyond) || std::abs(beyond) > h) continue;
        const double v[3] = {p.vx[i], p.vy[i], p.vz[i]};
        sum += volume_of(fluid, i) * v[normal_];
    }
    return forward_ * sum / (2 * h);
}

}  // namespace undertow::sph
