#include "fem_solver/structure.hpp"

#include <algorithm>
#include <cmath>

#include "fem_solver/contact_pairs/springs.hpp"
#include "fem_solver/elements/corners.hpp"
#include "fem_solver/physics/largest_frequency.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

// A shape check costs as much as two or three steps of the elements.
constexpr std::int64_t steps_between_shape_checks = 256;
// Jacobian of a corner over that at the start below which an element is lost: turned inside out by
// as much as it was upright. One-point elements bear a corner that has just folded, because their
// volume and mean strain are still sound; a mesh that comes apart goes on to -10 and far beyond.
constexpr double lost_corner = -1;

/// [kg] of all nodes: from the elements that deform and from the rigid bodies.
std::vector<double> masses_of(const Elements& elements, const Model& model) {
    std::vector<double> mass = elements.nodal_masses(model.mesh.x.size());
    for (const RigidSet& body : model.rigid)
        for (std::size_t i = 0; i < body.nodes.size(); ++i) mass[body.nodes[i]] += body.mass[i];
    add_point_masses(model.point_masses, mass);
    return mass;
}

/// [kg] that gravity acts on, of elements that deform and point masses.
std::vector<double> weight_masses_of(const Elements& elements, const Model& model) {
    std::vector<double> mass = elements.nodal_weight_masses(model.mesh.x.size());
    add_point_masses(model.point_masses, mass);
    return mass;
}

}  // namespace

Structure::Structure(Model model, int threads)
    : model_(std::move(model)),
      elements_(model_.mesh, model_.parts, model_.bulk_viscosity),
      nodes_(make_nodes(model_.mesh, masses_of(elements_, model_),
                        weight_masses_of(elements_, model_))),
      contact_(model_.surface.node),
      // below this a step takes less time than waking threads several times
      threads_(elements_.size() < 8192 ? 1 : threads) {
    for (const Support& support : model_.supports)
        for (std::int32_t n : support.nodes)
            for (int d = 0; d < 3; ++d)
                if (support.fixed[d]) nodes_.inverse_mass[n].c[d] = 0;
    for (const Support& support : model_.supports)
        for (std::int32_t n : support.nodes)
            for (int d = 0; d < 3; ++d)
                if (support.turned[d]) elements_.hold_rotation(n, d);
    if (!model_.surface.offset.empty()) {
        faces_ = ShellFaces(model_.surface, *elements_.turning_nodes());
        faces_.follow(nodes_.x);
    }
    for (const PrescribedMotion& motion : model_.motions) motion.hold(nodes_);
    model_.far_field.hold(nodes_);
    for (const InitialStress& s : model_.initial_stress) elements_.set_stress(s.element, s.stress);
    if (!model_.rigid.empty()) is_rigid_.assign(nodes_.size(), 0);
    for (const RigidSet& set : model_.rigid) {
        for (std::int32_t n : set.nodes) is_rigid_[n] = 1;
        bodies_.emplace_back(set, nodes_);
    }
    if (elements_.implicit())
        implicit_ = std::make_unique<ImplicitParts>(model_, *elements_.implicit(), nodes_);
    moved_by_others_ = moved_by_others();
    stiffness_damping_ = StiffnessDamping(model_.damping_beta, elements_, nodes_);
    report_.omega2 = elements_.omega2_start();
    find_frequency();
    omega_start_ = tightening_ * omega_bound();
    if (!model_.contacts.empty()) make_pairs();
}

// Of the stability budget 4, contact takes no more of a node than cfl = 0.9 leaves. Stable are
// springs up to 4, but an impact begins within a step: from 2.25 on a node may leave faster than it
// came, and nodes that hang on elements chatter at the edge of a contact from 1.5 on
// (docs/theory_fem.md, section 10). A smaller step makes springs stiffer all the same, as 1/dt^2.
constexpr double most_for_impacts = 0.76;

/// What elements and coupler leave of the stability budget 4 goes to contact inside the mesh:
/// 4 (1 - cfl^2) at a node, less what the coupler takes at its own, divided among the contacts that
/// meet there. On a rigid body no element hangs; what it lends is divided by load_on_body().
ContactBudget Structure::budget_of(const ContactSet& set) const {
    const double room = 4 * (1 - model_.cfl * model_.cfl);
    const auto share = [&](double most, std::int32_t n) {
        const std::vector<std::int32_t>& coupled = model_.surface.node;
        const bool is_coupled = std::binary_search(coupled.begin(), coupled.end(), n);
        return most - (is_coupled ? model_.coupled_share : 0);
    };
    const std::vector<int> contacts = contacts_at_nodes();
    ContactBudget budget{std::min(stable_.dt, model_.max_step), {}, most_for_impacts};
    for (std::int32_t n : set.nodes)
        budget.share.push_back(std::min(most_for_impacts, share(room, n)) / contacts[n]);
    if (set.body < 0) {
        for (const Quad& q : set.surface)
            for (std::int32_t n : q)
                if (nodes_.mass[n] > 0)
                    budget.surface_share = std::min(
                        budget.surface_share,
                        std::min(most_for_impacts, share(room, n)) / contacts[n]);
    } else {
        const RigidBody& body = bodies_[set.body];
        for (std::int32_t n : body.set().nodes)  // any of its nodes may be coupled
            budget.surface_share = std::min(budget.surface_share, share(4, n));
        for (const ContactSet& other : model_.contacts)
            if (other.body == set.body) budget.body_load += load_on_body(other, nodes_, body);
    }
    const double least = std::min(
        budget.surface_share, *std::min_element(budget.share.begin(), budget.share.end()));
    if (least < 0.05)  // softer than this, contact gives way more than the soil it belongs to
        throw InputError("fem.contact \"" + set.name + "\": fem.cfl = " + number_text(model_.cfl) +
                         " leaves " + number_text(least, 3) +
                         " of the stability budget to contact inside the mesh, less than 0.05; "
                         "set fem.cfl to 0.9 or less.");
    return budget;
}

/// Of each node, the number of contacts whose nodes or whose deformable surface it belongs to.
std::vector<int> Structure::contacts_at_nodes() const {
    std::vector<int> contacts(nodes_.size(), 0), last(nodes_.size(), -1);
    for (std::size_t c = 0; c < model_.contacts.size(); ++c) {
        const auto count = [&](std::int32_t n) {
            if (last[n] != int(c)) ++contacts[n];
            last[n] = int(c);
        };
        for (std::int32_t n : model_.contacts[c].nodes) count(n);
        for (const Quad& q : model_.contacts[c].surface)
            for (std::int32_t n : q) count(n);
    }
    return contacts;
}

void Structure::make_pairs() {
    stable_step();
    for (const ContactSet& set : model_.contacts)
        pairs_.emplace_back(set, nodes_, budget_of(set), threads_, elements_.turning_nodes());
    // Over-closures that meet the stresses and weights of the start, so that nothing jumps.
    elements_.step(nodes_, 0, threads_);
    pressure_forces(0);
    for (std::size_t n = 0; n < nodes_.size(); ++n)
        for (int d = 0; d < 3; ++d)
            nodes_.f[n].c[d] += nodes_.mass[n] * nodes_.weight_share[n] * model_.gravity[d];
    for (ContactPair& pair : pairs_) pair.balance(nodes_.f);
    for (NodeRow& f : nodes_.f) f = NodeRow{};
    pair_forces();
    for (ContactPair& pair : pairs_) pair.count_from_here();
    for (RigidBody& body : bodies_) body.count_from_here();
    for (NodeRow& f : nodes_.f) f = NodeRow{};
    elements_.hold();  // and moments of shells
}

void Structure::pair_forces() {
    for (RigidBody& body : bodies_) body.clear_contact();
    for (ContactPair& pair : pairs_)
        pair.evaluate(nodes_, bodies_, dt_, elements_.turning_nodes());
}

double Structure::omega_bound() const {
    return std::sqrt(elements_.omega2_start());
}

void Structure::find_frequency() {
    // Lanczos approaches the largest frequency from below; what it may lack when it stops is far
    // less than this.
    constexpr double margin = 1.01;
    if (report_.omega2 == 0) return;  // nothing deforms
    const LargestFrequency found = find_largest_frequency(elements_, nodes_);
    tightening_ =
        found.converged ? std::min(1.0, margin * found.omega / std::sqrt(report_.omega2)) : 1.0;
    elements_.accept_shape();
    ++frequency_searches_;
}

void Structure::internal_forces() {
    report_ = elements_.step(nodes_, dt_, threads_);
    if (!stiffness_damping_.empty()) stiffness_damping_.add_forces(elements_, nodes_);
    if (measure_sections_)
        for (SectionForce& section : model_.sections)
            section.measure(nodes_.x, nodes_.f, elements_.turning_nodes());
    strain_work_ += report_.strain_work;
    hourglass_work_ += report_.hourglass_work;
    viscous_work_ += report_.viscous_work;
    plastic_work_ += report_.plastic_work;
    model_.far_field.react(nodes_.x, nodes_.f);
    if (!pairs_.empty()) pair_forces();
}

void Structure::pressure_forces(double t) {
    t_ = t;
    for (PressureLoad& pressure : model_.pressures) {
        pressure.evaluate(t, nodes_.x);
        pressure.load.add_to(nodes_.f);
    }
    for (TractionLoad& traction : model_.tractions) {
        traction.evaluate(t);
        traction.load.add_to(nodes_.f);
    }
}

void Structure::contact_forces(std::span<const double> f) {
    if (f.empty()) return;  // alone
    for (std::size_t i = 0; i < contact_.node.size(); ++i)
        contact_.force[i] = {{f[3 * i], f[3 * i + 1], f[3 * i + 2], 0}};
    contact_.add_to(nodes_.f);
    if (!faces_.empty()) faces_.add_moments(contact_.force, *elements_.turning_nodes());
    if (!model_.water) return;
    model_.water->evaluate(nodes_.x);
    model_.water->load.add_to(nodes_.f);
}

void Structure::observe_still_water(double dt) {
    if (model_.water) model_.water->observe(contact_, dt);
}

void Structure::let_go() {
    if (model_.water) model_.water->balance(nodes_.inverse_mass);
}

void Structure::release_far_field() {
    if (model_.far_field.empty() || model_.far_field.released()) return;
    std::fill(nodes_.f.begin(), nodes_.f.end(), NodeRow{});
    report_ = elements_.step(nodes_, 0, threads_);  // no time, no strain: forces of the stresses
    pressure_forces(0);
    model_.far_field.release(nodes_, model_.gravity);
    std::fill(nodes_.f.begin(), nodes_.f.end(), NodeRow{});
    find_frequency();  // of a mesh that is freer now
    omega_start_ = tightening_ * omega_bound();
}

void Structure::launch() {
    if (launched_ || model_.initial_velocities.empty()) return;
    launched_ = true;
    TurningNodes* turning = elements_.turning_nodes();
    for (const InitialVelocities::OfNode& given : model_.initial_velocities.nodes) {
        const std::int32_t i = turning ? turning->index_of(given.node) : -1;
        for (int d = 0; d < 3; ++d) {
            if (nodes_.inverse_mass[given.node].c[d] > 0) {
                const double v = nodes_.v[given.node].c[d] = given.velocity[d];
                start_energy_ += 0.5 * nodes_.mass[given.node] * v * v;
            }
            if (i >= 0 && turning->inverse_inertia[i].c[d] > 0) {
                const double w = turning->omega[i].c[d] = given.spin[d];
                start_energy_ += 0.5 * turning->inertia[i] * w * w;
            }
        }
    }
    for (const InitialVelocities::OfBody& given : model_.initial_velocities.bodies)
        start_energy_ += bodies_[given.body].launch(nodes_, given.velocity, given.spin);
}

void Structure::kick(double dt) {
    const Kick step = before_kick(dt);
    kick_ = fem::kick(nodes_, step, threads_);
    after_kick(step);
}

void Structure::drift(double dt) {
    before_drift(dt);
    fem::drift(nodes_, dt, threads_);
    after_drift(dt);
}

void Structure::advance(double dt) {
    const Kick step = before_kick(dt);
    kick_ = fem::kick_and_drift(nodes_, step, moved_by_others_, threads_);
    after_kick(step);
    before_drift(dt);
    fem::drift(nodes_, dt, moved_by_others_);
    after_drift(dt);
}

std::vector<std::int32_t> Structure::moved_by_others() const {
    std::vector<std::int32_t> all = model_.far_field.nodes();
    const auto add = [&](const std::vector<std::int32_t>& nodes) {
        all.insert(all.end(), nodes.begin(), nodes.end());
    };
    for (const PrescribedMotion& motion : model_.motions) add(motion.nodes());
    for (const RigidBody& body : bodies_) add(body.set().nodes);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

Kick Structure::before_kick(double dt) {
    for (PressureLoad& pressure : model_.pressures) pressure.load.do_work(nodes_.v, 0.5 * dt_);
    for (TractionLoad& traction : model_.tractions) traction.load.do_work(nodes_.v, 0.5 * dt_);
    contact_.do_work(nodes_.v, 0.5 * dt_);
    if (!faces_.empty())
        contact_.work += 0.5 * dt_ * faces_.power(contact_.force, *elements_.turning_nodes());
    if (model_.water) model_.water->load.do_work(nodes_.v, 0.5 * dt_);
    if (!stiffness_damping_.empty()) stiffness_damping_.do_work(elements_, nodes_, 0.5 * dt_);
    model_.far_field.before_kick(nodes_, dt_);
    const Kick step{dt_, dt, model_.gravity, model_.damping};
    for (const RigidBody& body : bodies_) body.rest_nodes(nodes_);
    if (!motions_rest_)
        for (PrescribedMotion& motion : model_.motions) motion.before_kick(nodes_);
    if (implicit_) implicit_->before_kick(*elements_.implicit(), nodes_, step);
    return step;
}

void Structure::after_kick(const Kick& step) {
    if (implicit_) implicit_->after_kick(nodes_, step, kick_);
    model_.far_field.after_kick(nodes_, step, kick_);
    if (!motions_rest_)
        for (PrescribedMotion& motion : model_.motions)
            motion.after_kick(nodes_, step, t_, kick_);
    kick_ += elements_.kick(step, threads_);
    kick_bodies(step);
    damping_work_ += damping_ahead_ + kick_.damping_before;
    damping_ahead_ = kick_.damping_after;
    kick_span_ = 0.5 * (step.dt_before + step.dt_after);
}

void Structure::kick_bodies(const Kick& step) {
    if (!motions_rest_)
        for (PrescribedMotion& motion : model_.motions)
            if (motion.body() >= 0) motion.drive(bodies_[motion.body()], t_, step.dt_after);
    for (RigidBody& body : bodies_) kick_ += body.kick(nodes_, step);
    if (motions_rest_) return;
    for (PrescribedMotion& motion : model_.motions)
        if (motion.body() >= 0) motion.read_force(bodies_[motion.body()], step);
}

void Structure::before_drift(double dt) {
    for (PressureLoad& pressure : model_.pressures) pressure.load.do_work(nodes_.v, 0.5 * dt);
    for (TractionLoad& traction : model_.tractions) traction.load.do_work(nodes_.v, 0.5 * dt);
    contact_.do_work(nodes_.v, 0.5 * dt);
    if (!faces_.empty())
        contact_.work += 0.5 * dt * faces_.power(contact_.force, *elements_.turning_nodes());
    if (model_.water) model_.water->load.do_work(nodes_.v, 0.5 * dt);
    if (!stiffness_damping_.empty()) stiffness_damping_.do_work(elements_, nodes_, 0.5 * dt);
    model_.far_field.drift(nodes_.v, dt);
}

void Structure::after_drift(double dt) {
    elements_.drift(dt, threads_);
    if (!faces_.empty()) faces_.follow(nodes_.x);
    for (RigidBody& body : bodies_) body.drift(nodes_, dt);
    if (!motions_rest_)
        for (PrescribedMotion& motion : model_.motions) motion.drift();
    dt_ = dt;
}

void Structure::hold() {
    elements_.hold();
    for (NodeRow& f : nodes_.f) f = NodeRow{};
}

void Structure::rest_motions() {
    motions_rest_ = true;
}

void Structure::stop() {
    elements_.stop();
    for (NodeRow& v : nodes_.v) v = NodeRow{};
    for (RigidBody& body : bodies_) body.stop(nodes_);
    dt_ = 0;
}

void Structure::count_from_here() {
    motions_rest_ = false;
    for (PrescribedMotion& motion : model_.motions) motion.reset_work();
    nodes_.x0 = nodes_.x;
    kick_ = {};
    strain_work_ = hourglass_work_ = viscous_work_ = damping_work_ = damping_ahead_ = 0;
    plastic_work_ = 0;
    contact_.work = 0;
    stiffness_damping_.reset_work();
    model_.far_field.reset_work();
    if (model_.water) model_.water->load.work = 0;
    for (PressureLoad& pressure : model_.pressures) pressure.load.work = 0;
    for (TractionLoad& traction : model_.tractions) traction.load.work = 0;
    for (RigidBody& body : bodies_) body.count_from_here();
    for (ContactPair& pair : pairs_) pair.count_from_here();
    if (implicit_) implicit_->count_from_here();
}

Residual Structure::residual() const {
    Residual r;
    std::size_t free_nodes = 0;
    const auto norm = [](const Vec3& a) {
        return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    };
    const double g = norm(model_.gravity);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        bool is_free = false;
        for (int d = 0; d < 3; ++d) {
            if (nodes_.inverse_mass[n].c[d] == 0) continue;
            is_free = true;
            const double weight = nodes_.mass[n] * nodes_.weight_share[n] * model_.gravity[d];
            const double f = std::abs(nodes_.f[n].c[d] + weight);
            if (f > r.node) {
                r.node = f;
                r.at = std::int32_t(n);
            }
        }
        if (!is_free) continue;
        ++free_nodes;
        r.reference += nodes_.mass[n] * std::abs(nodes_.weight_share[n]) * g;
    }
    if (free_nodes > 0) r.reference /= double(free_nodes);
    for (const RigidBody& body : bodies_) {
        const Wrench pull = body.unbalanced(nodes_, model_.gravity);
        const double weight = body.set().weight_mass * g;
        if (weight == 0) continue;
        r.body = std::max({r.body, norm(pull.force) / weight,
                           norm(pull.moment) / (weight * body.reach())});
    }
    return r;
}

void Structure::finish() {
    contact_.add_to(nodes_.f);  // the coupler sends none for the last state: take those before it
    if (!faces_.empty()) faces_.add_moments(contact_.force, *elements_.turning_nodes());
    if (model_.water) model_.water->load.add_to(nodes_.f);
    kick(dt_);
}

const StableStep& Structure::stable_step() {
    // Tightening holds for the shape in which it was found: a tenth more in any element's own
    // bound, and it is found anew.
    if (report_.stiffening > 1.1) find_frequency();
    const double b2 = model_.bulk_viscosity.quadratic;
    const double omega = tightening_ * std::sqrt(report_.omega2);
    const double xi = model_.bulk_viscosity.linear + b2 * b2 * report_.compression +
                      0.5 * model_.damping_beta * omega;
    const auto limit_to = [&](double dt, const char* limiter) {
        if (dt >= stable_.dt) return;
        stable_.dt = dt;
        if (stable_.limiter != limiter) stable_.limiter = limiter;
        named_omega2_ = 0;  // name the element again when it limits
    };
    if (omega == 0 && !implicit_) {  // rigid bodies alone: a number that any other limit undercuts
        stable_ = {1e9, "nothing that deforms"};
        return stable_;
    }
    stable_.dt = 1e300;
    if (omega == 0)
        limit_to(std::min(1e9, model_.max_step), "nothing but implicit parts");
    else
        stable_.dt = 2 / omega * (std::sqrt(model_.cfl * model_.cfl + xi * xi) - xi);
    // the springs of contact are made for the step of the start
    for (const ContactPair& pair : pairs_) stable_.dt = std::min(stable_.dt, pair.largest_step());
    if (omega > 0 && std::abs(report_.omega2 - named_omega2_) > 1e-4 * report_.omega2) {
        const std::size_t e = elements_.stiffest();
        stable_.limiter = model_.mesh.element_name(e) + " of " + elements_.part_name(e);
        named_omega2_ = report_.omega2;
    }
    if (implicit_) limit_to(implicit_->largest_step(model_.cfl), "tension in implicit parts");
    return stable_;
}

void Structure::check_health(std::int64_t n, double t) const {
    const auto when = [&] {  // made only for a sentence: not in every step
        return "at t = " + number_text(t) + " s (step " + std::to_string(n) + ") ";
    };
    const double sum = report_.strain_work + report_.hourglass_work + kick_.kinetic;
    if (!std::isfinite(sum) || !(report_.relative_volume > 0)) {
        const std::size_t e = elements_.most_compressed(nodes_);
        throw PhysicsError(
            when() + model_.mesh.element_name(e) + " of " + elements_.part_name(e) +
            (std::isfinite(sum)
                 ? " has inverted (V/V0 = " + number_text(report_.relative_volume) + ")"
                 : " holds values that are not finite") +
            "; lower fem.cfl, refine the mesh there, or look for a load that is too large.");
    }
    if (n % steps_between_shape_checks == 0) check_shape(when());
    const double speed = std::sqrt(kick_.speed2), sound = elements_.largest_wave_speed();
    if (speed > sound)
        throw PhysicsError(when() + "a node of the structure moves at " + number_text(speed) +
                           " m/s, faster than sound in it (" + number_text(sound) +
                           " m/s): the computation is unstable; lower fem.cfl, or, if that speed of "
                           "sound is not the material's, mend young_modulus [Pa] and density [kg/m3].");
}

void Structure::check_shape(const std::string& when) const {
    const WorstCorner worst = worst_corner(model_.mesh, nodes_.x, threads_);
    if (worst.share > lost_corner) return;
    const double* x = nodes_.x[worst.node].c;
    throw PhysicsError(when + model_.mesh.element_name(worst.element) + " of " +
                       elements_.part_name(worst.element) + " has folded at " +
                       point_text({x[0], x[1], x[2]}) + " (the Jacobian of that corner is " +
                       number_text(worst.share, 3) + " of what it was, must be > " +
                       number_text(lost_corner, 3) +
                       "): the mesh no longer follows the "
                       "deformation; refine it there, or look for a load that is too large.");
}

Energies Structure::energies() const {
    Energies e;
    e.kinetic = kick_.kinetic;
    e.internal = strain_work_ - plastic_work_;
    e.plastic = plastic_work_;
    e.hourglass = hourglass_work_;
    e.bulk_viscosity = viscous_work_;
    e.damping = damping_work_ + stiffness_damping_.dissipated();
    e.far_field = model_.far_field.dissipated();
    e.external = model_.far_field.reaction_work();
    if (model_.water) e.external += model_.water->load.work;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {  // weight: a potential, so its work is exact
        if (!is_rigid_.empty() && is_rigid_[n]) continue;
        for (int d = 0; d < 3; ++d)
            e.external += nodes_.mass[n] * nodes_.weight_share[n] * model_.gravity[d] *
                          (nodes_.x[n].c[d] - nodes_.x0[n].c[d]);
    }
    for (const RigidBody& body : bodies_) e.external += body.weight_work(model_.gravity);
    for (const ContactPair& pair : pairs_) {
        e.pair_springs += pair.elastic_energy();
        e.pair_friction += pair.friction_work();
        e.pair_damping += pair.damping_work();
    }
    if (implicit_) {
        e.implicit = implicit_->energy();
        e.implicit_damping = implicit_->damping_work();
        e.implicit_change = implicit_->change_work();
    }
    for (const PressureLoad& pressure : model_.pressures) e.external += pressure.load.work;
    for (const TractionLoad& traction : model_.tractions) e.external += traction.load.work;
    for (const PrescribedMotion& motion : model_.motions) e.external += motion.work();
    e.contact = contact_.work;
    e.start = start_energy_;
    return e;
}

Vec3 Structure::velocity(std::int32_t node) const {
    Vec3 v;
    for (int d = 0; d < 3; ++d) {
        const double im = nodes_.inverse_mass[node].c[d];
        const double a =
            im == 0 ? 0 : nodes_.f[node].c[d] * im + nodes_.weight_share[node] * model_.gravity[d];
        const double v_half = nodes_.v[node].c[d];
        // v^n = v^{n+1/2} - a' span/2, a' = a - alpha v^n; what is held, told or rigid is not damped
        // as a node
        v[d] = im == 0 ? v_half
                       : (v_half - 0.5 * kick_span_ * a) / (1 - 0.5 * kick_span_ * model_.damping);
    }
    return v;
}

Row Structure::surface_position(std::size_t i) const {
    const Row x = as_row(nodes_.x[contact_.node[i]]);
    return faces_.empty() ? x : x + faces_.lever(i);
}

Row Structure::surface_velocity(std::size_t i) const {
    const Row v = as_row(nodes_.v[contact_.node[i]]);
    return faces_.empty() ? v : v + faces_.velocity(i, *elements_.turning_nodes());
}

double Structure::surface_mass(std::size_t i) const {
    const double mass = nodes_.mass[contact_.node[i]];
    return faces_.empty() ? mass : faces_.mass(i, mass, *elements_.turning_nodes());
}

Vec3 Structure::displacement(std::int32_t node) const {
    Vec3 u;
    for (int d = 0; d < 3; ++d) u[d] = nodes_.x[node].c[d] - nodes_.x0[node].c[d];
    return u;
}

Vec3 Structure::reaction(const Support& support) const {
    Vec3 r{};
    for (std::int32_t n : support.nodes)
        for (int d = 0; d < 3; ++d)
            if (support.fixed[d])
                r[d] -=
                    nodes_.f[n].c[d] + nodes_.mass[n] * nodes_.weight_share[n] * model_.gravity[d];
    return r;
}

double Structure::largest_displacement() const {
    double largest = 0;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        const Vec3 u = displacement(std::int32_t(n));
        largest = std::max(largest, u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    }
    return std::sqrt(largest);
}

}  // namespace undertow::fem
