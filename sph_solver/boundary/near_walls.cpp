#include "sph_solver/boundary/near_walls.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/physics/wall_friction.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

constexpr double shear_range = 1.5;  // [dx] where the weight of add_stress ends
constexpr int share_size = 1024;        // entries of rubbing_
constexpr int asked_at_once = 1 << 15;  // particles: all are asked at the first rebuild

}  // namespace

int NearWalls::put_back(Particles& particles, const Bodies& bodies, const Periodic& periodic,
                        double travelled, double range) {
    candidates_.clear();
    if (bodies.count() == 0) return 0;
    int count = 0;
    const int n = static_cast<int>(particles.size());
    for (int first = 0; first < n; first += asked_at_once)
        count += put_back(particles, bodies, periodic, travelled, range, first,
                          std::min(n, first + asked_at_once));
    return count;
}

int NearWalls::put_back(Particles& particles, const Bodies& bodies, const Periodic& periodic,
                        double travelled, double range, int first, int last) {
    Particles& s = particles;
    const int kept = static_cast<int>(candidates_.size());
    for (int i = first; i < last; ++i) {
        if (s.id[i] >= static_cast<std::int64_t>(safe_until_.size()))
            safe_until_.resize(s.id[i] + 1, -1.0);
        if (safe_until_[s.id[i]] <= travelled) candidates_.push_back({i, s.id[i], 0, {}});
    }
    const int n = static_cast<int>(candidates_.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (int k = kept; k < n; ++k) {
        Candidate& c = candidates_[k];
        const Vec3 x{s.x[c.particle], s.y[c.particle], s.z[c.particle]};
        for (int b = 0; b < bodies.count(); ++b) {
            const FromSurface from = bodies.body[b].now(x, periodic);
            if (b == 0 || from.distance < c.from.distance) c.from = from, c.body = b;
        }
    }
    int count = 0, near = kept;
    for (int k = kept; k < n; ++k) {
        Candidate& c = candidates_[k];
        const int i = c.particle;
        FromSurface& from = c.from;
        if (from.distance < 0) {
            ++count;
            const Vec3 wall = bodies.body[c.body].pose().velocity_at({s.x[i], s.y[i], s.z[i]});
            const double closing = dot(Vec3{s.vx[i], s.vy[i], s.vz[i]} - wall, from.away);
            const double out = -2 * from.distance, turn = closing < 0 ? -2 * closing : 0;
            s.x[i] += out * from.away[0], s.y[i] += out * from.away[1],
                s.z[i] += out * from.away[2];
            s.vx[i] += turn * from.away[0], s.vy[i] += turn * from.away[1];
            s.vz[i] += turn * from.away[2];
            from.distance = -from.distance;
        }
        safe_until_[c.id] = travelled + std::max(0.0, from.distance - range);
        if (from.distance < range) candidates_[near++] = c;  // those near stay candidates
    }
    candidates_.resize(near);
    return count;
}

void NearWalls::find(const Particles& particles, const MirrorPlanes& mirror, const Bodies& bodies,
                     const std::vector<int>& index, double skin) {
    rubbing_.clear();
    near_.clear();
    const double range = shear_range * widest_ + skin;
    rough_.clear();
    for (int k = 0; k < mirror.size(); ++k)
        if (mirror.plane(k).slip != Slip::free_slip) rough_.push_back(k);
    for (std::size_t i = 0; i < particles.size(); ++i)
        for (const int k : rough_)
            if (mirror.distance(k, particles.x[i], particles.y[i], particles.z[i]) < range)
                rubbing_.push_back({static_cast<int>(i), k, {}, {}});
    const int planes = static_cast<int>(rubbing_.size());
    for (const Candidate& c : candidates_) {
        const RigidBody& b = bodies.body[c.body];
        const int i = index[c.id];
        if (i < 0) continue;  // it has left the domain
        const Vec3 x{particles.x[i], particles.y[i], particles.z[i]};
        const Vec3 foot = x - c.from.distance * c.from.away;
        near_.push_back({i, mirror.size() + c.body, b.pose().to_rest(foot),
                         b.pose().direction_at_rest(c.from.away)});
        if (b.body().slip != Slip::free_slip && c.from.distance < range)
            rubbing_.push_back(near_.back());
    }
    // shares of a fixed size, so that sums over them do not depend on the number of threads; those
    // of planes do not part the entries of one particle
    share_.assign(1, 0);
    for (int next = share_size; next < planes; next += share_size) {
        while (next < planes && rubbing_[next].particle == rubbing_[next - 1].particle) ++next;
        if (next < planes) share_.push_back(next);
    }
    if (planes > 0) share_.push_back(planes);
    plane_shares_ = static_cast<int>(share_.size()) - 1;
    const int all = static_cast<int>(rubbing_.size());
    for (int next = planes + share_size; next < all; next += share_size) share_.push_back(next);
    if (all > planes) share_.push_back(all);
}

void NearWalls::reflect(const Particles& s, const Bodies& bodies,
                        std::vector<Vec3>& velocity) const {
    const int n = static_cast<int>(s.size()), near = static_cast<int>(near_.size());
    velocity.resize(n);
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (int i = 0; i < n; ++i) velocity[i] = {s.vx[i], s.vy[i], s.vz[i]};
#pragma omp for schedule(static)
        for (int k = 0; k < near; ++k) {
            const Rubbing& r = near_[k];
            const Pose& pose = bodies.body[r.wall - planes_].pose();
            const Vec3 away = pose.direction(r.away), foot = pose.to_space(r.foot);
            Vec3& v = velocity[r.particle];
            v = v - 2 * dot(v - pose.velocity_at(foot), away) * away;
        }
    }
}

NearWalls::Place NearWalls::place(const Rubbing& r, const MirrorPlanes& mirror,
                                  const Bodies& bodies, const Particles& s) const {
    const int i = r.particle;
    if (r.wall < mirror.size())
        return {mirror.distance(r.wall, s.x[i], s.y[i], s.z[i]), mirror.plane(r.wall).normal,
                mirror.plane(r.wall).velocity};
    // a curved surface passes for its tangent plane within the skin
    const Pose& pose = bodies.body[r.wall - mirror.size()].pose();
    const Vec3 foot = pose.to_space(r.foot), away = pose.direction(r.away);
    return {dot(Vec3{s.x[i], s.y[i], s.z[i]} - foot, away), away, pose.velocity_at(foot)};
}

void NearWalls::add_stress(const PairPhysics& physics, const MirrorPlanes& mirror,
                           const Bodies& bodies, Particles& particles) {
    std::fill(stress_.begin(), stress_.end(), Vec3{});
    const int shares = static_cast<int>(share_.size()) - 1, walls = static_cast<int>(stress_.size());
    if (shares < 1) return;
    share_stress_.assign(std::size_t(shares) * walls, Vec3{});
#pragma omp parallel
    {
        // first planes, then bodies: in between a particle may go to another thread
#pragma omp for schedule(static)
        for (int k = 0; k < plane_shares_; ++k)
            add_stress(physics, mirror, bodies, particles, share_[k], share_[k + 1],
                       &share_stress_[std::size_t(k) * walls]);
#pragma omp for schedule(static)
        for (int k = plane_shares_; k < shares; ++k)
            add_stress(physics, mirror, bodies, particles, share_[k], share_[k + 1],
                       &share_stress_[std::size_t(k) * walls]);
    }
    for (int k = 0; k < shares; ++k)
        for (int w = 0; w < walls; ++w)
            stress_[w] = stress_[w] + share_stress_[std::size_t(k) * walls + w];
}

void NearWalls::add_stress(const PairPhysics& physics, const MirrorPlanes& mirror,
                           const Bodies& bodies, Particles& particles, int first, int last,
                           Vec3* forces) const {
    for (int k = first; k < last; ++k) {
        const Rubbing& r = rubbing_[k];
        const int i = r.particle;
        const Slip slip = r.wall < mirror.size() ? mirror.plane(r.wall).slip
                                                 : bodies.body[r.wall - mirror.size()].body().slip;
        if (slip != Slip::no_slip) continue;
        const auto [z, n, wall] = place(r, mirror, bodies, particles);
        const FluidLaw& fluid = physics.fluids[particles.fluid[i]];
        const double dx = fluid.spacing, weight = 1 - std::abs(z - 0.5 * dx) / dx;
        if (!(weight > 0)) continue;
        const double vx = particles.vx[i] - wall[0], vy = particles.vy[i] - wall[1],
                     vz = particles.vz[i] - wall[2];
        const double vn = vx * n[0] + vy * n[1] + vz * n[2];
        const double ux = vx - vn * n[0], uy = vy - vn * n[1], uz = vz - vn * n[2];
        const double u = std::sqrt(ux * ux + uy * uy + uz * uz);
        if (!(u > 0)) continue;
        // resolved layers have the shear of the pair sums: of the images behind planes (see
        // no_slip_images.hpp), of all walls where the viscous update is implicit
        if (r.wall < mirror.size() ? fluid.resolves_walls : physics.implicit_viscosity) continue;
        const double height = std::max(z, 0.1 * dx);
        const LawOfTheWall law{fluid.rho0,
                               fluid.viscoplastic() ? fluid.rheology(u / height) : fluid.mu};
        const double deceleration = weight * law(u, height) / (law.rho * dx) / u;
        particles.ax.add(i, -deceleration * ux);
        particles.ay.add(i, -deceleration * uy);
        particles.az.add(i, -deceleration * uz);
        Vec3& force = force_on(r, particles, forces);
        force = force + fluid.mass * deceleration * Vec3{ux, uy, uz};
    }
}

void NearWalls::add_coulomb(const PairPhysics& physics, const Vec3& gravity,
                            const MirrorPlanes& mirror, const Bodies& bodies, double kick,
                            Particles& s) {
    if (!(kick > 0)) return;
    std::fill(coulomb_.begin(), coulomb_.end(), Vec3{});
    for (const Rubbing& r : rubbing_) {
        const bool plane = r.wall < mirror.size();
        const Body* body = plane ? nullptr : &bodies.body[r.wall - mirror.size()].body();
        if ((plane ? mirror.plane(r.wall).slip : body->slip) != Slip::friction) continue;
        const double mu = plane ? mirror.plane(r.wall).friction : body->friction;
        const int i = r.particle;
        const auto [z, n, wall] = place(r, mirror, bodies, s);
        const FluidLaw& fluid = physics.fluids[s.fluid[i]];
        const double dx = fluid.spacing, weight = 1 - std::abs(z - 0.5 * dx) / dx;
        if (!(weight > 0)) continue;
        // where the kick would lead without friction
        const Vec3 next{s.vx[i] + kick * (s.ax[i] + s.fx[i] + gravity[0]),
                        s.vy[i] + kick * (s.ay[i] + s.fy[i] + gravity[1]),
                        s.vz[i] + kick * (s.az[i] + s.fz[i] + gravity[2])};
        const Vec3 relative = next - wall;
        const Vec3 slip = relative - dot(relative, n) * n;
        const double u = length(slip);
        if (!(u > 0)) continue;
        const double pressure = std::max(0.0, s.p[i] - fluid.rho0 * z * dot(physics.gravity, n));
        const double friction =
            std::min(mu * pressure * weight / (fluid.rho0 * dx), u / kick);
        const Vec3 a = (-friction / u) * slip;
        s.ax.add(i, a[0]);
        s.ay.add(i, a[1]);
        s.az.add(i, a[2]);
        Vec3& force = force_on(r, s, coulomb_.data());
        force = force - fluid.mass * a;
    }
}

}  // namespace undertow::sph
