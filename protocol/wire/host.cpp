#include "wire/host.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <random>
#include <stdexcept>
#include <utility>

#include "wire/channel.hpp"
#include "wire/codec.hpp"
#include "wire/data_check.hpp"
#include "wire/endpoint.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"
#include "wire/patience.hpp"
#include "wire/recording.hpp"
#include "wire/seat.hpp"
#include "wire/segment.hpp"
#include "wire/session.hpp"

namespace undertow::wire {

namespace {

constexpr double stranger_patience = 0.2;  // [s] for a refusal to who is not part of the run

std::uint64_t draw_session() {
    std::random_device device;
    std::uint64_t id = 0;
    while (id == 0) id = std::uint64_t{device()} << 32 | device();
    return id;
}

}  // namespace

struct Host::Impl {
    explicit Impl(const HostOptions& given)
        : options(given),
          keys(given.curve.empty() ? CurveKeys{} : keys_of_coupler(given.curve)),
          lock(given.endpoint, given.curve.empty() ? Keys::none : Keys::curve),
          channel(Channel::End::coupler, given.endpoint,
                  given.welcome.max_message ? given.welcome.max_message : default_max_message,
                  given.curve.empty() ? nullptr : &keys) {
        Welcome& welcome = options.welcome;
        if (welcome.session == 0) welcome.session = draw_session();
        if (welcome.max_message == 0) welcome.max_message = default_max_message;
        welcome.version = {version_major, version_minor};
        welcome.deadline = options.deadline;
        if (options.shared_memory && given.endpoint.starts_with("ipc://")) {
            welcome.capabilities.push_back(shared_memory_capability);
            Segment::sweep();
        }
        for (const std::string& role : options.expected_roles) seats.emplace_back(role);
    }

    HostOptions options;
    CurveKeys keys;
    EndpointLock lock;  // before the channel: taken first, released last
    Channel channel;
    std::vector<Seat> seats;
    std::deque<Received> held;  // came while something else was awaited
    Packet packet;
    Message stray;  // of someone who is not part of the run
    std::size_t n_seated = 0;
    std::string refused_for_case;  // who came last with another case
    bool failed = false;
    bool preparing = true;       // no step yet: a wish to stop ends the run at once
    bool shared_memory = false;  // the data plane is in use
    Frames frames;               // of a message that goes by a segment
    std::vector<Segment::Ring> rings;
    std::chrono::steady_clock::time_point last_told{};  // that the coupler is busy
    std::uint64_t segment_bytes_sent = 0, segment_bytes_received = 0;

    // ---------------------------------------------------------------- errors

    /// Tells all who do not know yet, then throws.
    [[noreturn]] void fail(const std::string& code, const std::string& text,
                           const std::string& who) {
        tell_all(code, text, who);
        throw PeerError(code, text);
    }

    void tell_all(const std::string& code, const std::string& text,
                  const std::string& who) noexcept {
        failed = true;
        try {
            channel.linger(error_linger);
            for (Seat& seat : seats) {
                if (!seat.taken() || seat.lost || std::exchange(seat.told, true)) continue;
                if (seat.session.phase() == Phase::closed) continue;
                channel.send(
                    Error{seat.session.id(), seat.session.step(), code, text.substr(0, 4000), who},
                    seat.routing_id, error_linger);
                if (seat.segment) seat.segment->ring();
            }
        } catch (...) {
            // The run fails already, for the reason that could not be sent.
        }
    }

    // ---------------------------------------------------------------- sending

    void post(Seat& seat, Message&& message) {
        set_session(message, options.welcome.session);
        if (std::holds_alternative<Checkpoint>(message) && !seat.can("checkpoint")) {
            throw std::logic_error(seat.name +
                                   " cannot write checkpoints: it lacks the capability");
        }
        try {
            seat.session.follow(Side::coupler, message);
        } catch (const PeerError& error) {
            throw std::logic_error("the coupler breaks the protocol toward " + seat.name + ": " +
                                   error.what());
        }
        seat.silence = 0;
        if (seat.recording) seat.recording->add(Said::by_coupler, message);
        const MessageType type = type_of(message);
        if (type == MessageType::force && post_by_segment(seat, message)) return;
        // What goes by the socket may be overtaken by what goes by the segment: not in one turn.
        if (type != MessageType::progress) seat.by_segment = false;
        switch (channel.send(std::move(message), seat.routing_id, options.deadline)) {
            case Sent::yes:
                if (seat.segment) seat.segment->ring();
                return;
            case Sent::connection_lost:
                seat.lost = true;  // next() reads its last words, perhaps an ERROR, and tells
                return;
            case Sent::timed_out:
                fail("E_TIMEOUT",
                     seat.name + " took no " + name_of(type) + " of step " +
                         std::to_string(seat.session.step()) + " within " +
                         number_text(options.deadline, 3) + " s",
                     seat.name);
        }
    }

    /// FORCE answers a STATE that came by the segment on the same way. Either way there must be
    /// room for the next STATE, whose rows are known now.
    bool post_by_segment(Seat& seat, const Message& force) {
        if (!shared_memory || !seat.segment) return false;
        const std::size_t rows = seat.session.rows();
        const bool room = seat.segment->reserve(state_bytes(rows), force_bytes(rows));
        seat.segment->forget_socket();   // its turn is over, what it said by it has been read
        if (!room || !seat.by_segment) return false;
        encode(force, frames);
        if (!seat.segment->write(frames)) return false;
        segment_bytes_sent += frames.header.size() + frames.array_bytes();
        return true;
    }

    // ---------------------------------------------------------------- receiving

    /// Reads what is there until a message of the run has come into `received`. False: nothing
    /// more.
    bool read(Received& received) {
        for (Seat& seat : seats) {
            if (!shared_memory || !seat.segment || !seat.segment->has_message()) continue;
            seat.by_segment = true;
            const auto take = [&](Message& message) {
                segment_bytes_received += seat.segment->read(message);
            };
            if (hand_on(seat, received, take)) return true;
        }
        while (channel.receive(packet)) {
            Seat* seat = find_seat();
            if (!seat) {
                answer_stranger();
                continue;
            }
            const auto take = [&](Message& message) { decode(packet, message); };
            if (hand_on(*seat, received, take)) {
                seat->by_segment = false;
                return true;
            }
        }
        return false;
    }

    bool hand_on(Seat& seat, Received& received, const auto& take) {
        seat.silence = 0;
        if (!accept(seat, received.message, take)) return false;
        received.participant = static_cast<std::size_t>(&seat - seats.data());
        return true;
    }

    Seat* find_seat() {
        for (Seat& seat : seats) {
            if (seat.taken() && seat.routing_id == packet.sender) return &seat;
        }
        return nullptr;
    }

    /// False when there is nothing to hand on (PROGRESS).
    bool accept(Seat& seat, Message& message, const auto& take) {
        try {
            take(message);
            if (const auto* error = std::get_if<Error>(&message)) {
                seat.told = true;
                fail(error->code, seat.name + ": " + error->text, seat.name);
            }
            seat.session.follow(Side::solver, message);
            if (const auto* probe = std::get_if<Probe>(&message))
                check_probe(*probe, seat.particles);
            if (seat.recording) seat.recording->add(Said::by_participant, message);
        } catch (const PeerError& error) {
            if (failed) throw;
            fail(error.code, seat.name + " sent a wrong message: " + error.what(), seat.name);
        }
        return !std::holds_alternative<Progress>(message);
    }

    /// Connections that broke: whose were they?
    void look_for_lost() {
        for (const int connection : channel.take_broken()) {
            for (Seat& seat : seats) {
                if (seat.taken() && seat.connection == connection) seat.lost = true;
            }
        }
    }

    /// Next message, at most `seconds`; false when there is none, or when somebody has just joined.
    /// Throws when a participant that has to speak is silent past `deadline`, and when one is lost
    /// that has not said goodbye.
    bool next(double seconds, double deadline, Received& received) {
        const std::size_t seated_before = n_seated;
        double waited = 0;
        for (;;) {
            note_bells();  // before looking, so that nothing is missed between look and wait
            if (read(received)) return true;
            look_for_lost();
            if (read(received)) return true;  // last words, sent before the connection broke
            if (n_seated != seated_before) return false;
            double longest = seconds - waited;
            for (const Seat& seat : seats) {
                if (seat.lost && seat.session.phase() != Phase::closed) {
                    fail("E_PEER_LOST",
                         seat.name + " vanished in step " + std::to_string(seat.session.step()) +
                             "; see its log",
                         seat.name);
                }
                if (!seat.is_due()) continue;
                if (seat.silence >= deadline) {
                    fail("E_TIMEOUT",
                         seat.name + " has been silent for " + number_text(deadline, 3) +
                             " s in step " + std::to_string(seat.session.step()) + " (" +
                             name_of(seat.session.phase()) + ")",
                         seat.name);
                }
                longest = std::min(longest, deadline - seat.silence);
            }
            if (longest <= 0) return false;
            if (preparing && options.stop && options.stop())
                fail("E_STOP", "the user stopped the run before its first step", "");
            if (preparing && !all_seated() && options.loss && options.loss())
                fail("E_PEER_LOST",
                     "a program of this run ended before it joined: " + missing() + "; see its log", "");
            const double listened = wait(longest);
            waited += listened;
            for (Seat& seat : seats) {
                seat.silence += listened;
                if (seat.waits_for_us() && seat.silence > options.deadline / 3) reassure(seat);
            }
        }
    }

    /// The bells of those who have to speak.
    void note_bells() {
        rings.clear();
        if (!shared_memory) return;
        for (Seat& seat : seats)
            if (seat.is_due()) rings.push_back({seat.segment.get(), seat.segment->bell()});
    }

    /// Like Channel::wait(), for what may come either way.
    double wait(double seconds) {
        if (rings.empty()) return channel.wait(seconds);
        for (Seat& seat : seats)
            if (seat.segment->heard_of_socket()) return channel.wait(std::min(seconds, on_its_way));
        return channel.wait_at(rings, seconds);
    }

    /// To a participant that waits for a slower one: we are alive, and watch the other's deadline.
    void reassure(Seat& seat) {
        post(seat, Progress{0, seat.session.step(), 0, "waiting for " + slow_ones()});
    }

    std::string slow_ones() const {
        std::string names;
        for (const Seat& seat : seats) {
            if (seat.taken() && !seat.is_due()) continue;
            names += (names.empty() ? "" : ", ") + (seat.taken() ? seat.name : seat.role);
        }
        return names;
    }

    // ---------------------------------------------------------------- joining

    void refuse(const std::string& code, const std::string& text) {
        channel.send(Error{0, 0, code, text, ""}, packet.sender, stranger_patience);
    }

    /// A message by someone without a seat: a HELLO takes one or is refused with the reason.
    /// Whatever it is, it does not disturb the run.
    void answer_stranger() {
        try {
            decode(packet, stray);
        } catch (const PeerError& error) {
            return refuse(error.code, error.what());
        }
        const auto* hello = std::get_if<Hello>(&stray);
        if (!hello) {
            if (std::holds_alternative<Error>(stray)) return;
            return refuse("E_STATE", label(stray) + " came without a HELLO");
        }
        look_for_lost();  // so that is_open() below knows all events before this HELLO
        Refusal why;
        Seat* seat = find_seat_for(*hello, seats, why);
        const std::string holder = Channel::key_holder(packet);
        if (seat && !options.curve.empty() && holder != hello->name) {
            seat = nullptr;
            why = {"E_KEY", "'" + hello->name + "' came with the key of '" + holder + "'"};
        }
        if (seat && options.objection && !hello->case_keys.empty()) {
            if (std::string text = options.objection(*hello); !text.empty()) {
                seat = nullptr;
                why = {"E_INPUT", std::move(text)};
                refused_for_case = hello->name;
            }
        }
        if (!seat)
            refuse(why.code, why.text);
        else if (channel.is_open(packet.connection))
            take_seat(*seat, *hello);
    }

    void take_seat(Seat& seat, const Hello& hello) {
        seat.name = hello.name;
        seat.software = hello.software;
        seat.routing_id = packet.sender;
        seat.connection = packet.connection;
        Welcome welcome = options.welcome;
        std::erase_if(welcome.capabilities, [&](const std::string& ours) {
            return std::ranges::find(hello.capabilities, ours) == hello.capabilities.end();
        });
        if (std::erase(welcome.capabilities, shared_memory_capability) > 0) {
            seat.segment = Segment::create(options.welcome.session, hello.name);
            if (seat.segment) welcome.capabilities.push_back(shared_memory_capability);
        }
        seat.capabilities = welcome.capabilities;
        welcome.version[1] = std::min(version_minor, hello.version[1]);
        ++n_seated;
        if (!options.record_in.empty()) {
            seat.recording = std::make_unique<RecordingWriter>(recording_of(options.record_in, seat.name));
            seat.recording->add(Said::by_participant, hello);
        }
        seat.session.follow(Side::solver, hello);
        post(seat, std::move(welcome));
    }

    bool all_seated() const {
        return std::all_of(seats.begin(), seats.end(), [](const Seat& s) { return s.taken(); });
    }

    std::string missing() const {
        std::string text, joined;
        for (const Seat& seat : seats) {
            std::string& list = seat.taken() ? joined : text;
            list += (list.empty() ? "" : ", ") + (seat.taken() ? seat.name : seat.role);
        }
        const int refused = channel.handshakes_failed();
        return "nobody joined as " + text + (joined.empty() ? "" : " (joined: " + joined + ")") +
               (refused_for_case.empty()
                    ? ""
                    : ", " + refused_for_case + " was refused for another case,") +
               (refused == 0
                    ? ""
                    : ", " + std::to_string(refused) + " connections were refused for their keys,");
    }

    // ---------------------------------------------------------------- meshes

    void take_mesh(Seat& seat, Mesh&& mesh) {
        try {
            check_mesh(mesh, seat.role);
        } catch (const PeerError& error) {
            fail(error.code, seat.name + ": " + error.what(), seat.name);
        }
        if (seat.role == "particles") seat.particles = mesh;
        post(seat, MeshAck{0, mesh.mesh, mesh.revision, checksum(mesh)});
        seat.meshes.push_back(std::move(mesh));
    }

    /// Particles announce one mesh; the meshes of a surface are complete with its first STATE.
    bool meshes_complete() const {
        return std::all_of(seats.begin(), seats.end(), [](const Seat& seat) {
            return seat.session.phase() == Phase::surface || seat.session.phase() == Phase::reply;
        });
    }

    /// All or nobody: the coupler can wait for bells or for its socket, but not for both.
    void decide_on_shared_memory() {
        shared_memory = std::all_of(seats.begin(), seats.end(), [](const Seat& seat) {
            return seat.segment && seat.segment->joined();
        });
        if (!shared_memory)
            for (Seat& seat : seats) seat.segment.reset();
    }

    /// Takes one message while the run is being prepared: MESH is answered, everything else is held
    /// back for the first steps. At most `seconds`.
    void prepare(double seconds) {
        Received received;
        const double patience = std::max(options.join_timeout, options.deadline);
        if (!next(seconds, patience, received)) return;
        Seat& seat = seats[received.participant];
        if (auto* mesh = std::get_if<Mesh>(&received.message))
            take_mesh(seat, std::move(*mesh));
        else
            held.push_back(std::move(received));
    }
};

// -------------------------------------------------------------------- the public face

Host::Host(const HostOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Host::~Host() = default;

const std::string& Host::endpoint() const {
    return impl_->channel.endpoint();
}

void Host::wait_join() {
    const auto start = std::chrono::steady_clock::now();
    while (!impl_->all_seated()) {
        const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
        const double left = impl_->options.join_timeout - waited.count();
        if (left <= 0) {
            impl_->fail("E_TIMEOUT",
                        "within " + number_text(impl_->options.join_timeout, 3) + " s " +
                            impl_->missing() + " at " + endpoint(),
                        "");
        }
        impl_->prepare(left);
    }
}

std::vector<std::vector<Mesh>> Host::wait_meshes() {
    while (!impl_->meshes_complete()) impl_->prepare(impl_->options.deadline);
    impl_->decide_on_shared_memory();
    impl_->preparing = false;
    std::vector<std::vector<Mesh>> meshes;
    for (Seat& seat : impl_->seats) meshes.push_back(std::move(seat.meshes));
    return meshes;
}

Received Host::next() {
    const bool somebody_is_due = std::any_of(impl_->seats.begin(), impl_->seats.end(),
                                             [](const Seat& seat) { return seat.is_due(); });
    if (impl_->held.empty() && !somebody_is_due) {
        throw std::logic_error("next() would wait forever: every participant awaits an answer");
    }
    Received received;
    while (!next_within(impl_->options.deadline, received)) {
    }
    return received;
}

bool Host::next_within(double seconds, Received& received) {
    if (!impl_->held.empty()) {
        received = std::move(impl_->held.front());
        impl_->held.pop_front();
        return true;
    }
    return impl_->next(seconds, impl_->options.deadline, received);
}

void Host::send(std::size_t participant, Message&& message) {
    impl_->post(impl_->seats.at(participant), std::move(message));
}

void Host::broadcast_error(const std::string& code, const std::string& text,
                           const std::string& who) noexcept {
    impl_->tell_all(code, text, who);
}

void Host::still_busy(const std::string& doing) {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - impl_->last_told;
    if (passed.count() < tell_every * impl_->options.deadline) return;
    impl_->last_told = now;
    for (Seat& seat : impl_->seats)
        if (seat.waits_for_us()) impl_->post(seat, Progress{0, seat.session.step(), 0, doing});
}

void Host::finish(std::int64_t n, const std::string& reason) {
    const auto dismiss = [&](Seat& seat) {
        if (seat.session.phase() == Phase::reply) impl_->post(seat, Finish{0, n, reason});
    };
    for (Seat& seat : impl_->seats) dismiss(seat);
    const auto all_gone = [&] {
        return std::all_of(impl_->seats.begin(), impl_->seats.end(),
                           [](const Seat& seat) { return seat.session.phase() == Phase::closed; });
    };
    Received received;
    while (!all_gone()) {  // one that was still on its way to step n is dismissed when it arrives
        if (next_within(impl_->options.deadline, received)) {
            dismiss(impl_->seats[received.participant]);
        }
    }
}

const std::string& Host::name(std::size_t participant) const {
    return impl_->seats.at(participant).name;
}

bool Host::can(std::size_t participant, const std::string& capability) const {
    return impl_->seats.at(participant).can(capability);
}

const std::string& Host::software(std::size_t participant) const {
    return impl_->seats.at(participant).software;
}

bool Host::shares_memory() const {
    return impl_->shared_memory;
}

std::uint64_t Host::bytes_sent() const {
    return impl_->channel.bytes_sent() + impl_->segment_bytes_sent;
}

std::uint64_t Host::bytes_received() const {
    return impl_->channel.bytes_received() + impl_->segment_bytes_received;
}

}  // namespace undertow::wire
