#pragma once
// A place of the run at the coupler, and who may take it.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "wire/messages.hpp"
#include "wire/recording.hpp"
#include "wire/segment.hpp"
#include "wire/session.hpp"

namespace undertow::wire {

/// One place of the run: a role that is expected, and the participant that fills it.
struct Seat {
    explicit Seat(const std::string& expected_role) : role(expected_role), session(expected_role) {}

    std::string role;
    Session session;
    std::string name, software;  // empty name: nobody has come yet
    std::string routing_id;
    int connection = -1;
    bool lost = false;
    bool told = false;   // has got, or has sent, the error that ends the run
    double silence = 0;  // [s] time listened without a word, while a message is due
    std::vector<std::string> capabilities;  // both sides have
    std::vector<Mesh> meshes;
    std::unique_ptr<Segment> segment;  // the data plane, if both sides have it
    bool by_segment = false;           // the running STATE came by it, so FORCE may go by it
    std::unique_ptr<RecordingWriter> recording;
    Mesh particles;  // the mesh of role "particles", against which a PROBE is checked

    bool taken() const { return !name.empty(); }
    bool can(const std::string& capability) const {
        return std::ranges::find(capabilities, capability) != capabilities.end();
    }
    bool waits_for_us() const {
        return session.id() != 0 && session.phase() != Phase::closed && !is_due() && !lost;
    }
    bool is_due() const {  // the participant has to speak
        return taken() && session.phase() != Phase::closed && session.turn() == Side::solver;
    }
};

/// An ERROR to someone who does not get a place.
struct Refusal {
    std::string code, text;
};

/// The free seat for who says `hello`, or nullptr with the reason: E_VERSION, E_NAME_TAKEN, E_LATE
/// (the role is filled), E_INPUT (name, units or role the run does not know).
Seat* find_seat_for(const Hello& hello, std::vector<Seat>& seats, Refusal& why);

}  // namespace undertow::wire
