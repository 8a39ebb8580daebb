#include "sph_solver/coupling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "case/binding_keys.hpp"
#include "case/time_step.hpp"
#include "checkpoint/own_checkpoints.hpp"
#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "wire/errors.hpp"
#include "wire/participant.hpp"

namespace undertow::sph {

namespace {

/// Nobody at the other end: the solver agrees with itself.
class LonelyLink : public Link {
 public:
    LonelyLink(const Case& input, const std::string& folder)
        : agreement_(input.time, input.output.fields_every),
          checkpoints_(input, folder, "sph"),
          end_(input.time.end) {}

    void offer(const StepState& state, const FluidSystem&) override { state_ = state; }

    const StepOrder& wait(FluidSystem&) override {
        StepOrder& order = order_;
        order.checkpoint.clear();
        order.interrupted = stop_requested();
        order.finished = last_ || order.interrupted || state_.t >= end_;
        // the step is agreed after its checkpoint, which must not know it
        if (kept_ != state_.n &&
            checkpoints_.due(state_.n, state_.t, order.finished, order.interrupted)) {
            order.checkpoint = checkpoint_id(state_.n);
            return order;
        }
        if (order.finished) return order;
        offers_[0].dt = state_.dt_limit;
        offers_[0].limiter = state_.limiter;
        const AgreedStep& step = agreement_.agree(state_.t, offers_);
        order.dt = step.dt, order.t1 = step.t1;
        order.output = step.output;
        order.limiter = step.limiter;
        last_ = step.last;
        return order;
    }

    void confirm(const WrittenFile& file) override {
        checkpoints_.complete(state_.n, state_.t, file);
        kept_ = state_.n;
    }
    void archive(Archive& a) override { a.object("agreement", agreement_); }
    void report_error(const std::string&, const std::string&) noexcept override {}

 private:
    StepAgreement agreement_;
    OwnCheckpoints checkpoints_;
    std::int64_t kept_ = -1;  // step of the last checkpoint
    double end_;
    StepState state_{};
    std::vector<StepOffer> offers_{1};
    StepOrder order_;  // its texts keep their memory from step to step
    bool last_ = false;
};

/// Particles near the surfaces, in the order agreed with the coupler.
class CoupledLink : public Link {
 public:
    CoupledLink(const Case& input, const std::string& endpoint, const std::string& keys)
        : participant_({.endpoint = endpoint,
                        .name = "sph",
                        .role = "particles",
                        .capabilities = {"checkpoint"},
                        .software = "undertow sph_solver " UNDERTOW_VERSION,
                        .join_timeout = input.coupling.join_timeout,
                        .case_keys = binding_keys(input),
                        .curve = keys,
                        .stop = stop_requested}),
          flat_(input.info.dimension == 2),
          middle_(flat_ ? 0.5 * input.info.thickness : 0) {
        wire::Mesh mesh;
        mesh.mesh = "particles";
        mesh.kind = "particles";
        for (const Fluid& fluid : input.sph.fluid) mesh.groups.push_back(fluid.name);
        double widest = 0;  // the largest spacing; [m]
        for (const Fluid& fluid : input.sph.fluid)
            widest = std::max(widest, fluid.spacing > 0 ? fluid.spacing : input.sph.spacing);
        mesh.radius = 0.5 * widest;
        participant_.announce(std::move(mesh));
        surface_ = participant_.wait_surface();
        boxes_ = surface_->boxes;
        log_info("joined the coupler at " + endpoint);
    }

    void offer(const StepState& state, const FluidSystem& fluid) override {
        if (resumed_)
            send_again(state, fluid);
        else if (probe_)
            send_probe(state, fluid);
        else
            send_state(state, fluid);
    }

    const StepOrder& wait(FluidSystem& fluid) override {
        participant_.wait_reply(reply_);
        wire::StepReply& reply = reply_;
        StepOrder& order = order_;
        order.checkpoint.clear();
        if (reply.checkpoint) {
            asked_ = reply.checkpoint->n;
            order.checkpoint = reply.checkpoint->id;
            return order;
        }
        if (reply.surface) {
            surface_ = std::move(*reply.surface);
            boxes_ = surface_->boxes;
        }
        if (surface_) show_surface(fluid);
        // a list that went on through the checkpoint is the one there is
        if (reply.active && (probe_ || !resumed_)) take_active(*reply.active, fluid);
        resumed_ = false;
        if (reply.finish) {
            order.finished = true;
            order.interrupted = reply.finish->reason == "interrupted";
            participant_.say_goodbye(reply.finish->n);
            if (const std::string verdict = participant_.replay_verdict(); !verdict.empty())
                log_info(verdict);
            return order;
        }
        const wire::Force& force = *reply.force;
        take_forces(force.f, fluid);
        probe_ = force.flags & wire::force_probe;
        order.dt = force.dt, order.t1 = force.t1;
        order.output = force.flags & wire::force_output;
        order.limiter = force.limiter;
        return order;
    }

    void confirm(const WrittenFile& file) override {
        wire::CheckpointAck ack;
        ack.n = asked_;
        ack.file = file.name;
        ack.sha256 = file.sha;
        participant_.send(std::move(ack));
    }

    void still_busy(const std::string& doing) override { participant_.still_busy(doing); }

    /// The surface that the coupler shows first is not news for a fluid that is resumed.
    void archive(Archive& a) override {
        a("boxes", boxes_);
        a("probe", probe_);
        a("candidates", candidates_);
        a("active", active_);
        a.flat<double>("last_x", last_x_);
        a("travelled_at_probe", travelled_at_probe_);
        if (!a.reading()) return;
        surface_.reset();
        resumed_ = true;
    }

    void report_error(const std::string& code, const std::string& text) noexcept override {
        participant_.report_error(code, text);
    }
    double waited() const override { return participant_.waited(); }

 private:
    void put(std::vector<double>& a, double x, double y, double z) {
        a.push_back(x), a.push_back(y), a.push_back(z);
    }

    void send_probe(const StepState& s, const FluidSystem& fluid) {
        wire::Probe probe;
        probe.n = s.n, probe.t = s.t, probe.dt_limit = s.dt_limit, probe.limiter = s.limiter;
        probe.flags = stop_requested() ? wire::state_stop : 0u;
        probe.work = s.work, probe.wait = waited();
        const Particles& p = fluid.particles;
        // rho c0^2 dx in 3D, rho c0^2 b in 2D: the force per penetration of a cell compressed by it
        std::vector<double> stiffness;   // [N/m] of each fluid
        for (const FluidLaw& f : fluid.fluids())
            stiffness.push_back(f.mass * std::pow(f.c0 / f.spacing, 2));
        candidates_.clear();
        for (std::size_t i = 0; i < p.size(); ++i) {
            const double y = p.y[i] + middle_;
            bool near = false;
            for (std::size_t b = 0; b + 5 < boxes_.size() && !near; b += 6)
                near = p.x[i] >= boxes_[b] && p.x[i] <= boxes_[b + 3] && y >= boxes_[b + 1] &&
                       y <= boxes_[b + 4] && p.z[i] >= boxes_[b + 2] && p.z[i] <= boxes_[b + 5];
            if (!near) continue;
            candidates_.push_back(p.id[i]);
            probe.id.push_back(static_cast<std::uint64_t>(p.id[i]));
            const Vec3 x = fluid.contact_point(int(i)), v = fluid.contact_velocity(int(i));
            put(probe.x, x[0], x[1] + middle_, x[2]);
            put(probe.v, v[0], v[1], v[2]);
            probe.mass.push_back(fluid.fluid_of(i).mass);
            probe.radius.push_back(0.5 * fluid.fluid_of(i).spacing);
            probe.stiffness.push_back(stiffness[p.fluid[i]]);
            probe.phase.push_back(p.fluid[i]);
        }
        travelled_at_probe_ = fluid.travelled();
        participant_.send(std::move(probe));
    }

    /// After a resume a session begins with a PROBE: of those that the last one had, or that are
    /// active. The coupler has kept what was said before the checkpoint and goes by that.
    void send_again(const StepState& s, const FluidSystem& fluid) {
        if (const std::int64_t first = participant_.welcome().first_step; first != s.n)
            throw InputError("the coupler goes on at step " + std::to_string(first) +
                             ", this program's checkpoint is of step " + std::to_string(s.n) +
                             ": resume all programs from the same set.");
        wire::Probe probe;
        probe.n = s.n, probe.t = s.t, probe.dt_limit = s.dt_limit, probe.limiter = s.limiter;
        probe.flags = stop_requested() ? wire::state_stop : 0u;
        probe.work = s.work, probe.wait = waited();
        for (const std::int64_t id : probe_ ? candidates_ : active_) {
            const int i = fluid.index_of(id);
            const Vec3 x = i < 0 ? Vec3{} : fluid.contact_point(i);
            probe.id.push_back(static_cast<std::uint64_t>(id));
            put(probe.x, x[0], x[1] + middle_, x[2]);
            put(probe.v, 0, 0, 0);
            const FluidLaw& law = i < 0 ? fluid.fluid() : fluid.fluid_of(std::size_t(i));
            probe.mass.push_back(law.mass);
            probe.radius.push_back(0.5 * law.spacing);
            probe.stiffness.push_back(0);
            probe.phase.push_back(i < 0 ? 0 : fluid.particles.fluid[i]);
        }
        participant_.send(std::move(probe));
    }

    void send_state(const StepState& s, const FluidSystem& fluid) {
        wire::State& state = state_;  // keeps its buffers from step to step
        state.x.clear();
        state.v.clear();
        state.n = s.n, state.t = s.t, state.dt_limit = s.dt_limit, state.limiter = s.limiter;
        state.flags = stop_requested() ? wire::state_stop : 0u;
        state.reach = fluid.travelled() - travelled_at_probe_;
        state.work = s.work, state.wait = waited();
        state.x.reserve(3 * active_.size());
        state.v.reserve(3 * active_.size());
        for (std::size_t a = 0; a < active_.size(); ++a) {
            const int i = fluid.index_of(active_[a]);
            if (i >= 0) {
                const Vec3 x = fluid.contact_point(i), v = fluid.contact_velocity(i);
                last_x_[a] = {x[0], x[1] + middle_, x[2]};
                put(state.v, v[0], v[1], v[2]);
            } else {   // left the domain: it rests where it was last seen until the next probe
                put(state.v, 0, 0, 0);
            }
            put(state.x, last_x_[a][0], last_x_[a][1], last_x_[a][2]);
        }
        participant_.send(std::move(state));
    }

    void show_surface(FluidSystem& fluid) {
        for (std::size_t k = 1; k < surface_->x.size(); k += 3) surface_->x[k] -= middle_;
        const std::size_t thin = fluid.plates().facets();
        fluid.place_surface(std::move(surface_->quad), std::move(surface_->x));
        surface_.reset();
        const ThinPlates& plates = fluid.plates();
        if (plates.facets() != thin)
            log_info(fmt::format(
                "{} of {} coupled facets belong to plates thinner than the kernel's support "
                "({:.4g} m): pairs of particles across them leave the neighbor lists",
                plates.facets(), plates.all_facets(), fluid.support()));
    }

    void take_active(const wire::Active& active, FluidSystem& fluid) {
        active_.clear();
        for (const std::uint32_t row : active.row) active_.push_back(candidates_.at(row));
        last_x_.assign(active_.size(), Vec3{});
        Particles& p = fluid.particles;
        for (auto* f : {&p.fx, &p.fy, &p.fz}) std::fill(f->begin(), f->end(), 0.0);
    }

    void take_forces(const std::vector<double>& f, FluidSystem& fluid) {
        Particles& p = fluid.particles;
        for (std::size_t a = 0; a < active_.size(); ++a) {
            const int i = fluid.index_of(active_[a]);
            if (i < 0) continue;
            const double per_mass = 1 / fluid.fluid_of(i).mass;
            p.fx[i] = f[3 * a] * per_mass;
            p.fy[i] = flat_ ? 0 : f[3 * a + 1] * per_mass;
            p.fz[i] = f[3 * a + 2] * per_mass;
        }
    }

    wire::Participant participant_;
    bool flat_;
    double middle_;                      // [m] out-of-plane position that the coupler sees in 2D
    std::vector<double> boxes_;          // [m] (B, 6)
    std::optional<wire::Surface> surface_;   // news for the fluid
    bool probe_ = true;
    bool resumed_ = false;                   // nothing has been said since
    wire::State state_;
    wire::StepReply reply_;
    StepOrder order_;
    std::int64_t asked_ = 0;                 // step of the checkpoint that is being written
    std::vector<std::int64_t> candidates_;   // identities in the order of the last PROBE
    std::vector<std::int64_t> active_;       // identities in the order of STATE and FORCE
    std::vector<Vec3> last_x_;               // [m] last seen positions of the active ones
    double travelled_at_probe_ = 0;          // [m]
};

}  // namespace

std::unique_ptr<Link> make_lonely_link(const Case& input, const std::string& folder) {
    return std::make_unique<LonelyLink>(input, folder);
}

std::unique_ptr<Link> make_coupled_link(const Case& input, const std::string& endpoint,
                                        const std::string& keys) {
    return std::make_unique<CoupledLink>(input, endpoint, keys);
}

}  // namespace undertow::sph
