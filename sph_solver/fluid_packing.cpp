// FluidSystem, what the pair loop sees: records of fluid, images and dummies.

#include "sph_solver/boundary/body_fluid.hpp"
#include "sph_solver/fluid_system.hpp"

namespace undertow::sph {

void FluidSystem::pack(double t) {
    if (!packed_) {
#pragma omp parallel
        {
            pack_fluid();
            pack_extras(false);   // from the records just packed
        }
    }
    packed_ = false;   // whatever comes next changes the particles
    if (openings_.any()) {   // they look at the fluid and its images, then have images themselves
        openings_.extrapolate(physics_, tag_, neighbors_, particles);
#pragma omp parallel
        pack_extras(false);
    }
    bodies.move_to(t);
    if (neighbors_.body_targets().empty()) return;   // no body is near the fluid
    near_walls_.reflect(particles, bodies, reflected_);
    continue_into_bodies(physics_, neighbors_, mirror_, reflected_, bodies);
#pragma omp parallel
    pack_extras(true);
}

/// To be called by all threads of a parallel region: each packs its share. Between a sum of rates and
/// that of forces only densities have changed.
void FluidSystem::pack_fluid() {
    Packed* records = neighbors_.records().data();
    Particles& s = particles;
    // Spray bears no tension: it has torn. Its density comes along, or it would thin without end.
    const bool tears = physics_.tension_control != TensionControl::none && !neighbors_.depth().empty();
    const Depth* depth = tears ? neighbors_.depth().data() : nullptr;
    const bool moved = !neighbors_.marked().known();
    const auto pack_one = [&s, records, fixed = neighbors_.fixed(), tag = tag_, depth, moved](
                              int i, const FluidLaw& fluid, double mass) {
        s.p[i] = fluid.pressure(s.drho[i], s.energy[i]);
        if (depth && s.p[i] < 0 && depth[i] == Depth::loose)
            s.p[i] = 0, s.drho[i] = std::max(0.0, s.drho[i]);
        Packed& q = records[i];
        q.volume = tag(mass / (fluid.rho0 + s.drho[i]), s.fluid[i]);
        q.p = static_cast<float>(s.p[i]);
        if (!moved) return;
        q.x = fixed(s.x[i], fixed.x0);
        q.y = fixed(s.y[i], fixed.y0);
        q.z = fixed(s.z[i], fixed.z0);
        q.vx = static_cast<float>(s.vx[i]);
        q.vy = static_cast<float>(s.vy[i]);
        q.vz = static_cast<float>(s.vz[i]);
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
    if (sizes_.variable()) {
#pragma omp for schedule(static)
        for (int i = 0; i < n; ++i)
            neighbors_.smoothing()[i] = sizes_.now<float>(i, s.fluid[i], s.drho[i]);
    }
    if (neighbors_.exact().used) pack_fluid_exactly();
    if (s.viscosity.empty()) return;
#pragma omp for schedule(static)
    for (int i = 0; i < n; ++i)
        neighbors_.root_viscosity()[i] = std::sqrt(static_cast<float>(s.viscosity[i]));
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
    float* root_viscosity =
        neighbors_.root_viscosity().data() + (viscous ? neighbors_.first_extra() : 0);
    const std::vector<Extra>& extras = neighbors_.extras();
    const int n = static_cast<int>(extras.size());
#pragma omp for schedule(static)
    for (int e = 0; e < n; ++e) {
        const int s = extras[e].source;
        const bool body = extras[e].from_body;
        if (body != of_bodies) continue;
        const std::uint8_t own = single ? 0 : body ? bodies.fluid[s] : particles.fluid[s];
        if (viscous)
            root_viscosity[e] = std::sqrt(
                static_cast<float>(body ? bodies.viscosity[s] : particles.viscosity[s]));
        if (sizes_.variable() && !body)
            neighbors_.smoothing()[neighbors_.first_extra() + e] = neighbors_.smoothing()[s];
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
        const ExactRecord shown = shown_by(extras[e], physics_.fluids[own]);
        Packed& q = records[e];
        q.x = fixed(shown.x, fixed.x0);
        q.y = fixed(shown.y, fixed.y0);
        q.z = fixed(shown.z, fixed.z0);
        q.volume = tag(shown.volume, own);
        q.vx = static_cast<float>(shown.vx);
        q.vy = static_cast<float>(shown.vy);
        q.vz = static_cast<float>(shown.vz);
        q.p = static_cast<float>(shown.p);
    }
    if (neighbors_.exact().used) pack_extras_exactly(of_bodies);
}

/// Of an image or a dummy, before it is rounded to a record; no tag.
ExactRecord FluidSystem::shown_by(const Extra& extra, const FluidLaw& fluid) const {
    const int s = extra.source;
    const bool body = extra.from_body;
    const double x = body ? bodies.x[s] : particles.x[s];
    const double y = body ? bodies.y[s] : particles.y[s];
    const double z = body ? bodies.z[s] : particles.z[s];
    const double vx = body ? bodies.vx[s] : particles.vx[s];
    const double vy = body ? bodies.vy[s] : particles.vy[s];
    const double vz = body ? bodies.vz[s] : particles.vz[s];
    const double p = body ? bodies.p[s] : particles.p[s];
    const double drho = body ? 0 : particles.drho[s];
    const Vec3& g = physics_.gravity;
    const double gx = fluid.rho0 * g[0], gy = fluid.rho0 * g[1], gz = fluid.rho0 * g[2];
    const Reflection& r = mirror_.reflection(extra.mask);
    ExactRecord q;
    q.x = r.m[0][0] * x + r.m[0][1] * y + r.m[0][2] * z + r.t[0];
    q.y = r.m[1][0] * x + r.m[1][1] * y + r.m[1][2] * z + r.t[1];
    q.z = r.m[2][0] * x + r.m[2][1] * y + r.m[2][2] * z + r.t[2];
    const double share = body ? bodies.share[s] : 1;
    const double rest = body && sizes_.used() ? dummy_volume_ : fluid.volume;
    q.volume = share * fluid.rho0 * rest / (fluid.rho0 + drho);
    q.vx = r.m[0][0] * vx + r.m[0][1] * vy + r.m[0][2] * vz;
    q.vy = r.m[1][0] * vx + r.m[1][1] * vy + r.m[1][2] * vz;
    q.vz = r.m[2][0] * vx + r.m[2][1] * vy + r.m[2][2] * vz;
    q.p = p + gx * (q.x - x) + gy * (q.y - y) + gz * (q.z - z);
    return q;
}

/// As pack_fluid and pack_extras, for sums in double; by all threads of a parallel region as well.
void FluidSystem::pack_fluid_exactly() {
    const Particles& s = particles;
    ExactShown& exact = neighbors_.exact();
    const int n = static_cast<int>(s.size());
#pragma omp for schedule(static)
    for (int i = 0; i < n; ++i) {
        const FluidLaw& fluid = fluid_of(i);
        const double volume = fluid.rho0 * fluid.volume / (fluid.rho0 + s.drho[i]);
        exact.records[i] = {s.x[i],  s.y[i],  s.z[i],  tag_.exact(volume, s.fluid[i]),
                            s.vx[i], s.vy[i], s.vz[i], s.p[i]};
        if (!s.viscosity.empty()) exact.root_viscosity[i] = std::sqrt(s.viscosity[i]);
        if (sizes_.variable()) exact.smoothing[i] = sizes_.now<double>(i, s.fluid[i], s.drho[i]);
    }
}

void FluidSystem::pack_extras_exactly(bool of_bodies) {
    ExactShown& exact = neighbors_.exact();
    const std::vector<Extra>& extras = neighbors_.extras();
    const bool single = physics_.fluids.size() == 1;
    const int n = static_cast<int>(extras.size()), first = neighbors_.first_extra();
#pragma omp for schedule(static)
    for (int e = 0; e < n; ++e) {
        const Extra& extra = extras[e];
        const int s = extra.source;
        const bool body = extra.from_body;
        if (body != of_bodies) continue;
        const std::uint8_t own = single ? 0 : body ? bodies.fluid[s] : particles.fluid[s];
        ExactRecord& q = exact.records[first + e];
        q = shown_by(extra, physics_.fluids[own]);
        q.volume = tag_.exact(q.volume, own);
        if (!exact.root_viscosity.empty())
            exact.root_viscosity[first + e] =
                std::sqrt(body ? bodies.viscosity[s] : particles.viscosity[s]);
        if (sizes_.variable() && !body) exact.smoothing[first + e] = exact.smoothing[s];
    }
}

}  // namespace undertow::sph
