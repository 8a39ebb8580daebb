#include "coupler/participants.hpp"

#include <chrono>
#include <utility>

#include "case/binding_keys.hpp"
#include "checkpoint/archive.hpp"
#include "coupler/wall_clock.hpp"
#include "results/log.hpp"
#include "results/stop_signal.hpp"

namespace undertow::coupler {

namespace {

/// Why a program that was started with this case must not join; empty: it may.
std::string objection_to(const wire::Hello& hello, const std::vector<std::string>& ours) {
    const auto difference = first_difference(ours, hello.case_keys);
    if (!difference) return {};
    const auto& [key, ours_is, theirs_is, count] = *difference;
    const bool told =
        !(ours_is && ours_is->starts_with('#')) && !(theirs_is && theirs_is->starts_with('#'));
    std::string sentence = hello.name + " was started with another case than the coupler: ";
    if (key.find('.') == std::string::npos)
        sentence += "table [" + key + "] differs";
    else if (!told)
        sentence += key + " differs";
    else
        sentence += key + " is " + theirs_is.value_or("not there") + ", in the coupler's case " +
                    ours_is.value_or("not there");
    const std::size_t more = count - 1;
    if (more > 0) sentence += " (and " + std::to_string(more) + " more)";
    sentence += "; start all programs with the same file, --level, --with and --set";
    log_warning("refused: " + sentence);
    return sentence;
}

wire::HostOptions options_for(const MeetingPlace& place, const Case& input,
                              std::int64_t first_step, double t0) {
    wire::HostOptions options;
    options.endpoint = place.endpoint;
    options.join_timeout = input.coupling.join_timeout;
    options.deadline = input.coupling.deadline;
    options.shared_memory = input.coupling.transport == "shm";
    options.stop = stop_requested;
    options.loss = loss_announced;
    options.objection = [ours = binding_keys(input)](const wire::Hello& hello) {
        return objection_to(hello, ours);
    };
    options.curve = place.keys;
    options.record_in = place.record_in;
    options.welcome.first_step = first_step;
    options.welcome.t0 = t0;
    options.welcome.t_end = input.time.end;
    if (input.checkpoint.present) options.welcome.capabilities = {"checkpoint"};
    options.welcome.contact_share = input.coupling.beta + 2 * input.coupling.damping;
    return options;
}

/// Calls visit with the STATE or PROBE in it.
template <typename Visit>
auto with_step(const wire::Message& message, Visit visit) {
    if (const auto* probe = std::get_if<wire::Probe>(&message)) return visit(*probe);
    return visit(std::get<wire::State>(message));
}

}  // namespace

Participants::Participants(const MeetingPlace& place, const Case& input, std::int64_t first_step,
                           double t0)
    : host_(options_for(place, input, first_step, t0)) {}

void Participants::join() {
    host_.wait_join();
    meshes_ = host_.wait_meshes();
}

void Participants::receive() {
    std::array<bool, 2> here{};
    double since = wall_seconds();
    while (!here[particles] || !here[surface]) {
        // Every second or so, so that a message is never waited for inside an interrupted call.
        while (!host_.next_within(1.0, incoming_)) {
        }
        const auto who = Role(incoming_.participant);
        const double now = wall_seconds();
        double& wait = !here[particles] && !here[surface] ? waits_.for_both
                       : who == particles                 ? waits_.for_particles
                                                          : waits_.for_surface;
        wait += now - since;
        since = now;
        here[who] = true;
        last_to_come_ = who;
        std::swap(latest_[who], incoming_.message);
        note_offer(who);
    }
}

/// The limiter with who it belongs to in front, if it does not say so itself.
void Participants::note_offer(Role role) {
    with_step(latest_[role], [&](const auto& step) {
        const std::string& owner = host_.name(role);
        const std::string_view text = step.limiter;
        const bool named = text.starts_with(owner) && text.substr(owner.size()).starts_with(": ");
        StepOffer& offer = offers_[role];
        offer.dt = step.dt_limit;
        offer.limiter.clear();
        if (!named) offer.limiter.append(owner).append(": ");
        offer.limiter.append(text);
    });
}

double Participants::work(Role role) const {
    return with_step(latest_[role], [](const auto& step) { return step.work; });
}

double Participants::waited(Role role) const {
    return with_step(latest_[role], [](const auto& step) { return step.wait; });
}

bool Participants::wants_to_stop() const {
    for (const wire::Message& message : latest_)
        if (with_step(message, [](const auto& step) { return step.flags & wire::state_stop; }))
            return true;
    return false;
}

std::array<wire::CheckpointAck, 2> Participants::write_checkpoints(std::int64_t n,
                                                                   const std::string& id) {
    for (const Role role : {particles, surface}) host_.send(role, wire::Checkpoint{0, n, id});
    std::array<wire::CheckpointAck, 2> acks;
    std::array<bool, 2> here{};
    while (!here[particles] || !here[surface]) {
        while (!host_.next_within(1.0, incoming_)) {
        }
        acks[incoming_.participant] = std::get<wire::CheckpointAck>(incoming_.message);
        here[incoming_.participant] = true;
    }
    return acks;
}

void Participants::archive(Archive& a) {
    const auto common = [&](auto& step) {
        a("n", step.n);
        a("t", step.t);
        a("dt_limit", step.dt_limit);
        a("limiter", step.limiter);
        a("flags", step.flags);
        a("work", step.work);
        a("x", step.x);
        a("v", step.v);
        if (a.reading()) step.flags &= ~std::uint32_t(wire::state_stop);
    };
    for (const Role role : {particles, surface}) {
        const Archive::Group group(a, role == particles ? "particles" : "surface");
        bool is_probe = std::holds_alternative<wire::Probe>(latest_[role]);
        a("is_probe", is_probe);
        if (is_probe) {
            if (a.reading()) latest_[role] = wire::Probe{};
            wire::Probe& probe = std::get<wire::Probe>(latest_[role]);
            common(probe);
            a("id", probe.id);
            a("mass", probe.mass);
            a("radius", probe.radius);
            a("stiffness", probe.stiffness);
            a("phase", probe.phase);
        } else {
            if (a.reading()) latest_[role] = wire::State{};
            wire::State& state = std::get<wire::State>(latest_[role]);
            common(state);
            a("revision", state.revision);
            a("reach", state.reach);
        }
        if (a.reading()) note_offer(role);
    }
}

void Participants::send_surface(wire::Surface message) {
    host_.send(particles, std::move(message));
}

void Participants::send_active(wire::Active message) {
    host_.send(particles, std::move(message));
}

void Participants::send_forces(const wire::Force& common, std::span<const double> on_particles,
                               std::span<const double> on_nodes) {
    const auto send = [&](Role role) {
        wire::Force& force = std::get<wire::Force>(forces_[role]);
        const auto f = role == particles ? on_particles : on_nodes;
        force.n = common.n;
        force.dt = common.dt;
        force.t1 = common.t1;
        force.limiter = common.limiter;
        force.flags = common.flags;
        if (role == surface) force.flags &= ~std::uint32_t(wire::force_probe);
        force.f.assign(f.begin(), f.end());
        host_.send(role, std::move(forces_[role]));
    };
    send(last_to_come_);
    send(last_to_come_ == particles ? surface : particles);
}

const char* Participants::transport() const {
    return host_.shares_memory() ? "shm" : host_.endpoint().starts_with("tcp:") ? "tcp" : "ipc";
}

void Participants::finish(std::int64_t n, const std::string& reason) {
    host_.finish(n, reason);
}

void Participants::broadcast(const std::string& code, const std::string& text) noexcept {
    host_.broadcast_error(code, text, "coupler");
}

}  // namespace undertow::coupler
