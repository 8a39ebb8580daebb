#include "coupler/coupler.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "contact/boxes.hpp"
#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "results/summary.hpp"
#include "wire/errors.hpp"

namespace undertow::coupler {

namespace {

// Round-off of 10^6 steps, and the quantum of the forces: 2^-40 of the largest.
constexpr double books_close = 1e-9;
// The particle solver is shown the surface again when a node has gone this far [dx].
constexpr double show_again = 0.02;

contact::LawSettings law_of(const CouplingSettings& settings) {
    contact::LawSettings law;
    law.stiffness = settings.law == StiffnessLaw::fluid ? contact::StiffnessKind::fluid
                                                        : contact::StiffnessKind::eq11;
    law.chi = settings.stiffness_factor;
    law.beta = settings.beta;
    law.eta = settings.damping;
    law.ease_start = true;
    law.friction = settings.friction_law == FrictionLaw::coulomb ? contact::FrictionKind::coulomb
                                                                 : contact::FrictionKind::viscous;
    law.mu = settings.friction;
    law.alpha = settings.viscous_coefficient;
    return law;
}

double largest_speed(std::span<const double> v) {
    double largest2 = 0;
    for (std::size_t i = 0; i + 2 < v.size(); i += 3)
        largest2 = std::max(largest2, v[i] * v[i] + v[i + 1] * v[i + 1] + v[i + 2] * v[i + 2]);
    return std::sqrt(largest2);
}

}  // namespace

Coupler::Coupler(const Case& input, const CouplerOptions& options)
    : input_(input),
      options_(options),
      from_(options.resume.empty() ? std::optional<Manifest>()
                                   : std::optional(read_manifest(options.resume))),
      participants_(options.place, input, from_ ? from_->step : 0, from_ ? from_->t : 0),
      clock_(input.checkpoint, 0),
      progress_(options.quiet, options.folder + "/status.json"),
      agreement_(input.time, input.output.fields_every) {
    log_info("waiting for participants at " + participants_.endpoint());
}

int Coupler::run() {
    try {
        return run_loop();
    } catch (const std::exception& error) {
        const Failure failure = failure_of(error);
        participants_.broadcast(failure.code, error.what());
        write_failure(failure);
        throw;
    }
}

int Coupler::run_loop() {
    participants_.join();
    prepare();
    if (from_) n_ = from_->step;
    send_boxes();
    for (;; ++n_) {
        participants_.receive();
        if (from_ && n_ == from_->step) resume();
        const std::string reason = reason_to_end();
        if (pressure_ && pressure_->due(t_, n_ == 0 || step_.output)) write_fields();
        if (checkpoint_due(reason)) write_checkpoint();
        if (!reason.empty()) return finish(reason);

        update_contact();
        resumed_ = false;
        const AgreedStep& step = agree_time_step();
        contact_->compute_forces(step.dt);
        send_forces(step);
        if (n_ == 0) report_start_inside();

        contact_->settle();
        record(step);
        t_ = step.t1;
    }
}

void Coupler::prepare() {
    for (const auto role : {Participants::particles, Participants::surface})
        log_info(participants_.name(role) + " (" + participants_.software(role) + ") has joined");
    log_info(std::string("states and forces travel by ") + participants_.transport());
    check_capabilities();
    clock_.written(from_ ? from_->t : 0);
    joint_ = join_surfaces(participants_.surface_meshes());
    const wire::Mesh& particles = participants_.particle_mesh();
    boxed_ = std::make_unique<contact::Surface>(joint_.quad, joint_.mass);
    contact_ = std::make_unique<contact::PenaltyContact>(*boxed_, law_of(input_.coupling));
    // The skin is given in spacings; a spacing is two radii.
    budget_ = std::make_unique<SearchBudget>(particles.radius,
                                             input_.coupling.skin * 2 * particles.radius);
    recorder_ = std::make_unique<Recorder>(options_.folder, input_, joint_, particles.groups,
                                           from_ ? FileStart::continued : FileStart::fresh);
    if (input_.output.contact_fields)
        pressure_ = std::make_unique<PressureField>(options_.folder, joint_, input_.output.contact_every,
                                                    from_ ? FileStart::continued : FileStart::fresh);
    figures_ = std::make_unique<RunFigures>();
    log_info("coupled surface: " + std::to_string(joint_.quad.size() / 4) + " facets, " +
             std::to_string(joint_.mass.size()) + " nodes, " + std::to_string(joint_.names.size()) +
             " names");
}

std::string Coupler::reason_to_end() const {
    if (step_.last) return "done";
    if (stop_requested() || participants_.wants_to_stop()) return "interrupted";
    return {};
}

void Coupler::update_contact() {
    const wire::State& surface = participants_.surface_state();
    if (surface.revision != 0)
        throw PeerError("E_MESH", participants_.name(Participants::surface) +
                                      " changed its mesh at step " + std::to_string(n_) +
                                      "; this coupler keeps the mesh of the start.");
    if (participants_.searching()) {
        search();
        return;
    }
    const wire::State& particles = participants_.particle_state();
    if (resumed_) send_same_active();
    budget_->moved(particles.reach, surface.x, step_.dt);
    contact_->update(particles.x, particles.v, surface.x, surface.v, longest_step());
    if (budget_->late() == 0 || late_reported_) return;
    late_reported_ = true;  // once is enough; the summary has the count
    char text[300];
    std::snprintf(
        text, sizeof text,
        "step %lld, t = %.6g s: particles and surface have approached by up to %.3g m since "
        "the last search, its skin allows %.3g m. A contact may have been found one step "
        "late; raise coupling.skin.",
        static_cast<long long>(n_), t_, budget_->used(), budget_->allowance());
    log_warning(text);
}

void Coupler::search() {
    const wire::Probe& probe = participants_.probe();
    const wire::State& surface = participants_.surface_state();
    const double announced = participants_.particle_mesh().radius;
    for (std::size_t i = 0; i < probe.radius.size(); ++i)
        if (probe.radius[i] > announced * (1 + 1e-12))
            throw PeerError("E_MESH", "particle " + std::to_string(probe.id[i]) + " has radius " +
                                          std::to_string(probe.radius[i]) + " m, more than the " +
                                          std::to_string(announced) + " m announced.");
    budget_->searched(surface.x, std::max(largest_speed(probe.v), largest_speed(surface.v)));
    contact_->rebuild({probe.x, probe.v, probe.mass, probe.radius, probe.stiffness, probe.id},
                      budget_->skin(), surface.x, surface.v, longest_step());
    figures_->count_search();
    phase_.clear();
    for (std::uint32_t row : contact_->active_rows()) phase_.push_back(probe.phase[row]);
    send_active();
}

/// What contact's own vote is compared with: a longer one would not be heard.
double Coupler::longest_step() const {
    return std::min(participants_.offer(Participants::particles).dt,
                    participants_.offer(Participants::surface).dt);
}

const AgreedStep& Coupler::agree_time_step() {
    offers_[0] = participants_.offer(Participants::particles);
    offers_[1] = participants_.offer(Participants::surface);
    offers_[2].dt = contact_->step_limit();
    offers_[2].limiter = "contact: speed of approach";
    return agreement_.agree(t_, offers_);
}

/// Where the surfaces are, and the boxes outside of which no particle can touch before the search
/// after this one.
void Coupler::send_boxes() {
    // Before the first step the announced mesh is all there is.
    const bool started = contact_->surface().x().size() > 0;
    wire::Surface message;
    message.n = n_;
    message.range = budget_->box_range();
    message.x = started ? participants_.surface_state().x : joint_.x;
    message.quad = joint_.quad;
    boxed_->move(message.x, {});
    message.boxes = contact::boxes_around(*boxed_, message.range);
    budget_->boxes_sent(message.x);
    participants_.send_surface(std::move(message));
    figures_->count_show();
}

void Coupler::send_active() {
    wire::Active active;
    active.n = n_;
    active.row.assign(contact_->active_rows().begin(), contact_->active_rows().end());
    participants_.send_active(std::move(active));
}

/// To who is resumed in the middle of an ACTIVE list: its PROBE had the rows of that list.
void Coupler::send_same_active() {
    wire::Active active;
    active.n = n_;
    for (std::uint32_t row = 0; row < phase_.size(); ++row) active.row.push_back(row);
    participants_.send_active(std::move(active));
}

/// The fluid's images behind the surface lose volume when they lag behind it.
bool Coupler::shows_motion() const {
    return input_.sph.surface_images &&
           budget_->since_boxes(participants_.surface_state().x) >
               show_again * 2 * participants_.particle_mesh().radius;
}

void Coupler::send_forces(const AgreedStep& step) {
    if (!contact_->finite())
        throw PhysicsError("The contact forces of step " + std::to_string(n_) +
                           " are not finite although all positions and velocities are: a mass, "
                           "radius or stiffness is out of range.");
    wire::Force& force = force_;
    force.flags = 0;
    force.n = n_;
    force.dt = step.dt;
    force.t1 = step.t1;
    force.limiter = step.limiter;
    if (step.output) force.flags |= wire::force_output;
    if (budget_->due(step.dt)) {
        force.flags |= wire::force_probe;
        send_boxes();
    } else if (shows_motion()) {
        send_boxes();
    }
    participants_.send_forces(force, contact_->on_particles(), contact_->on_nodes());
}

/// A particle whose center is inside may be on its way into a body: that is a mistake in the case.
void Coupler::report_start_inside() const {
    const contact::ForceLaw::StartInside& inside = contact_->start_inside();
    if (inside.particles == 0) return;
    char text[400];
    std::snprintf(text, sizeof text,
                  "%lld particles start inside the coupled surface, the deepest, particle %llu, by %.2f "
                  "l0%s; they are pushed out slowly. Leave half a spacing between fluid and structure "
                  "to avoid it.",
                  static_cast<long long>(inside.particles),
                  static_cast<unsigned long long>(inside.id), inside.deepest,
                  inside.deepest > 1 ? " (its center is behind the surface; what lies deeper than "
                                       "that is not seen and stays there)"
                                     : "");
    inside.deepest > 1 ? log_warning(text) : log_info(text);
}

void Coupler::record(const AgreedStep& step) {
    recorder_->record({t_, step.dt}, *contact_, phase_);
    if (pressure_) pressure_->count(*contact_);
    figures_->count(step, *contact_);
    step_ = step;
    if (progress_.due()) progress_.update(live());
}

/// For the live line; made only when it is due.
ProgressFigures Coupler::live(std::string doing) const {
    ProgressFigures figures = figures_->live(step_, participants_, *recorder_, input_.time.end);
    figures.doing = std::move(doing);
    return figures;
}

/// At the end after the last checkpoint, which
/// a run that goes on must not find in it.
void Coupler::write_fields() {
    if (pressure_) pressure_->write(t_, participants_.surface_state().x);
}

int Coupler::finish(const std::string& reason) {
    recorder_->finish(*contact_);
    write_fields();
    participants_.finish(n_, reason);
    progress_.finish(live());
    figures_->write(options_.folder + "/summary.coupler.json", reason, t_, participants_,
                    *recorder_, *contact_, budget_->late());
    if (const double residual = contact_->energy().relative_residual(); residual > books_close)
        log_warning("the energy of the interface does not close: " + std::to_string(residual) +
                    " of what passed it is not accounted for (summary.coupler.json, "
                    "interface_work_residual); this is a defect, please report it with the case");
    log_info(reason + " at t = " + std::to_string(t_) + " s after " +
             std::to_string(figures_->steps()) + " steps");
    return reason == "done" ? exit_done : exit_interrupted;
}

/// What the summary of a run that failed can say: why, and how far it came.
void Coupler::write_failure(const Failure& failure) const noexcept {
    try {
        Summary summary;
        summary.set("finish", failure.exit == exit_interrupted ? "interrupted" : "failed");
        summary.set("interrupted", failure.exit == exit_interrupted);
        summary.set("cause", failure.text);
        summary.set("exit_code", std::int64_t(failure.exit));
        summary.set("step", n_);
        summary.set("t", t_);
        summary.set("steps", figures_ ? figures_->steps() : 0);
        summary.set("wall_s", figures_ ? figures_->wall() : 0.0);
        summary.write(options_.folder + "/summary.coupler.json");
    } catch (const std::exception& error) {
        log_error(std::string("no summary.coupler.json: ") + error.what());
    }
}

}  // namespace undertow::coupler
