#include "sph_solver/fluid_system.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sph_solver/boundary/body_fluid.hpp"
#include "sph_solver/setup/fill.hpp"
#include "sph_solver/physics/wall_forces.hpp"
#include "sph_solver/shapes/vectors.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

// Lists [steps] that wear out early get the wide skin [dx], those that last the narrow one.
constexpr int short_lived = 8, long_lived = 40;
constexpr double narrow_skin = 0.2, wide_skin = 0.4;

PairPhysics resolve_physics(const Case& input) {
    PairPhysics p;
    p.kernel = input.sph.kernel;
    p.h = input.sph.smoothing_ratio * input.sph.spacing;
    p.dimension = input.info.dimension;
    p.artificial_viscosity = input.sph.artificial_viscosity;
    p.density_diffusion = input.sph.density_diffusion;
    p.gravity = balanced_gravity(input);
    p.fluids = resolve_fluids(input);
    return p;
}

}  // namespace

FluidSystem::FluidSystem(const Case& input, double skin_over_spacing)
    : physics_(resolve_physics(input)),
      gravity_(input.info.gravity),
      tag_(physics_.mixed()),
      heated_(std::any_of(physics_.fluids.begin(), physics_.fluids.end(),
                          [](const FluidLaw& f) { return f.us_up.gamma0 != 0; })),
      filled_(physics_.fluids.size(), 0),
      spacing_(input.sph.spacing),
      mirror_(input.sph.plane,
              Periodic(input.sph.periodic, input.sph.domain, 2 * physics_.h)),
      neighbors_(2 * physics_.h, skin_over_spacing * spacing_, spacing_),
      with_surface_images_(input.sph.surface_images),
      domain_(input.sph.domain),
      near_walls_(spacing_, mirror_.size(), static_cast<int>(input.sph.body.size()),
                  static_cast<int>(physics_.fluids.size())) {
    Filled filled = fill_particles(input, physics_.fluids);
    particles = std::move(filled.particles);
    start_.emplace(input, std::move(filled.first_id), largest_sound_speed());
    bodies = make_bodies(input);
    index_.resize(particles.size());
    surface_.expect(particles.size());
    if (physics_.viscoplastic()) {
        particles.viscosity.resize(1);   // in use from now on
        particles.resize(particles.size());
    }
    for (std::size_t i = 0; i < particles.size(); ++i) {
        index_[i] = static_cast<int>(i);
        fastest_ = std::max(fastest_,
                            std::hypot(particles.vx[i], particles.vy[i], particles.vz[i]));
        particles.p[i] = fluid_of(i).pressure(particles.drho[i], particles.energy[i]);
        ++filled_[particles.fluid[i]];
        if (!particles.viscosity.empty())
            particles.viscosity[i] = static_cast<float>(fluid_of(i).viscosity_at_rest());
        for (int k = 0; k < mirror_.size(); ++k)
            if (mirror_.distance(k, particles.x[i], particles.y[i], particles.z[i]) < 0)
                throw InputError(fmt::format(
                    "{}: sph.fill puts a particle at ({:.4g}, {:.4g}, {:.4g}), behind sph.plane "
                    "\"{}\": its normal must point into the fluid.", input.file, particles.x[i],
                    particles.y[i], particles.z[i], mirror_.plane(k).name));
    }
    if (input.sph.lattice == FillLattice::relaxed) {
        relaxation_ = relax(*this, input);
        for (std::size_t i = 0; i < particles.size(); ++i)
            particles.p[i] = fluid_of(i).pressure(particles.drho[i], particles.energy[i]);
        reach_ = 1e300, rebuilds_ = 0, list_age_ = 0;
    }
}

void FluidSystem::sum_under_even_pressure() {
    refresh_neighbors(0);
    pack(0);
    for (Packed& q : neighbors_.records()) q.p = 1, q.vx = q.vy = q.vz = 0;
    undertow::sph::sum_over_neighbors(physics_, neighbors_, Terms::force, particles);
}

bool FluidSystem::refresh_neighbors(double t) {
    ++list_age_;
    if (!neighbors_.due(reach_)) return false;
    // where a step moves a particle far, longer lists cost less than frequent ones
    if (rebuilds_ > 0 && list_age_ < short_lived) neighbors_.set_skin(wide_skin * spacing_);
    if (list_age_ > long_lived) neighbors_.set_skin(narrow_skin * spacing_);
    list_age_ = 0;
    bodies.move_to(t);
    bodies.wrap(periodic());
    keep_inside();
    neighbors_.rebuild(particles, bodies, mirror_);
    if (physics_.mixed()) neighbors_.find_fluids(particles);
    for (std::size_t i = 0; i < particles.size(); ++i)
        index_[particles.id[i]] = static_cast<int>(i);
    const FixedPoint& fixed = neighbors_.fixed();
    const double origin[3] = {fixed.x0, fixed.y0, fixed.z0};
    mirror_.to_fixed(origin, fixed.unit, fixed_reflections_);
    near_walls_.find(particles, mirror_, bodies, index_, neighbors_.skin());
    surface_.expire();
    reach_ = 0;
    ++rebuilds_;
    return true;
}

void FluidSystem::pack(double t) {
#pragma omp parallel
    {
        pack_fluid();
        pack_extras(false);   // from the records just packed
    }
    bodies.move_to(t);
    if (neighbors_.body_targets().empty()) return;   // no body is near the fluid
    near_walls_.reflect(particles, bodies, reflected_);
    continue_into_bodies(physics_, neighbors_, mirror_, reflected_, bodies);
#pragma omp parallel
    pack_extras(true);
}

/// To be called by all threads of a parallel region: each packs its share.
void FluidSystem::pack_fluid() {
    Packed* records = neighbors_.records().data();
    Particles& s = particles;
    const auto pack_one = [&s, records, fixed = neighbors_.fixed(), tag = tag_](
                              int i, const FluidLaw& fluid, double mass) {
        s.p[i] = fluid.pressure(s.drho[i], s.energy[i]);
        Packed& q = records[i];
        q.x = fixed(s.x[i], fixed.x0);
        q.y = fixed(s.y[i], fixed.y0);
        q.z = fixed(s.z[i], fixed.z0);
        q.volume = tag(mass / (fluid.rho0 + s.drho[i]), s.fluid[i]);
        q.vx = static_cast<float>(s.vx[i]);
        q.vy = static_cast<float>(s.vy[i]);
        q.vz = static_cast<float>(s.vz[i]);
        q.p = static_cast<float>(s.p[i]);
    };
    const int n = static_cast<int>(s.size());
    if (physics_.fluids.size() == 1) {
        const FluidLaw fluid = physics_.fluids[0];
        const double mass = fluid.rho0 * fluid.volume;
#pragma omp for schedule(static)
        for (int i = 0; i < n; ++i) pack_one(i, fluid, mass);
    } else {
        const FluidLaw* fluids = physics_.fluids.data();
#pragma omp for schedule(static)
        for (int i = 0; i < n; ++i) {
            const FluidLaw& fluid = fluids[s.fluid[i]];
            pack_one(i, fluid, fluid.rho0 * fluid.volume);
        }
    }
    if (s.viscosity.empty()) return;
#pragma omp for schedule(static)
    for (int i = 0; i < n; ++i) neighbors_.viscosity()[i] = s.viscosity[i];
}

/// Images show mirrored position and velocity and the hydrostatically continued pressure
/// p' = p + rho0 g . (x' - x), so that the wall carries the weight above it without an inflow.
void FluidSystem::pack_extras(bool of_bodies) {
    const FixedPoint fixed = neighbors_.fixed();
    const FluidTag tag = tag_;
    const Vec3& g = physics_.gravity;
    float slope[FluidTag::most][3];   // of the hydrostatic pressure [Pa/unit]
    for (std::size_t f = 0; f < physics_.fluids.size(); ++f)
        for (int a = 0; a < 3; ++a)
            slope[f][a] = static_cast<float>(physics_.fluids[f].rho0 * g[a] * fixed.unit);
    const bool viscous = !particles.viscosity.empty(), single = physics_.fluids.size() == 1;
    const Packed* fluid_records = neighbors_.records().data();
    Packed* records = neighbors_.records().data() + neighbors_.first_extra();
    float* viscosity = neighbors_.viscosity().data() + (viscous ? neighbors_.first_extra() : 0);
    const std::vector<Extra>& extras = neighbors_.extras();
    const int n = static_cast<int>(extras.size());
#pragma omp for schedule(static)
    for (int e = 0; e < n; ++e) {
        const int s = extras[e].source;
        const bool body = extras[e].from_body;
        if (body != of_bodies) continue;
        const std::uint8_t own = single ? 0 : body ? bodies.fluid[s] : particles.fluid[s];
        if (viscous) viscosity[e] = body ? bodies.viscosity[s] : particles.viscosity[s];
        const FixedReflection& mirror = fixed_reflections_[extras[e].mask];
        if (!body && mirror.diagonal) {   // the usual tank: from record to record
            const Packed from = fluid_records[s];
            Packed& q = records[e];
            q.x = mirror.sign[0] * from.x + mirror.offset[0];
            q.y = mirror.sign[1] * from.y + mirror.offset[1];
            q.z = mirror.sign[2] * from.z + mirror.offset[2];
            q.volume = from.volume;
            q.vx = static_cast<float>(mirror.sign[0]) * from.vx;
            q.vy = static_cast<float>(mirror.sign[1]) * from.vy;
            q.vz = static_cast<float>(mirror.sign[2]) * from.vz;
            q.p = from.p + slope[own][0] * static_cast<float>(q.x - from.x) +
                  slope[own][1] * static_cast<float>(q.y - from.y) +
                  slope[own][2] * static_cast<float>(q.z - from.z);
            continue;
        }
        const double x = body ? bodies.x[s] : particles.x[s];
        const double y = body ? bodies.y[s] : particles.y[s];
        const double z = body ? bodies.z[s] : particles.z[s];
        const double vx = body ? bodies.vx[s] : particles.vx[s];
        const double vy = body ? bodies.vy[s] : particles.vy[s];
        const double vz = body ? bodies.vz[s] : particles.vz[s];
        const double p = body ? bodies.p[s] : particles.p[s];
        const double drho = body ? 0 : particles.drho[s];
        const FluidLaw& fluid = physics_.fluids[own];
        const double gx = fluid.rho0 * g[0], gy = fluid.rho0 * g[1], gz = fluid.rho0 * g[2];
        const Reflection& r = mirror_.reflection(extras[e].mask);
        const double ix = r.m[0][0] * x + r.m[0][1] * y + r.m[0][2] * z + r.t[0];
        const double iy = r.m[1][0] * x + r.m[1][1] * y + r.m[1][2] * z + r.t[1];
        const double iz = r.m[2][0] * x + r.m[2][1] * y + r.m[2][2] * z + r.t[2];
        Packed& q = records[e];
        q.x = fixed(ix, fixed.x0);
        q.y = fixed(iy, fixed.y0);
        q.z = fixed(iz, fixed.z0);
        const double share = body ? bodies.share[s] : 1;
        q.volume = tag(share * fluid.rho0 * fluid.volume / (fluid.rho0 + drho), own);
        q.vx = static_cast<float>(r.m[0][0] * vx + r.m[0][1] * vy + r.m[0][2] * vz);
        q.vy = static_cast<float>(r.m[1][0] * vx + r.m[1][1] * vy + r.m[1][2] * vz);
        q.vz = static_cast<float>(r.m[2][0] * vx + r.m[2][1] * vy + r.m[2][2] * vz);
        q.p = static_cast<float>(p + gx * (ix - x) + gy * (iy - y) + gz * (iz - z));
    }
}

void FluidSystem::add_wall_friction() {
    near_walls_.add_stress(physics_, mirror_, bodies, particles);
}

void FluidSystem::add_coulomb_friction(double dt, double dt_before) {
    near_walls_.add_coulomb(physics_, gravity_, mirror_, bodies, 0.5 * (dt + dt_before), particles);
}

std::vector<Vec3> FluidSystem::wall_forces() const {
    std::vector<Vec3> force = undertow::sph::wall_forces(physics_, neighbors_, mirror_, bodies);
    for (std::size_t k = 0; k < force.size(); ++k) force[k] = force[k] + near_walls_.shear(k);
    return force;
}

void FluidSystem::place_surface(std::vector<std::int32_t> quad, std::vector<double> x) {
    for (const Periodic::Axis& a : periodic().axes())
        for (const std::int32_t node : quad) {
            const double at = x[3 * std::size_t(node) + a.axis];
            const double room = std::min(at - a.low, a.low + a.length - at);
            if (room >= support()) continue;
            throw InputError(fmt::format(
                "sph.periodic: the coupled surface reaches {0} = {1:.6g} m, {2:.4g} m from a face "
                "of the period; it must stay {3:.4g} m, the support of the kernel, inside, "
                "because contact does not see across the face: enlarge sph.domain along {0} or "
                "take \"{0}\" out of sph.periodic.",
                std::string(1, "xyz"[a.axis]), at, room, support()));
        }
    if (with_surface_images_) surface_.place(std::move(quad), std::move(x));
}

Vec3 FluidSystem::contact_point(int i) const {
    const SurfaceImages::Lift& l = surface_.lift(particles.id[i]);
    return {particles.x[i] - l.e[0], particles.y[i] - l.e[1], particles.z[i] - l.e[2]};
}

Vec3 FluidSystem::contact_velocity(int i) const {
    const SurfaceImages::Lift& l = surface_.lift(particles.id[i]);
    return {particles.vx[i] - l.rate[0], particles.vy[i] - l.rate[1],
            particles.vz[i] - l.rate[2]};
}

void FluidSystem::sum_over_neighbors(Terms terms) {
    undertow::sph::sum_over_neighbors(physics_, neighbors_, terms, particles);
    if (!surface_.placed()) return;
    if (surface_.stale()) surface_.find_pairs(particles, neighbors_, spacing_);
    surface_.add(physics_, neighbors_, terms, particles);
}

void FluidSystem::advance_density(double dt) {
    const bool heated = heated_;
    const int n = static_cast<int>(particles.size());
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) {
        const double drho = dt * particles.drho_dt[i];
        if (heated) {
            const double rho = fluid_of(i).rho0 + particles.drho[i];
            particles.energy[i] += particles.p[i] / (rho * rho) * drho;
        }
        particles.drho[i] += drho;
        // a switch to one pass would start from this rate
        particles.rate_before[i] = particles.drho_dt[i];
    }
}

void FluidSystem::constrain_start(double t, double dt, double dt_before) {
    if (start_->active(t))
        start_->constrain(t, dt, 0.5 * (dt + dt_before), gravity_, particles);
}

Health FluidSystem::kick_and_drift(double dt, double dt_before, double dt_before_that,
                                   bool extrapolate) {
    const double kick = 0.5 * (dt + dt_before);
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
    double speed2 = 0, a2 = 0, compression = 0;
    int worst = -1;
#pragma omp parallel for schedule(static) reduction(max : speed2, a2, compression, worst)
    for (int i = 0; i < n; ++i) {
        const double ax = s.ax[i] + s.fx[i] + g[0], ay = s.ay[i] + s.fy[i] + g[1],
                     az = s.az[i] + s.fz[i] + g[2];
        s.vx[i] += kick * ax;
        s.vy[i] += kick * ay;
        s.vz[i] += kick * az;
        s.x[i] += dt * s.vx[i];
        s.y[i] += dt * s.vy[i];
        s.z[i] += dt * s.vz[i];
        if (extrapolate) {
            const double rate = s.drho_dt[i];
            const double drho = dt * (rate + w * (rate - s.rate_before[i]));
            if (heated) {
                const double rho = fluid_of(i).rho0 + s.drho[i];
                s.energy[i] += s.p[i] / (rho * rho) * drho;   // dE = p d(rho)/rho^2, adiabatic
            }
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
    reach_ += fastest_ * dt;
    travelled_ += (fastest_ + surface_.advance(dt)) * dt;
    const double by_bodies = bodies.fastest() * dt;
    reach_ = std::max(reach_, reach_ - fastest_ * dt + by_bodies);
    bodies_travelled_ += by_bodies;
    return {fastest_, std::sqrt(a2), compression / rho0, viscous_limit(), worst < 0, worst};
}

Health FluidSystem::health() const {
    Health health;
    health.max_speed = fastest_;
    health.max_kinematic_viscosity = viscous_limit();
    return health;
}

double FluidSystem::viscous_limit() const {
    double nu = 0;
    for (const FluidLaw& f : physics_.fluids) nu = std::max(nu, f.mu / f.rho0);
    if (particles.viscosity.empty()) return nu;
    double per_density[FluidTag::most];
    for (std::size_t f = 0; f < physics_.fluids.size(); ++f)
        per_density[f] = 1 / physics_.fluids[f].rho0;
    const int n = static_cast<int>(particles.size());
#pragma omp parallel for schedule(static) reduction(max : nu)
    for (int i = 0; i < n; ++i)
        nu = std::max(nu, particles.viscosity[i] * per_density[particles.fluid[i]]);
    return nu;
}

double FluidSystem::largest_sound_speed() const {
    double c0 = 0;
    for (const FluidLaw& f : physics_.fluids) c0 = std::max(c0, f.c0);
    return c0;
}

void FluidSystem::keep_inside() {
    Particles& s = particles;
    for (std::size_t i = 0; i < s.size(); ++i)
        if (mirror_.put_back(s.x[i], s.y[i], s.z[i], s.vx[i], s.vy[i], s.vz[i])) ++put_back_;
    put_back_ += near_walls_.put_back(s, bodies, periodic(), travelled_ + bodies_travelled_,
                                      support() + neighbors_.skin());
    if (!domain_) return;
    if (!periodic().axes().empty())
        for (std::size_t i = 0; i < s.size(); ++i) {
            double at[3] = {s.x[i], s.y[i], s.z[i]};
            periodic().wrap(at);
            s.x[i] = at[0], s.y[i] = at[1], s.z[i] = at[2];
        }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double at[3] = {s.x[i], s.y[i], s.z[i]};
        bool inside = true;
        for (int a = 0; a < 3; ++a)
            inside = inside && at[a] >= domain_->min[a] && at[a] <= domain_->max[a];
        if (!inside) {
            removed_.push_back({s.id[i], s.fluid[i], fluid_of(i).mass / (fluid_of(i).rho0 + s.drho[i]),
                                {s.x[i], s.y[i], s.z[i]}, {s.vx[i], s.vy[i], s.vz[i]}});
            index_[s.id[i]] = -1;
            continue;
        }
        if (kept != i) {
            for (auto* a : {&s.x, &s.y, &s.z, &s.vx, &s.vy, &s.vz, &s.drho, &s.energy,
                            &s.rate_before, &s.p, &s.fx, &s.fy, &s.fz})
                (*a)[kept] = (*a)[i];
            s.id[kept] = s.id[i];
            s.fluid[kept] = s.fluid[i];
            if (!s.viscosity.empty()) s.viscosity[kept] = s.viscosity[i];
        }
        ++kept;
    }
    if (kept != s.size()) s.resize(kept);
}

double FluidSystem::mean_neighbors() const {
    const std::vector<Packed>& records = neighbors_.records();
    const ClusterLists& lists = neighbors_.fluid_lists();
    const double r2 = std::pow(support() / neighbors_.fixed().unit, 2);
    std::int64_t pairs = 0;
    for (int i = 0; i < neighbors_.fluid_count(); ++i)
        for (const int* at = lists.begin(i / lanes); at != lists.end(i / lanes); ++at) {
            const double dx = double(records[i].x) - records[*at].x,
                         dy = double(records[i].y) - records[*at].y,
                         dz = double(records[i].z) - records[*at].z;
            pairs += *at != i && dx * dx + dy * dy + dz * dz < r2;
        }
    return neighbors_.fluid_count() ? double(pairs) / neighbors_.fluid_count() : 0;
}

}  // namespace undertow::sph
