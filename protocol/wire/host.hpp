#pragma once
// The coupler's end of the wire: one ROUTER socket, a session per participant. Used by one thread.
//
//     Host host({.endpoint = ..., .welcome = {.t_end = ...}});
//     host.wait_join();                                         HELLO, WELCOME
//     meshes = host.wait_meshes();                              MESH, MESH_ACK
//     host.send(particles, surface);                            SURFACE
//     for (n = 0;; ++n) {
//         host.next() from each                                 STATE or PROBE
//         if (end) break;
//         host.send(particles, active);                         ACTIVE, after a PROBE
//         host.send(each, force);                               FORCE
//     }
//     host.finish(n, "done");                                   FINISH, BYE

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "wire/messages.hpp"

namespace undertow::wire {

struct HostOptions {
    std::string endpoint;  // "ipc:///dir/coupler.sock" (locked, dir is 0700) or "tcp://127.0.0.1:0"
    std::vector<std::string> expected_roles{"particles", "surface"};  // one participant for each
    double join_timeout = 60;                                         // [s]
    double deadline = 60;  // [s] longest silence of a participant
    Welcome welcome;       // session 0 = draw one; versions filled in; the capabilities are ours
    bool shared_memory = true;  // offer the data plane "shm1" where the endpoint is ipc
    /// Asked of a HELLO that names keys of its case and would get a place: why it must not, in one
    /// sentence; empty: it may. Who is refused reads the sentence, and the coupler waits on.
    std::function<std::string(const Hello&)> objection{};
    std::string curve{};        // folder of keys for tcp, see wire/curve_keys.hpp; empty = none
    std::string record_in{};    // folder for a recording of each session; empty = none
    bool (*stop)() = nullptr;   // true once the user wants to end; asked while the run is prepared
    bool (*loss)() = nullptr;   // true once a program of the run has ended; asked in wait_join()
};

struct Received {
    std::size_t participant;  // index in order of expected_roles
    Message message;
};

class Host {
 public:
    /// Binds (throws PeerError E_IO naming the process that holds the endpoint).
    explicit Host(const HostOptions& options);
    ~Host();

    const std::string& endpoint() const;  // as bound: a tcp port 0 is resolved

    /// Waits until every expected role has said HELLO and got WELCOME. A wrong version, a taken
    /// name or a third joiner gets its ERROR. Throws PeerError E_TIMEOUT that names who is missing,
    /// E_STOP when the user stops the run, here or in wait_meshes(), and E_PEER_LOST when a program
    /// of the run is said to have ended while somebody is missing.
    void wait_join();

    /// Waits for the meshes and answers MESH_ACK; result per participant. Particles announce one
    /// mesh; the meshes of a surface are complete when its first STATE has come (which next() then
    /// returns). Structural checks here (shapes, indices, finite, mass > 0); geometric ones
    /// (degenerate facets) are the caller's.
    std::vector<std::vector<Mesh>> wait_meshes();

    /// Next valid message of a running step from any participant (STATE, PROBE, CHECKPOINT_ACK,
    /// BYE). Session, step order, shapes and finiteness have been checked against the state
    /// machine. PROGRESS restarts the deadline and is not returned. While one participant is slow,
    /// the others get a PROGRESS every third of the deadline, so that only this side judges the
    /// slow one. Throws PeerError after having told all other participants: E_TIMEOUT, E_PEER_LOST,
    /// E_MALFORMED, E_NONFINITE, E_SEQUENCE, a peer's own ERROR, ...
    Received next();

    /// Like next(), but returns false when `seconds` pass without a message. Reuses the vectors of
    /// `received` when it holds a message of the same type already (no allocation per step).
    bool next_within(double seconds, Received& received);

    /// Sends; the session number is filled in. Pass the message by move: its arrays then travel
    /// without a copy. A message that the session does not allow here is a std::logic_error. A lost
    /// participant is reported by the next next().
    /// By shared memory the message keeps its buffers: hand in the same one each step.
    void send(std::size_t participant, Message&& message);

    /// Tells every participant why the run fails (used by main before exit); never throws.
    void broadcast_error(const std::string& code, const std::string& text,
                         const std::string& who) noexcept;

    /// Called every now and then in long work of the coupler's own: a PROGRESS to all who wait for
    /// it, once a tenth of the deadline has passed since the last one.
    void still_busy(const std::string& doing);

    /// FINISH to all, waits for every BYE (at most deadline).
    void finish(std::int64_t n, const std::string& reason);

    const std::string& name(std::size_t participant) const;
    const std::string& software(std::size_t participant) const;
    /// Both this side (HostOptions::welcome) and the participant (HELLO) named the capability.
    bool can(std::size_t participant, const std::string& capability) const;
    /// STATE and FORCE travel by shared memory: every participant can, and the endpoint is ipc.
    bool shares_memory() const;
    std::uint64_t bytes_sent() const;
    std::uint64_t bytes_received() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace undertow::wire
