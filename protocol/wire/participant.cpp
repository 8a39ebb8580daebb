#include "wire/participant.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "wire/channel.hpp"
#include "wire/codec.hpp"
#include "wire/endpoint.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"
#include "wire/patience.hpp"
#include "wire/recording.hpp"
#include "wire/segment.hpp"
#include "wire/session.hpp"

namespace undertow::wire {

namespace {

constexpr double finish_linger = 2.0;  // [s] for BYE to leave

}  // namespace

struct Participant::Impl {
    explicit Impl(const ParticipantOptions& given)
        : options(given), session(given.role) {
        if (given.endpoint.starts_with(replay_prefix))
            replay.emplace(given.endpoint.substr(std::strlen(replay_prefix)));
        else
            open_channel();
    }

    void open_channel() {
        CurveKeys keys;
        if (!options.curve.empty()) keys = keys_of_participant(options.curve, options.name);
        channel.emplace(Channel::End::solver, options.endpoint, default_max_message,
                        options.curve.empty() ? nullptr : &keys);
    }

    ParticipantOptions options;
    Session session;
    std::optional<Channel> channel;         // one of the two
    std::optional<RecordingReader> replay;  // stands in for the coupler
    std::string first_difference;           // from what was recorded
    Welcome welcome;
    Packet packet;
    Message incoming;    // reused, so that a FORCE costs no allocation
    Message outgoing;    // likewise for a STATE
    Frames frames;       // of a message that goes by the segment
    std::unique_ptr<Segment> segment;  // the data plane, if both sides have it
    bool by_segment = false;           // the last message went by it, and the answer may come by it
    double waited = 0;   // [s]
    Clock::time_point last_word = Clock::now();  // to the coupler
    bool preparing = true;  // no step yet: a wish to stop ends the run at once
    bool ended = false;  // one of the two sides has reported an error, or BYE has been said

    // ---------------------------------------------------------------- sending

    void post(Message&& message) {
        set_session(message, session.id());
        try {
            session.follow(Side::solver, message);
        } catch (const PeerError& error) {
            throw std::logic_error(std::string("this program breaks the protocol: ") +
                                   error.what());
        }
        const MessageType type = type_of(message);
        if (type == MessageType::state || type == MessageType::probe) preparing = false;
        if (replay) return compare(message);
        last_word = Clock::now();
        if (post_by_segment(message)) return;
        switch (channel->send(std::move(message), {}, patience())) {
            case Sent::yes:
                if (segment) segment->ring();
                return;
            case Sent::timed_out:
                throw PeerError("E_TIMEOUT", std::string("the coupler took no ") + name_of(type) +
                                                 " within " + number_text(patience(), 3) + " s");
            case Sent::connection_lost:
                lost();
        }
    }

    void compare(const Message& message) {
        if (std::holds_alternative<Progress>(message)) return;
        if (!replay->compare(message) && first_difference.empty())
            first_difference = label(message);
    }

    bool post_by_segment(const Message& message) {
        if (std::holds_alternative<Progress>(message)) return false;
        by_segment = false;
        if (!segment || !std::holds_alternative<State>(message)) return false;
        encode(message, frames);
        segment->forget_socket();   // all that the coupler has said by it has been read
        by_segment = segment->write(frames);
        return by_segment;
    }

    double patience() const { return session.id() == 0 ? options.join_timeout : welcome.deadline; }

    // ---------------------------------------------------------------- receiving

    /// The next message that is neither PROGRESS nor ERROR, in `incoming`. `what` names, for the
    /// time-out, what is missing.
    void take(double seconds, const std::string& what) {
        double silence = 0;
        for (;;) {
            const Segment::Ring ring{segment.get(), by_segment ? segment->bell() : 0};
            if (take_next()) {
                if (std::holds_alternative<Progress>(incoming)) {
                    silence = 0;  // the coupler vouches for a peer that computes long
                    continue;
                }
                return;
            }
            if (channel->any_broken()) lost();
            if (silence >= seconds) {
                if (!channel->ever_connected()) nobody_there();
                fail("E_TIMEOUT", "the coupler at " + options.endpoint + " sent no " + what +
                                      " within " + number_text(seconds, 3) + " s");
            }
            if (preparing && options.stop && options.stop())
                fail("E_STOP", "the user stopped " + options.name + " before its first step");
            silence += wait(seconds - silence, ring);
        }
    }

    /// Takes a message into `incoming` if one is there.
    bool take_next() {
        if (replay) {
            if (replay->at_end() || replay->next_speaker() != Said::by_coupler)
                throw PeerError("E_STATE", "the recording at " + options.endpoint +
                                               (replay->at_end() ? " has ended in step "
                                                                 : " has no answer in step ") +
                                               std::to_string(session.step()));
            accept([&] { replay->take(incoming); });
            return true;
        }
        if (by_segment && segment->has_message()) {
            accept([&] { segment->read(incoming); });
            return true;
        }
        if (!channel->receive(packet)) return false;
        accept([&] { decode(packet, incoming); });
        // The rest of the turn comes by the socket too: its bells may have been heard already, and
        // whoever waits for another one loses 50 ms.
        if (!std::holds_alternative<Progress>(incoming)) by_segment = false;
        return true;
    }

    double wait(double seconds, const Segment::Ring& ring) {
        if (!by_segment) return channel->wait(seconds);
        if (segment->heard_of_socket()) return channel->wait(std::min(seconds, on_its_way));
        return channel->wait_at(std::span(&ring, 1), seconds);
    }

    void accept(const auto& decode_it) {
        try {
            decode_it();
            if (const auto* error = std::get_if<Error>(&incoming)) raise(*error);
            session.follow(Side::coupler, incoming);
        } catch (const PeerError& error) {
            if (ended) throw;
            fail(error.code, std::string("the coupler's message is wrong: ") + error.what());
        }
    }

    [[noreturn]] void raise(const Error& error) {
        ended = true;
        if (error.who == options.name) {
            throw PeerError(error.code, "the coupler refuses: " + error.text);
        }
        const std::string who = error.who.empty() ? "coupler" : error.who;
        const bool named = error.text.starts_with(who + " ") || error.text.starts_with(who + ": ");
        throw PeerError(error.code, named ? error.text : who + ": " + error.text);
    }

    /// The connection is gone. The coupler may have said why before it left.
    [[noreturn]] void lost() {
        if (channel->handshakes_failed() > 0 && session.id() == 0) refused();
        while (channel->receive(packet)) {
            try {
                decode(packet, incoming);
            } catch (const PeerError&) {
                continue;
            }
            if (const auto* error = std::get_if<Error>(&incoming)) raise(*error);
        }
        ended = true;
        throw PeerError("E_PEER_LOST", "the coupler at " + options.endpoint + " vanished in step " +
                                           std::to_string(session.step()) + "; see coupler.log");
    }

    [[noreturn]] void refused() {
        ended = true;
        if (options.curve.empty())
            throw PeerError("E_KEY", "the coupler at " + options.endpoint +
                                         " closes the connection at the greeting; if it has keys "
                                         "(--keys), this program needs them too");
        throw PeerError("E_KEY", "the coupler at " + options.endpoint + " does not take the key " +
                                     options.curve + "/" + options.name +
                                     ".key, or is not the one of coupler.pub there; copy the keys of "
                                     "one run of `undertow keys` to all hosts");
    }

    [[noreturn]] void nobody_there() const {
        throw PeerError("E_TIMEOUT", "no coupler appeared at " + options.endpoint + " within " +
                                         number_text(options.join_timeout, 3) +
                                         " s; start it with this endpoint");
    }

    [[noreturn]] void fail(const std::string& code, const std::string& text) {
        report(code, text);
        throw PeerError(code, text);
    }

    void report(const std::string& code, const std::string& text) noexcept {
        if (std::exchange(ended, true)) return;
        if (!channel || !channel->ever_connected()) return;  // nobody to tell
        try {
            channel->linger(error_linger);
            channel->send(
                Error{session.id(), session.step(), code, text.substr(0, 4000), options.name}, {},
                error_linger);
            if (segment) segment->ring();
        } catch (...) {
            // The run fails already, for the reason that could not be sent.
        }
    }

    // ---------------------------------------------------------------- the hand-shake

    void greet(const Hello& hello) {
        switch (channel->send(hello, {}, options.join_timeout)) {
            case Sent::yes:
                return;
            case Sent::connection_lost:
                lost();
            case Sent::timed_out:
                nobody_there();
        }
    }

    void join() {
        const auto start = Clock::now();
        Hello hello;
        hello.name = options.name;
        hello.role = options.role;
        hello.capabilities = options.capabilities;
        if (options.shared_memory && options.endpoint.starts_with("ipc://"))
            hello.capabilities.push_back(shared_memory_capability);
        hello.software = options.software;
        hello.case_keys = options.case_keys;
        session.follow(Side::solver, hello);
        if (replay)
            compare(hello);
        else
            greet(hello);
        take(std::max(options.join_timeout - seconds_since(start), 0.1), "WELCOME");
        welcome = std::get<Welcome>(incoming);
        if (channel) channel->limit_frames(welcome.max_message);
        if (welcome.version[0] != version_major) {
            fail("E_VERSION", "the coupler speaks protocol " + std::to_string(welcome.version[0]) +
                                  "." + std::to_string(welcome.version[1]) + ", this program " +
                                  std::to_string(version_major) + "." +
                                  std::to_string(version_minor));
        }
        if (channel && std::ranges::find(welcome.capabilities, shared_memory_capability) !=
            welcome.capabilities.end())
            segment = Segment::open(welcome.session, options.name);
    }
};

Participant::Participant(const ParticipantOptions& options) {
    if (!options.endpoint.starts_with(replay_prefix))
        check_endpoint(options.endpoint, options.curve.empty() ? Keys::none : Keys::curve);
    if (options.role != "particles" && options.role != "surface") {
        throw std::logic_error("role '" + options.role + "' is neither particles nor surface");
    }
    impl_ = std::make_unique<Impl>(options);
    impl_->join();
}

Participant::~Participant() = default;
Participant::Participant(Participant&&) noexcept = default;

const Welcome& Participant::welcome() const {
    return impl_->welcome;
}

void Participant::announce(Mesh mesh) {
    const std::string name = mesh.mesh;
    const std::string sum = checksum(mesh);
    impl_->post(std::move(mesh));
    impl_->take(impl_->welcome.deadline, "MESH_ACK");
    const MeshAck& ack = std::get<MeshAck>(impl_->incoming);
    if (ack.sum != sum) {
        impl_->fail("E_MESH",
                    "mesh " + name + " arrived with checksum " + ack.sum + " instead of " + sum);
    }
}

Surface Participant::wait_surface() {
    // The coupler sends it when every mesh is in, so it may wait for a slow peer's preparations.
    impl_->take(std::max(impl_->options.join_timeout, impl_->welcome.deadline), "SURFACE");
    return std::get<Surface>(std::move(impl_->incoming));
}

void Participant::send(State&& state) {
    State& own = std::holds_alternative<State>(impl_->outgoing)
                     ? std::get<State>(impl_->outgoing)
                     : impl_->outgoing.emplace<State>();
    std::swap(own, state);
    impl_->post(std::move(impl_->outgoing));
    std::swap(own, state);
}

void Participant::send(Probe probe) {
    impl_->post(std::move(probe));
}

void Participant::send(CheckpointAck ack) {
    impl_->post(std::move(ack));
}

void Participant::send(const Progress& progress) {
    impl_->post(progress);
}

void Participant::still_busy(const std::string& doing) {
    if (impl_->replay || seconds_since(impl_->last_word) < tell_every * impl_->welcome.deadline)
        return;
    impl_->post(Progress{0, impl_->session.step(), 0, doing});
}

void Participant::wait_reply(StepReply& reply) {
    const auto start = Clock::now();
    reply.surface.reset();
    reply.active.reset();
    reply.checkpoint.reset();
    reply.finish.reset();
    for (;;) {
        impl_->take(impl_->welcome.deadline, "FORCE");
        Message& message = impl_->incoming;
        if (auto* surface = std::get_if<Surface>(&message)) {
            reply.surface = std::move(*surface);
            continue;
        }
        if (auto* active = std::get_if<Active>(&message)) {
            reply.active = std::move(*active);
            continue;
        }
        if (auto* force = std::get_if<Force>(&message)) {
            if (reply.force)
                std::swap(*reply.force, *force);  // both keep their buffers
            else
                reply.force = std::move(*force);
            break;
        }
        reply.force.reset();
        if (auto* checkpoint = std::get_if<Checkpoint>(&message))
            reply.checkpoint = *checkpoint;
        else
            reply.finish = std::get<Finish>(message);
        break;
    }
    impl_->waited += seconds_since(start);
}

StepReply Participant::wait_reply() {
    StepReply reply;
    wait_reply(reply);
    return reply;
}

bool Participant::shares_memory() const {
    return impl_->by_segment;
}

std::string Participant::replay_verdict() const {
    if (!impl_->replay) return {};
    if (impl_->first_difference.empty()) return "replay: every message is the recorded one, bit by bit";
    return "replay: " + impl_->first_difference + " was the first message that differs from the recording";
}

double Participant::waited() const {
    return impl_->waited;
}

void Participant::say_goodbye(std::int64_t n) {
    if (impl_->channel) impl_->channel->linger(finish_linger);
    impl_->post(Bye{0, n});
    impl_->ended = true;
}

void Participant::report_error(const std::string& code, const std::string& text) noexcept {
    impl_->report(code, text);
}

}  // namespace undertow::wire
