#include "sph_solver/fluid_system.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "sph_solver/physics/free_surface.hpp"
#include "sph_solver/physics/gradient_correction.hpp"
#include "sph_solver/physics/heating.hpp"
#include "sph_solver/physics/resolve_physics.hpp"
#include "sph_solver/physics/stable_step.hpp"
#include "sph_solver/physics/wall_forces.hpp"
#include "sph_solver/setup/fill.hpp"
#include "sph_solver/shapes/vectors.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

// Lists [steps] that wear out early get the wide skin [dx], those that last the narrow one.
constexpr int short_lived = 8, long_lived = 40;
constexpr double narrow_skin = 0.2, wide_skin = 0.4;
// Particles may move this far [dx] before the images behind a coupled surface are found anew.
constexpr double along_surface = 0.2;
// The coupled surface may go this far [dx] before feet, images and cut plates are found anew.
constexpr double surface_goes_on = 0.1;
// Sound goes this far [dx] before a shear rate is found anew: within the support.
constexpr double shear_rate_hold = 2;

/// Twice the largest smoothing length that may ever be [m].
double largest_support(const PairPhysics& p) {
    double h = p.h;
    for (const FluidLaw& f : p.fluids) h = std::max(h, f.h);
    return 2 * h * (p.variable_smoothing ? SmoothingLengths::largest : 1);
}

/// At the start, of the fluids and of the dummies of bodies.  [m]
double support_of(const PairPhysics& p) {
    double h = 0;
    for (const FluidLaw& f : p.fluids) h = std::max(h, f.h);
    return 2 * std::max(h, p.sized() ? p.h : h);
}

double finest_spacing(const PairPhysics& p) {
    double dx = p.fluids[0].spacing;
    for (const FluidLaw& f : p.fluids) dx = std::min(dx, f.spacing);
    return dx;
}

double widest_of(const PairPhysics& p) {
    double dx = 0;
    for (const FluidLaw& f : p.fluids) dx = std::max(dx, f.spacing);
    return dx;
}

}  // namespace

FluidSystem::FluidSystem(const Case& input, double skin_over_spacing, Begin begin)
    : physics_(resolve_physics(input)),
      gravity_(input.info.gravity),
      tag_(physics_.mixed()),
      heated_(std::any_of(physics_.fluids.begin(), physics_.fluids.end(),
                          [](const FluidLaw& f) { return f.us_up.gamma0 != 0; })),
      filled_(physics_.fluids.size(), 0),
      spacing_(input.sph.spacing),
      dummy_volume_(std::pow(spacing_, physics_.dimension)),
      mirror_(input.sph.plane,
              Periodic(input.sph.periodic, input.sph.domain, largest_support(physics_))),
      sizes_(physics_.sized(), physics_.variable_smoothing, physics_.dimension, physics_.h,
             physics_.fluids),
      neighbors_(support_of(physics_), skin_over_spacing * spacing_, finest_spacing(physics_)),
      with_surface_images_(input.sph.surface_images),
      domain_(input.sph.domain),
      openings_(input, physics_),
      absorbing_(input, physics_),
      near_walls_(widest_of(physics_), mirror_.size(), static_cast<int>(input.sph.body.size()),
                  static_cast<int>(physics_.fluids.size())) {
    if (physics_.implicit_viscosity)
        implicit_.emplace(input.sph.viscosity_tolerance, input.sph.precision);
    Filled filled = fill_particles(input, physics_.fluids);
    particles = std::move(filled.particles);
    particles.set_precision(physics_.precision);
    neighbors_.exact().used = physics_.precision == Precision::float64;
    start_.emplace(input, std::move(filled.first_id), largest_sound_speed());
    const std::size_t first_buffered = particles.size();
    openings_.fill(mirror_, domain_, particles);
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
        if (i < first_buffered) ++filled_[particles.fluid[i]];
        if (!particles.viscosity.empty())
            particles.viscosity[i] = neighbors_.exact().used
                                         ? fluid_of(i).viscosity_at_rest()
                                         : static_cast<float>(fluid_of(i).viscosity_at_rest());
        for (int k = 0; k < mirror_.size(); ++k)
            if (mirror_.distance(k, particles.x[i], particles.y[i], particles.z[i]) < 0)
                throw InputError(fmt::format(
                    "{}: sph.fill puts a particle at ({:.4g}, {:.4g}, {:.4g}), {:.3g} m behind "
                    "sph.plane \"{}\": end the box of the fill at the plane; or, if the fluid belongs "
                    "on that side, turn the plane's normal, which must point into the fluid.",
                    input.file, particles.x[i], particles.y[i], particles.z[i],
                    -mirror_.distance(k, particles.x[i], particles.y[i], particles.z[i]),
                    mirror_.plane(k).name));
    }
    if (input.sph.lattice == FillLattice::relaxed && begin == Begin::anew) {
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
    for (ExactRecord& q : neighbors_.exact().records) q.p = 1, q.vx = q.vy = q.vz = 0;
    undertow::sph::sum_over_neighbors(physics_, neighbors_, no_slip_, Terms::force, particles);
}

/// Whether the lists still hold every pair; may pack the records to find out.
bool FluidSystem::lists_hold() {
    if (sizes_.outgrown()) return false;
    if (cut_anew_) return false;
    const bool by_surface = surface_.placed() || plates_.any();
    if (by_surface && reach_ > along_surface * spacing_) return false;
    // who passes an opening is noticed at the next rebuild only, and shifts are found there
    if ((openings_.any() || !shift_.empty()) && 2 * reach_ > neighbors_.skin()) return false;
    // a body shows each particle what its surface is next to it, which is found at rebuilds as well
    if (!neighbors_.body_targets().empty() &&
        2 * std::max(reach_, bodies_reach_) > neighbors_.skin())
        return false;
    switch (neighbors_.wear(reach_ + bodies_reach_)) {
        case Neighborhood::Wear::none: return true;
        case Neighborhood::Wear::out: return false;
        case Neighborhood::Wear::perhaps: break;
    }
#pragma omp parallel
    {
        pack_fluid();
        pack_extras(false);   // from the records just packed
    }
    packed_ = true;
    return !neighbors_.worn();
}

bool FluidSystem::refresh_neighbors(double t) {
    ++list_age_;
    neighbors_.moved();
    put_back_behind_planes();
    if (lists_hold()) return false;
    packed_ = false;
    // where a step moves a particle far, longer lists cost less than frequent ones
    if (rebuilds_ > 0 && list_age_ < short_lived) neighbors_.set_skin(wide_skin * spacing_);
    if (list_age_ > long_lived) neighbors_.set_skin(narrow_skin * spacing_);
    list_age_ = 0;
    bodies.move_to(t);
    bodies.wrap(periodic());
    put_back_ += near_walls_.put_back(particles, bodies, periodic(), travelled_ + bodies_travelled_,
                                      support() + neighbors_.skin());
    remove_outside();
    neighbors_.rebuild(particles, bodies, mirror_, sizes_.used() ? &sizes_ : nullptr,
                       plates_.any() ? &plates_ : nullptr);
    cut_anew_ = false;
    if (sizes_.variable()) sizes_.cap(neighbors_);
    if (physics_.mixed())
        neighbors_.find_fluids(particles, sizes_.used() ? FluidBits(~FluidBits(0)) : FluidBits(0));
    for (std::size_t i = 0; i < particles.size(); ++i)
        index_[particles.id[i]] = static_cast<int>(i);
    openings_.locate(particles, index_, neighbors_);
    absorbing_.locate(particles);
    const FixedPoint& fixed = neighbors_.fixed();
    const double origin[3] = {fixed.x0, fixed.y0, fixed.z0};
    mirror_.to_fixed(origin, fixed.unit, fixed_reflections_);
    find_near_planes();
    no_slip_.find(neighbors_, mirror_, physics_.fluids, particles);
    near_walls_.find(particles, mirror_, bodies, index_, neighbors_.skin());
    surface_.expire();
    if (physics_.tension_control != TensionControl::none || physics_.shifting > 0)
        find_free_surface(physics_, neighbors_);
    if (physics_.shifting > 0 || physics_.gradient_correction) pack(t);
    if (physics_.shifting > 0)
        find_shift(physics_, neighbors_, 0.5 * neighbors_.skin() / std::max(fastest_, 1e-300), shift_);
    if (physics_.gradient_correction) find_gradient_correction(physics_, neighbors_);
    reach_ = bodies_reach_ = 0;
    ++rebuilds_;
    return true;
}

/// Those with an image are all that may touch a plane before the next rebuild.
void FluidSystem::find_near_planes() {
    near_planes_.clear();
    for (const Extra& e : neighbors_.extras())
        if (!e.from_body && std::has_single_bit(e.mask) && std::countr_zero(e.mask) < mirror_.size())
            near_planes_.push_back({e.source, std::countr_zero(e.mask)});
}

void FluidSystem::put_back_behind_planes() {
    Particles& s = particles;
    const auto behind = [&](const NearPlane& near) {
        const int i = near.particle;
        return mirror_.distance(near.plane, s.x[i], s.y[i], s.z[i]) < 0;
    };
    const int n = static_cast<int>(near_planes_.size());
    int any = 0;
#pragma omp parallel for schedule(static) reduction(| : any)
    for (int k = 0; k < n; ++k) any |= behind(near_planes_[k]);
    if (!any) return;
    for (const NearPlane& near : near_planes_) {   // in a corner one is near several
        const int i = near.particle;
        if (!behind(near)) continue;
        mirror_.put_back(s.x[i], s.y[i], s.z[i], s.vx[i], s.vy[i], s.vz[i]);
        ++put_back_;
    }
}

void FluidSystem::add_wall_friction() {
    near_walls_.add_stress(physics_, mirror_, bodies, particles);
}

void FluidSystem::add_coulomb_friction(double dt, double dt_before) {
    near_walls_.add_coulomb(physics_, gravity_, mirror_, bodies, 0.5 * (dt + dt_before), particles);
}

std::vector<Vec3> FluidSystem::wall_forces() const {
    std::vector<Vec3> force = undertow::sph::wall_forces(physics_, neighbors_, mirror_, bodies, no_slip_);
    for (std::size_t k = 0; k < force.size(); ++k) force[k] = force[k] + near_walls_.shear(k);
    return force;
}

void FluidSystem::place_surface(std::vector<std::int32_t> quad, std::vector<double> x) {
    if (surface_.follow(quad, x, surface_goes_on * spacing_)) return;
    if (with_surface_images_ && sizes_.used())
        throw InputError(
            "sph.surface_images = true does not go together with sph.variable_smoothing or with a "
            "sph.fluid.spacing other than sph.spacing: the images behind the coupled surface know "
            "particles of one smoothing length only. Set sph.surface_images = false.");
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
    if (physics_.gradient_correction && with_surface_images_)
        throw InputError(
            "sph.gradient_correction = true does not know the images behind a coupled surface: set "
            "sph.surface_images = false, or leave the correction out.");
    const bool cut = neighbors_.fluid_lists().cut();
    plates_.place(quad, x, support(), spacing_);
    cut_anew_ = cut_anew_ || cut || neighbors_.would_cut(plates_, mirror_);
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
    if (terms != Terms::rate && !no_slip_.empty()) no_slip_.pack(neighbors_, mirror_);
    const ShearRate shear_rate = terms == Terms::rate ? ShearRate::held : shear_rate_now();
    undertow::sph::sum_over_neighbors(physics_, neighbors_, no_slip_, terms, particles, shear_rate);
    if (terms != Terms::rate)
        no_slip_.take_wall_viscosity(physics_.fluids, mirror_, spacing_, particles);
    if (!shift_.empty() && terms != Terms::force) shift_.carry_density(particles);
    if (heated_ && terms != Terms::rate) dissipation(physics_, neighbors_, heating_);
    if (!surface_.placed()) return;
    if (surface_.stale())
        surface_.find_pairs(particles, neighbors_, spacing_,
                            (along_surface + surface_goes_on) * spacing_,
                            physics_.dimension == 2);
    surface_.add(physics_, neighbors_, terms, particles);
}

/// Explicit viscous forces keep a viscosity while sound goes shear_rate_hold: the velocity gradients that
/// a kernel can see hardly change in that time, and any viscosity dissipates. At small steps that is
/// some eight of them.
ShearRate FluidSystem::shear_rate_now() {
    if (!physics_.viscoplastic()) return ShearRate::held;
    const bool young = shear_rate_age_ > 0 &&   // no time has passed: somebody wants to know again
                       shear_rate_age_ * largest_sound_speed() < shear_rate_hold * spacing_;
    if (young && !implicit_) return ShearRate::held;
    shear_rate_age_ = 0;
    return ShearRate::found;
}

Health FluidSystem::health() const {
    Health health;
    health.max_speed = fastest_;
    health.max_kinematic_viscosity = viscous_limit();
    return health;
}

double FluidSystem::viscous_limit() const {
    double nu = 0;
    if (implicit_) return nu;
    for (const FluidLaw& f : physics_.fluids) nu = std::max(nu, f.mu / f.rho0);
    if (particles.viscosity.empty()) return nu * viscous_stiffness(physics_.viscous_form);
    double per_density[FluidTag::most];
    for (std::size_t f = 0; f < physics_.fluids.size(); ++f)
        per_density[f] = 1 / physics_.fluids[f].rho0;
    const int n = static_cast<int>(particles.size());
#pragma omp parallel for schedule(static) reduction(max : nu)
    for (int i = 0; i < n; ++i)
        nu = std::max(nu, particles.viscosity[i] * per_density[particles.fluid[i]]);
    return nu * viscous_stiffness(physics_.viscous_form);
}

int FluidSystem::limiting_particle(const std::string& limiter) const {
    const Particles& s = particles;
    int worst = -1;
    double most = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        double value = 0;
        if (limiter == "sound")
            value = std::hypot(s.vx[i], s.vy[i], s.vz[i]);
        else if (limiter == "force")
            value = std::hypot(s.ax[i] + s.fx[i] + gravity_[0], s.ay[i] + s.fy[i] + gravity_[1],
                               s.az[i] + s.fz[i] + gravity_[2]);
        else if (!s.viscosity.empty())
            value = s.viscosity[i] / fluid_of(i).rho0;
        if (value > most) most = value, worst = static_cast<int>(i);
    }
    return worst;
}

double FluidSystem::widest_spacing() const { return widest_of(physics_); }

double FluidSystem::least_smoothing() const {
    double h = physics_.fluids[0].h;
    for (const FluidLaw& f : physics_.fluids) h = std::min(h, f.h);
    // until the next rebuild it may still become a little smaller
    return sizes_.variable() && sizes_.least() > 0 ? sizes_.least() / SmoothingLengths::room : h;
}

double FluidSystem::limiting_sound_speed() const {
    const double least = least_smoothing();
    double c0 = 0;
    for (const FluidLaw& f : physics_.fluids)
        c0 = std::max(c0, sizes_.variable() ? f.c0 : f.c0 * (least / f.h));
    return c0;
}

double FluidSystem::largest_sound_speed() const {
    double c0 = 0;
    for (const FluidLaw& f : physics_.fluids) c0 = std::max(c0, f.c0);
    return c0;
}

void FluidSystem::remove_outside() {
    Particles& s = particles;
    openings_.exchange(particles, index_);
    if (index_.size() > surface_.expected()) surface_.expect(index_.size());
    if (!domain_ && !openings_.any()) return;
    if (!periodic().axes().empty())
        for (std::size_t i = 0; i < s.size(); ++i) {
            double at[3] = {s.x[i], s.y[i], s.z[i]};
            periodic().wrap(at);
            s.x[i] = at[0], s.y[i] = at[1], s.z[i] = at[2];
        }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double at[3] = {s.x[i], s.y[i], s.z[i]};
        int face = -1;
        for (int a = 0; domain_ && a < 3; ++a) {
            if (!(at[a] >= domain_->min[a])) face = 2 * a;
            if (!(at[a] <= domain_->max[a])) face = 2 * a + 1;
        }
        if (openings_.any() && openings_.gone(i)) continue;   // counted when it went over the plane
        if (face >= 0 && openings_.any() && openings_.holds(i)) {
            index_[s.id[i]] = -1;   // of a buffer: counted when it went over the plane
            continue;
        }
        if (face >= 0) {
            Departed& departed = departed_[face][s.fluid[i]];
            ++departed.particles;
            departed.momentum[0] += s.vx[i], departed.momentum[1] += s.vy[i];
            departed.momentum[2] += s.vz[i];
            removed_.push_back({s.id[i], s.fluid[i], fluid_of(i).mass / (fluid_of(i).rho0 + s.drho[i]),
                                {s.x[i], s.y[i], s.z[i]}, {s.vx[i], s.vy[i], s.vz[i]}, face});
            index_[s.id[i]] = -1;
            continue;
        }
        if (kept != i) s.copy(i, kept);
        ++kept;
    }
    if (kept != s.size()) s.resize(kept);
}

double FluidSystem::mean_neighbors() const {
    const std::vector<Packed>& records = neighbors_.records();
    const ClusterLists& lists = neighbors_.fluid_lists();
    const double h = 0.5 * support() / neighbors_.fixed().unit;
    const std::vector<float>& each = neighbors_.smoothing();   // empty where all have the same
    const auto h_of = [&](int j) { return each.empty() ? h : each[j] / neighbors_.fixed().unit; };
    std::int64_t pairs = 0;
    for (int i = 0; i < neighbors_.fluid_count(); ++i)
        lists.for_each_seen(i, [&](int j) {
            const double dx = double(records[i].x) - records[j].x,
                         dy = double(records[i].y) - records[j].y,
                         dz = double(records[i].z) - records[j].z;
            const double r = h_of(i) + h_of(j);
            pairs += j != i && dx * dx + dy * dy + dz * dz < r * r;
        });
    return neighbors_.fluid_count() ? double(pairs) / neighbors_.fluid_count() : 0;
}

}  // namespace undertow::sph
