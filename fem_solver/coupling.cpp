#include "fem_solver/coupling.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "case/binding_keys.hpp"
#include "case/time_step.hpp"
#include "checkpoint/own_checkpoints.hpp"
#include "fem_solver/setup/implicit_check.hpp"
#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "wire/errors.hpp"
#include "wire/participant.hpp"

namespace undertow::fem {
namespace {

class Alone final : public Link {
 public:
    Alone(const Case& c, const std::string& folder)
        : agreement_(c.time, c.output.fields_every),
          checkpoints_(c, folder, "fem"),
          end_(c.time.end),
          max_step_(c.time.max_step) {}

    std::int64_t announce(const Structure& structure, std::int64_t n) override {
        if (only_implicit_parts(structure.model()) && structure.implicit() &&
            !std::isfinite(max_step_))
            throw InputError(
                "fem.part: all that deforms is implicit, and this program runs alone, so that "
                "nothing limits the step; set time.max_step to what resolves the motion.");
        return n;
    }
    void send_state(std::int64_t n, double t, const Structure&, const StableStep& offer,
                    bool stop) override {
        n_ = n, t_ = t;
        order_.finish = stop || t >= end_;
        order_.interrupted = stop && t < end_;
        if (checkpoints_.due(n, t, order_.finish, order_.interrupted))
            order_.checkpoint = checkpoint_id(n);
        offer_[0].dt = offer.dt;
        offer_[0].limiter.assign("fem: ").append(offer.limiter);
    }
    /// The step is agreed after its checkpoint, which must not know it.
    const StepOrder& wait_order() override {
        if (order_.finish || !order_.checkpoint.empty()) return order_;
        const AgreedStep& step = agreement_.agree(t_, offer_);
        order_.dt = step.dt;
        order_.t1 = step.t1;
        order_.limiter = step.limiter;
        order_.output = step.output;
        return order_;
    }
    void confirm(const WrittenFile& file) override {
        checkpoints_.complete(n_, t_, file);
        order_.checkpoint.clear();
    }
    void archive(Archive& a) override { a.object("agreement", agreement_); }
    void say_goodbye(std::int64_t) override {}
    void report_error(const std::string&, const std::string&) noexcept override {}
    double waited() const override { return 0; }

 private:
    StepAgreement agreement_;
    OwnCheckpoints checkpoints_;
    std::int64_t n_ = 0;
    double t_ = 0;  // [s]
    double end_;
    double max_step_;  // [s] of the case
    std::vector<StepOffer> offer_{1};
    StepOrder order_;
};

// What an immobile node weighs for the coupler: no particle moves it, and sums stay finite.
constexpr double mass_of_immobile = 1e12;  // [kg]

// Of what the structure leaves of the stability budget, contact may take this much. All of it is
// stable as long as contacts stay closed; those that open and close then pump energy
// (docs/theory_contact.md, section 3).
constexpr double contact_part = 2.0 / 3;

class Coupled final : public Link {
 public:
    Coupled(const Case& c, const std::string& endpoint, const std::string& keys)
        : participant_({.endpoint = endpoint,
                        .name = "fem",
                        .role = "surface",
                        .capabilities = {"checkpoint"},
                        .software = "undertow fem_solver " UNDERTOW_VERSION,
                        .join_timeout = c.coupling.join_timeout,
                        .case_keys = binding_keys(c),
                        .curve = keys,
                        .stop = stop_requested}) {
        if (c.fem.surface.empty())
            throw InputError(c.file + ": a coupled run needs at least one [[fem.surface]].");
        const double share = participant_.welcome().contact_share;
        const double room = contact_part * 4 * (1 - c.fem.cfl * c.fem.cfl);
        if (share > room) {
            char text[320];
            std::snprintf(text, sizeof text,
                          "%s: fem.cfl = %g leaves contact two thirds of 4 (1 - cfl^2), %.3g, "
                          "but it takes beta + 2 eta = %.3g; set fem.cfl to %.2f or less.",
                          c.file.c_str(), c.fem.cfl, room, share,
                          std::floor(100 * std::sqrt(std::max(0.0, 1 - share / (4 * contact_part)))) / 100);
            throw InputError(text);
        }
    }

    std::int64_t announce(const Structure& structure, std::int64_t) override {
        const CoupledSurface& surface = structure.model().surface;
        wire::Mesh mesh;
        mesh.mesh = "structure";
        mesh.kind = "surface";
        mesh.groups = surface.names;
        for (std::size_t i = 0; i < surface.node.size(); ++i) {
            const Row x = structure.surface_position(i);
            mesh.x.insert(mesh.x.end(), {x[0], x[1], x[2]});
            const double mass = structure.surface_mass(i);
            mesh.mass.push_back(mass > 0 ? mass : mass_of_immobile);
        }
        for (const Quad& q : surface.quad) mesh.quad.insert(mesh.quad.end(), q.begin(), q.end());
        mesh.group = surface.group;
        participant_.announce(std::move(mesh));
        return participant_.welcome().first_step;
    }

    void send_state(std::int64_t n, double t, const Structure& structure, const StableStep& offer,
                    bool stop) override {
        const std::vector<std::int32_t>& node = structure.model().surface.node;
        wire::State& state = state_;  // keeps its buffers from step to step
        state.n = n;
        state.t = t;
        state.dt_limit = offer.dt;
        state.limiter = offer.limiter;
        state.flags = stop ? std::uint32_t(wire::state_stop) : 0;
        state.work = work_;
        state.wait = participant_.waited();
        state.x.resize(3 * node.size());
        state.v.resize(3 * node.size());
        for (std::size_t i = 0; i < node.size(); ++i) {
            const Row x = structure.surface_position(i), v = structure.surface_velocity(i);
            for (int d = 0; d < 3; ++d) {
                state.x[3 * i + d] = x[d];
                state.v[3 * i + d] = v[d];
            }
        }
        participant_.send(std::move(state));
        work_of_step_ = double(structure.elements().deformable());
    }

    const StepOrder& wait_order() override {
        participant_.wait_reply(reply_);
        order_.finish = reply_.finish.has_value();
        order_.checkpoint.clear();
        if (reply_.checkpoint) order_.checkpoint = reply_.checkpoint->id;
        if (reply_.finish) {
            order_.interrupted = reply_.finish->reason == "interrupted";
        } else if (reply_.force) {
            work_ += work_of_step_;
            order_.dt = reply_.force->dt;
            order_.t1 = reply_.force->t1;
            order_.limiter = reply_.force->limiter;
            order_.output = (reply_.force->flags & wire::force_output) != 0;
            order_.f = reply_.force->f;
        }
        return order_;
    }

    void confirm(const WrittenFile& file) override {
        wire::CheckpointAck ack;
        ack.n = reply_.checkpoint->n;
        ack.file = file.name;
        ack.sha256 = file.sha;
        participant_.send(std::move(ack));
    }
    void still_busy(const std::string& doing) override { participant_.still_busy(doing); }
    void archive(Archive& a) override { a("work", work_); }
    void say_goodbye(std::int64_t n) override {
        participant_.say_goodbye(n);
        if (const std::string verdict = participant_.replay_verdict(); !verdict.empty())
            log_info(verdict);
    }
    void report_error(const std::string& code, const std::string& text) noexcept override {
        participant_.report_error(code, text);
    }
    double waited() const override { return participant_.waited(); }

 private:
    wire::Participant participant_;
    wire::State state_;
    wire::StepReply reply_;
    StepOrder order_;
    double work_ = 0, work_of_step_ = 0;  // element-steps
};

}  // namespace

std::unique_ptr<Link> run_alone(const Case& c, const std::string& folder) {
    return std::make_unique<Alone>(c, folder);
}

std::unique_ptr<Link> join_coupler(const Case& c, const std::string& endpoint,
                                   const std::string& keys) {
    return std::make_unique<Coupled>(c, endpoint, keys);
}

}  // namespace undertow::fem
