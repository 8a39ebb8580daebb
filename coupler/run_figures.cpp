#include "coupler/run_figures.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "coupler/wall_clock.hpp"
#include "results/summary.hpp"

namespace undertow::coupler {

namespace {

/// "fem: hexahedron 17 of wall" -> "fem: hexahedron # of wall": one share per kind of limit.
void without_numbers(const std::string& limiter, std::string& kind) {
    kind.clear();
    for (char c : limiter) {
        if (!std::isdigit(static_cast<unsigned char>(c)))
            kind += c;
        else if (kind.empty() || kind.back() != '#')
            kind += '#';
    }
}

/// A summary key: dots would make nested objects.
std::string key_of(std::string text) {
    std::replace(text.begin(), text.end(), '.', '_');
    return text;
}

}  // namespace

RunFigures::RunFigures() : start_(wall_seconds()) {}

double RunFigures::wall() const {
    return wall_seconds() - start_;
}

void RunFigures::count(const AgreedStep& step, const contact::PenaltyContact& contact) {
    dt_min_ = steps_ == 0 ? step.dt : std::min(dt_min_, step.dt);
    dt_max_ = std::max(dt_max_, step.dt);
    dt_sum_ += step.dt;
    ++steps_;
    if (step.output) ++outputs_;
    for (double f : contact.on_particles()) largest_force_ = std::max(largest_force_, std::abs(f));
    without_numbers(step.limiter, kind_);
    ++limited_by_[kind_];
    momentum_residual_ = std::max(momentum_residual_, contact.momentum_residual());
}

ProgressFigures RunFigures::live(const AgreedStep& step, const Participants& participants,
                                 const Recorder& recorder, double t_end) const {
    ProgressFigures figures;
    figures.t = step.t1;
    figures.t_end = t_end;
    figures.n = steps_;
    figures.dt = step.dt;
    figures.limiter = step.limiter;
    figures.particle_steps = participants.work(Participants::particles);
    figures.element_steps = participants.work(Participants::surface);
    figures.force = recorder.total_force();
    // Whoever the others wait for is the one that computes; while both are awaited, both do.
    const Waits& waits = participants.waits();
    const double whole = std::max(wall(), 1e-9);
    const auto percent = [&](double seconds) { return int(std::lround(100 * seconds / whole)); };
    char text[160];
    std::snprintf(text, sizeof text, "waits for %s %d %%, %s %d %%, both %d %%",
                  participants.name(Participants::particles).c_str(), percent(waits.for_particles),
                  participants.name(Participants::surface).c_str(), percent(waits.for_surface),
                  percent(waits.for_both));
    figures.waiting = text;
    return figures;
}

void RunFigures::write(const std::string& path, const std::string& reason, double t,
                       const Participants& participants, const Recorder& recorder,
                       const contact::PenaltyContact& contact, std::int64_t late_searches) const {
    const double steps = double(std::max<std::int64_t>(steps_, 1));
    Summary summary;
    summary.set("finish", reason);
    summary.set("interrupted", reason == "interrupted");
    summary.set("t", t);
    summary.set("outputs", outputs_);
    summary.set("steps", steps_);
    summary.set("wall_s", wall());
    summary.set("dt_min", dt_min_);
    summary.set("dt_mean", dt_sum_ / steps);
    summary.set("dt_max", dt_max_);
    for (const auto& [limiter, count] : limited_by_)
        summary.set("limiters." + key_of(limiter), 100 * double(count) / steps);
    summary.set("momentum_residual",
                largest_force_ > 0 ? momentum_residual_ / largest_force_ : 0.0);
    summary.set("interface_work_residual", contact.energy().relative_residual());
    summary.set("interface_energy.work_particles", contact.energy().work_particles);
    summary.set("interface_energy.work_surface", contact.energy().work_surface);
    summary.set("interface_energy.penalty", contact.energy().penalty);
    summary.set("interface_energy.damping", contact.energy().damping);
    summary.set("interface_energy.friction", contact.energy().friction);
    summary.set("interface_energy.relaxation", contact.energy().relaxation);
    summary.set("interface_energy.impact", contact.energy().impact);
    summary.set("interface_energy.uneven", contact.energy().uneven);
    summary.set("interface_energy.turning", contact.energy().turning);
    summary.set("interface_numerical_loss", contact.energy().relative_numerical_loss());
    summary.set("transport", participants.transport());
    summary.set("bytes_per_step", participants.bytes() / steps);
    summary.set("searches", searches_);
    summary.set("surface_shown", shows_);
    summary.set("late_searches", late_searches);
    summary.set("contact_s", recorder.contact_time());
    summary.set("contacts_max", std::int64_t(recorder.most_contacts()));
    summary.set("start_inside.particles", contact.start_inside().particles);
    summary.set("start_inside.deepest_over_l0", contact.start_inside().deepest);
    summary.set("start_inside.id", std::int64_t(contact.start_inside().id));
    summary.set("penetration_max_over_l0", recorder.deepest());
    if (checkpoints_.written > 0) {
        summary.set("checkpoint.written", checkpoints_.written);
        summary.set("checkpoint.s_each", checkpoints_.seconds / double(checkpoints_.written));
    }
    const Waits& waits = participants.waits();
    const double whole = std::max(wall(), 1e-9);
    summary.set("wait_for_particles_s", waits.for_particles);
    summary.set("wait_for_surface_s", waits.for_surface);
    summary.set("wait_for_both_s", waits.for_both);
    summary.set("wait_fraction",
                (waits.for_particles + waits.for_surface + waits.for_both) / whole);
    summary.set("sph_wait_fraction", participants.waited(Participants::particles) / whole);
    summary.set("fem_wait_fraction", participants.waited(Participants::surface) / whole);
    for (std::size_t s = 0; s < recorder.names().size(); ++s) {
        const contact::Vec impulse = recorder.impulse(s);
        const std::string key = "impulse." + key_of(recorder.names()[s]);
        summary.set(key + ".x", impulse[0]);
        summary.set(key + ".y", impulse[1]);
        summary.set(key + ".z", impulse[2]);
    }
    summary.write(path);
}

}  // namespace undertow::coupler
