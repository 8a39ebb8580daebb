#include "wire/session.hpp"

#include <utility>

#include "wire/codec.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::wire {

namespace {

std::string sentence(const Message& message, const std::string& rest) {
    return label(message) + " " + rest;
}

[[noreturn]] void out_of_order(const Message& message, const std::string& why) {
    throw PeerError("E_SEQUENCE", sentence(message, why));
}

/// The text carries the digits that make two nearly equal times differ.
std::string exact(double value) {
    return number_text(value, 17);
}

bool is_step_message(MessageType type) {
    return type == MessageType::state || type == MessageType::probe;
}

}  // namespace

const char* name_of(Phase phase) {
    switch (phase) {
        case Phase::hello:
            return "waiting for HELLO";
        case Phase::welcome:
            return "waiting for WELCOME";
        case Phase::meshes:
            return "waiting for MESH or the first STATE";
        case Phase::mesh_ack:
            return "waiting for MESH_ACK";
        case Phase::surface:
            return "waiting for the first SURFACE";
        case Phase::step:
            return "waiting for STATE or PROBE";
        case Phase::reply:
            return "waiting for FORCE, CHECKPOINT or FINISH";
        case Phase::checkpoint:
            return "waiting for CHECKPOINT_ACK";
        case Phase::bye:
            return "waiting for BYE";
        case Phase::closed:
            return "closed";
    }
    return "?";
}

Session::Session(std::string role) : role_(std::move(role)), probe_due_(role_ == "particles") {}

Side Session::turn() const {
    switch (phase_) {
        case Phase::welcome:
        case Phase::mesh_ack:
        case Phase::surface:
        case Phase::reply:
            return Side::coupler;
        default:
            return Side::solver;
    }
}

void Session::require_turn(Side from, const Message& message) const {
    const MessageType type = type_of(message);
    if (from == turn() && phase_ != Phase::closed) return;
    if (is_step_message(type) && phase_ == Phase::reply) {
        out_of_order(message, "came although step " + std::to_string(n_) +
                                  " has not been answered: a duplicate, or sent too early");
    }
    if (type == MessageType::force && phase_ == Phase::step && step_of(message) < n_) {
        out_of_order(message, "came twice: step " + std::to_string(n_) + " is running");
    }
    throw PeerError("E_STATE", sentence(message, std::string("came while ") + name_of(phase_)));
}

void Session::require_step(const Message& message) const {
    if (step_of(message) == n_) return;
    out_of_order(message, "came in step " + std::to_string(n_) + ": " +
                              (step_of(message) < n_ ? "it is stale" : "steps were skipped"));
}

void Session::require_rows(const Message& message, std::size_t rows) const {
    if (rows == rows_) return;
    throw PeerError("E_SHAPE",
                    sentence(message, "has " + std::to_string(rows) + " rows; agreed were " +
                                          std::to_string(rows_)));
}

void Session::check_solver_step(const Message& message, double t, double dt_limit) const {
    require_step(message);
    if (t != t_) {
        throw PeerError(
            "E_TIME", sentence(message, "stands at t = " + exact(t) + " s instead of " + exact(t_) +
                                            " s; take t1 of FORCE as it is"));
    }
    if (!(dt_limit > 0)) {
        throw PeerError("E_NONFINITE", sentence(message, "offers the step dl = " + exact(dt_limit) +
                                                             " s; it must be > 0"));
    }
}

void Session::follow(Side from, const Message& message) {
    const MessageType type = type_of(message);
    if (type != MessageType::hello && type != MessageType::welcome && type != MessageType::error &&
        session_of(message) != id_) {
        out_of_order(message, "belongs to session " + std::to_string(session_of(message)) +
                                  ", not to " + std::to_string(id_));
    }
    if (type == MessageType::error) {
        phase_ = Phase::closed;
        return;
    }
    if (type == MessageType::progress && phase_ != Phase::hello && phase_ != Phase::welcome &&
        phase_ != Phase::closed) {
        return;
    }
    require_turn(from, message);

    switch (phase_) {
        case Phase::hello:
            if (type == MessageType::hello) {
                phase_ = Phase::welcome;
                return;
            }
            break;
        case Phase::welcome:
            if (const auto* welcome = std::get_if<Welcome>(&message)) {
                id_ = welcome->session;
                n_ = welcome->first_step;
                t_ = welcome->t0;
                phase_ = Phase::meshes;
                return;
            }
            break;
        case Phase::meshes:
            if (const auto* mesh = std::get_if<Mesh>(&message)) {
                rows_ += mesh->x.size() / 3;
                ++n_meshes_;
                phase_ = Phase::mesh_ack;
                return;
            }
            if (const auto* state = std::get_if<State>(&message); state && n_meshes_ > 0) {
                check_solver_step(message, state->t, state->dt_limit);
                require_rows(message, state->x.size() / 3);
                phase_ = Phase::reply;
                return;
            }
            break;
        case Phase::mesh_ack:
            if (type == MessageType::mesh_ack) {
                phase_ = role_ == "particles" ? Phase::surface : Phase::meshes;
                return;
            }
            break;
        case Phase::surface:
            if (type == MessageType::surface) {
                phase_ = Phase::step;
                return;
            }
            break;
        case Phase::step:
            if (const auto* state = std::get_if<State>(&message); state && !probe_due_) {
                check_solver_step(message, state->t, state->dt_limit);
                require_rows(message, state->x.size() / 3);
                phase_ = Phase::reply;
                return;
            }
            if (const auto* probe = std::get_if<Probe>(&message); probe && probe_due_) {
                check_solver_step(message, probe->t, probe->dt_limit);
                probe_rows_ = probe->id.size();
                probe_due_ = false;
                active_due_ = true;
                phase_ = Phase::reply;
                return;
            }
            if (is_step_message(type)) {
                throw PeerError("E_STATE",
                                sentence(message, probe_due_ ? "came where a PROBE is due"
                                                             : "came where a STATE is due"));
            }
            break;
        case Phase::reply:
            if (type == MessageType::surface && role_ == "particles") {
                require_step(message);
                return;
            }
            if (const auto* active = std::get_if<Active>(&message); active && active_due_) {
                require_step(message);
                std::int64_t last = -1;
                for (const std::uint32_t row : active->row) {
                    if (row <= last || row >= probe_rows_) {
                        throw PeerError("E_SHAPE",
                                        sentence(message, "names row " + std::to_string(row) +
                                                              " after " + std::to_string(last) +
                                                              "; rows increase and stay below " +
                                                              std::to_string(probe_rows_)));
                    }
                    last = row;
                }
                rows_ = active->row.size();
                active_due_ = false;
                return;
            }
            if (const auto* force = std::get_if<Force>(&message)) {
                require_step(message);
                if (active_due_) {
                    throw PeerError("E_STATE", sentence(message,
                                                        "came after a PROBE without the "
                                                        "ACTIVE list"));
                }
                require_rows(message, force->f.size() / 3);
                if (!(force->dt > 0) || !(force->t1 > t_)) {
                    throw PeerError(
                        "E_TIME",
                        sentence(message, "grants dt = " + exact(force->dt) + " s from " +
                                              exact(t_) + " s to t1 = " + exact(force->t1) + " s"));
                }
                t_ = force->t1;
                probe_due_ = role_ == "particles" && (force->flags & force_probe) != 0;
                ++n_;
                phase_ = Phase::step;
                return;
            }
            if (type == MessageType::checkpoint) {
                require_step(message);
                phase_ = Phase::checkpoint;
                return;
            }
            if (type == MessageType::finish) {
                phase_ = Phase::bye;
                return;
            }
            break;
        case Phase::checkpoint:
            if (type == MessageType::checkpoint_ack) {
                require_step(message);
                phase_ = Phase::reply;
                return;
            }
            break;
        case Phase::bye:
            if (type == MessageType::bye) {
                phase_ = Phase::closed;
                return;
            }
            break;
        case Phase::closed:
            break;
    }
    throw PeerError("E_STATE", sentence(message, std::string("came while ") + name_of(phase_)));
}

}  // namespace undertow::wire
