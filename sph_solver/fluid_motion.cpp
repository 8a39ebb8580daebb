// FluidSystem, the step in time: density, what is prescribed, kick and drift.

#include <algorithm>
#include <cmath>

#include "sph_solver/fluid_system.hpp"

namespace undertow::sph {

void FluidSystem::advance_density(double dt) {
    neighbors_.exact().used ? advance_density_in<double>(dt) : advance_density_in<float>(dt);
}

/// Real: of the sums.
template <class Real>
void FluidSystem::advance_density_in(double dt) {
    const Real* rate = particles.drho_dt.data<Real>();
    const bool heated = heated_;
    const int n = static_cast<int>(particles.size());
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
        const double drho = dt * rate[i];
        if (heated)
            particles.energy[i] += fluid_of(i).compression_work(particles.p[i], particles.drho[i],
                                                                particles.energy[i], drho);
        particles.drho[i] += drho;
        // a switch to one pass would start from this rate
        particles.rate_before[i] = rate[i];
    }
}

void FluidSystem::take_viscosity(double dt, double dt_before) {
    if (implicit_)
        implicit_->solve(physics_, neighbors_, mirror_, no_slip_, bodies,
                         0.5 * (dt + dt_before), gravity_, index_.size(), particles);
}

void FluidSystem::constrain_start(double t, double dt, double dt_before) {
    if (start_->active(t))
        start_->constrain(t, dt, 0.5 * (dt + dt_before), gravity_, particles);
}

void FluidSystem::constrain_ends(double t, double dt, double dt_before) {
    const double kick = 0.5 * (dt + dt_before);
    if (absorbing_.any()) absorbing_.damp(dt, kick, gravity_, particles);
    if (openings_.any()) openings_.prescribe(t, dt, kick, gravity_, particles);
}

Health FluidSystem::kick_and_drift(double dt, double dt_before, double dt_before_that,
                                   bool extrapolate) {
    return neighbors_.exact().used
               ? kick_and_drift_in<double>(dt, dt_before, dt_before_that, extrapolate)
               : kick_and_drift_in<float>(dt, dt_before, dt_before_that, extrapolate);
}

/// Real: of the sums.
template <class Real>
Health FluidSystem::kick_and_drift_in(double dt, double dt_before, double dt_before_that,
                                      bool extrapolate) {
    const double kick = 0.5 * (dt + dt_before);
    neighbors_.moved();
    shear_rate_age_ += dt;
    // D^n belongs to t^{n-1/2} (it sees v^{n-1/2}); the step needs it at t^{n+1/2}.
    const double w = dt_before + dt_before_that > 0 && dt_before > 0
                         ? (dt + dt_before) / (dt_before + dt_before_that) : 0;
    const Vec3 g = gravity_;
    const bool heated = heated_;
    // densities compared with that of the first fluid, so that one of them is divided by once
    const double rho0 = physics_.fluids[0].rho0;
    double relative[FluidTag::most];
    for (std::size_t f = 0; f < physics_.fluids.size(); ++f)
        relative[f] = rho0 / physics_.fluids[f].rho0;
    const int n = static_cast<int>(particles.size());
    Particles& s = particles;
    const Real *sum_x = s.ax.data<Real>(), *sum_y = s.ay.data<Real>(), *sum_z = s.az.data<Real>(),
               *sum_rate = s.drho_dt.data<Real>();
    double speed2 = 0, a2 = 0, compression = 0;
    int worst = -1;
#pragma omp parallel for schedule(static) reduction(max : speed2, a2, compression, worst)
    for (int i = 0; i < n; ++i) {
        const double ax = sum_x[i] + s.fx[i] + g[0], ay = sum_y[i] + s.fy[i] + g[1],
                     az = sum_z[i] + s.fz[i] + g[2];
        s.vx[i] += kick * ax;
        s.vy[i] += kick * ay;
        s.vz[i] += kick * az;
        s.x[i] += dt * s.vx[i];
        s.y[i] += dt * s.vy[i];
        s.z[i] += dt * s.vz[i];
        if (heated) s.energy[i] += dt * heating_[i];
        if (extrapolate) {
            const double rate = sum_rate[i];
            const double drho = dt * (rate + w * (rate - s.rate_before[i]));
            if (heated)
                s.energy[i] +=
                    fluid_of(i).compression_work(s.p[i], s.drho[i], s.energy[i], drho);
            s.drho[i] += drho;
            s.rate_before[i] = rate;
        }
        const double v2 = s.vx[i] * s.vx[i] + s.vy[i] * s.vy[i] + s.vz[i] * s.vz[i];
        speed2 = std::max(speed2, v2);
        a2 = std::max(a2, ax * ax + ay * ay + az * az);
        compression = std::max(compression, std::abs(s.drho[i]) * relative[s.fluid[i]]);
        // one comparison catches NaN and infinity in velocity and density at once
        if (!(v2 + std::abs(s.drho[i]) < 1e300)) worst = std::max(worst, i);
    }
    fastest_ = std::sqrt(speed2);
    if (!shift_.empty()) shift_.move(dt, particles);
    reach_ += (fastest_ + shift_.fastest) * dt;
    travelled_ += (fastest_ + shift_.fastest + surface_.advance(dt)) * dt;
    bodies_reach_ += bodies.fastest() * dt;
    bodies_travelled_ += bodies.fastest() * dt;
    return {fastest_, std::sqrt(a2), compression / rho0, viscous_limit(), worst < 0, worst};
}

}  // namespace undertow::sph
