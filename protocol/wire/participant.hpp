#pragma once
// A solver's end of the wire. One object, the life cycle of docs/protocol.md:
//
//     Participant link({.endpoint = "ipc://...", .name = "fem", .role = "surface"});   HELLO,
//     WELCOME link.announce(mesh);                                                            MESH,
//     MESH_ACK for (n = 0;; ++n) {
//         link.send(state);               STATE (or PROBE); returns at once
//         ... internal forces ...         while the coupler computes contact
//         StepReply reply = link.wait_reply();
//         if (reply.finish) break;
//         ... kick, drift with reply.force->dt ...
//     }
//     link.say_goodbye();                                                             BYE

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wire/messages.hpp"

namespace undertow::wire {

struct ParticipantOptions {
    std::string endpoint;  // "ipc:///path/coupler.sock", "tcp://127.0.0.1:port", or a recorded
                           // session, "replay:///path/recording.fem.utow"
    std::string name;      // unique within the run
    std::string role;      // "particles" or "surface"
    std::vector<std::string> capabilities;
    std::string software;
    double join_timeout = 60;  // [s] how long the coupler may take to appear and answer
    bool shared_memory = true;  // offer the data plane "shm1" where the endpoint is ipc
    std::vector<std::string> case_keys{};  // what this program's case must have in common with the
                                           // coupler's, see case/binding_keys.hpp; empty = not told
    std::string curve{};        // folder of keys for tcp, see wire/curve_keys.hpp; empty = none
    bool (*stop)() = nullptr;   // true once the user wants to end; asked until the first step
};

/// What came back for a step. Exactly one of force, checkpoint and finish is set.
struct StepReply {
    std::optional<Surface> surface;  // new whereabouts of the surfaces (particle solver only)
    std::optional<Active> active;    // new active list (only after a PROBE)
    std::optional<Force> force;
    std::optional<Checkpoint> checkpoint;
    std::optional<Finish> finish;
};

class Participant {
 public:
    /// Connects and shakes hands. Throws PeerError (E_TIMEOUT, E_VERSION, E_NAME_TAKEN, ...); E_STOP
    /// when the user stops this program before its first step, which the coupler is told.
    explicit Participant(const ParticipantOptions& options);
    ~Participant();
    Participant(Participant&&) noexcept;

    const Welcome& welcome() const;

    /// Sends a mesh and waits for its MESH_ACK; verifies the checksum.
    void announce(Mesh mesh);

    /// Particle solver: waits for the first SURFACE, which comes when every participant's meshes
    /// are in (at most the larger of join_timeout and the deadline). Call it once, after announce()
    /// and before the first PROBE; later ones arrive with wait_reply().
    Surface wait_surface();

    /// Sends without waiting for the answer. The session number is filled in; n, t must be right.
    /// By shared memory a STATE passed by move keeps its vectors: hand in the same one each step.
    void send(State&& state);
    void send(const State& state) { send(State(state)); }
    void send(Probe probe);
    void send(CheckpointAck ack);
    void send(const Progress& progress);
    /// Called every now and then in long work between two messages: a PROGRESS, once a tenth of the
    /// deadline has passed without a word.
    void still_busy(const std::string& doing);

    /// Waits for the answer to the last STATE or PROBE, at most welcome().deadline seconds.
    /// Checks session, step number, shape (f has as many rows as the state had) and finiteness.
    /// Throws PeerError: E_TIMEOUT, E_PEER_LOST, E_SEQUENCE, E_SHAPE, E_NONFINITE, or the error the
    /// coupler sent (its code and text).
    StepReply wait_reply();
    /// The same into a reply used before, whose force vector is reused (no allocation per step).
    void wait_reply(StepReply& reply);

    /// STATE and FORCE travel by shared memory.
    bool shares_memory() const;
    /// Of a replay, for the log: whether all messages were the recorded ones so far, in every bit, or
    /// which was the first that differed. Empty in a run with a coupler.
    std::string replay_verdict() const;

    /// [s] spent in wait_reply so far.
    double waited() const;

    /// Ends the session in good order (after finish) or tells the coupler why this program fails.
    void say_goodbye(std::int64_t n);
    void report_error(const std::string& code, const std::string& text) noexcept;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace undertow::wire
