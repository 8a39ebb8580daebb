#pragma once
// The life cycle of one connection between a solver and the coupler, as a state machine. The two
// speak in turns, so one machine serves both ends: each follows every message it sends or takes.
//
//     phase         who speaks   legal messages                              next phase
//     hello         solver       HELLO                                       welcome
//     welcome       coupler      WELCOME                                     meshes
//     meshes        solver       MESH                                        mesh_ack
//                                STATE(n0)   (surface, after a mesh)         reply
//     mesh_ack      coupler      MESH_ACK                                    meshes | surface
//     surface       coupler      SURFACE     (particles only)                step
//     step          solver       STATE(n) or PROBE(n), as the last FORCE asks   reply
//     reply         coupler      SURFACE, ACTIVE (after a PROBE)             reply
//                                FORCE(n)                                    step, n + 1
//                                CHECKPOINT(n)                               checkpoint
//                                FINISH                                      bye
//     checkpoint    solver       CHECKPOINT_ACK(n)                           reply
//     bye           solver       BYE                                         closed
//
// ERROR closes from any phase; PROGRESS may come at any time after WELCOME and changes nothing.

#include <cstdint>
#include <string>

#include "wire/messages.hpp"

namespace undertow::wire {

enum class Side { solver, coupler };
enum class Phase {
    hello,
    welcome,
    meshes,
    mesh_ack,
    surface,
    step,
    reply,
    checkpoint,
    bye,
    closed,
};

const char* name_of(Phase phase);

class Session {
 public:
    /// The role ("particles" or "surface") decides between PROBE and STATE.
    explicit Session(std::string role);

    /// Checks a message of `from` against the phase, the session id, the step number, the agreed
    /// time and the agreed number of rows, then moves on. Throws PeerError: E_STATE, E_SEQUENCE,
    /// E_TIME, E_SHAPE, E_NONFINITE (a step that must be > 0). The caller decides whether that is
    /// the peer's fault or its own.
    void follow(Side from, const Message& message);

    Phase phase() const { return phase_; }
    Side turn() const;                        // who has to speak next
    std::uint64_t id() const { return id_; }  // 0 before WELCOME
    std::int64_t step() const { return n_; }  // the running step
    bool owes_probe() const { return probe_due_; }
    std::size_t rows() const { return rows_; }  // of STATE and FORCE

 private:
    void require_turn(Side from, const Message& message) const;
    void require_step(const Message& message) const;
    void require_rows(const Message& message, std::size_t rows) const;
    void check_solver_step(const Message& message, double t, double dt_limit) const;

    std::string role_;
    Phase phase_ = Phase::hello;
    std::uint64_t id_ = 0;
    std::int64_t n_ = 0;
    double t_ = 0;  // [s] time at the start of step n
    std::size_t n_meshes_ = 0;
    std::size_t rows_ = 0;  // of STATE and FORCE: nodes, or active particles
    std::size_t probe_rows_ = 0;
    bool probe_due_ = false;
    bool active_due_ = false;
};

}  // namespace undertow::wire
