#pragma once
// One ZeroMQ socket with time-outs everywhere: DEALER at the solver, ROUTER at the coupler. Moves
// whole messages and notices when a connection breaks. Knows nothing of sessions.
//
// Every wait blocks in the system (no spinning: three spinning programs on two cores are hundreds
// of times slower) and returns after a second at most, so that its caller can count silence.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <zmq.hpp>

#include "wire/codec.hpp"
#include "wire/curve_keys.hpp"
#include "wire/gatekeeper.hpp"
#include "wire/messages.hpp"
#include "wire/segment.hpp"

namespace undertow::wire {

/// Larger frames close the connection: 16 million points in one frame.
inline constexpr std::uint64_t default_max_message = std::uint64_t{512} << 20;  // [byte]

/// A message as it came: sender, connection, frames. Reused from message to message.
struct Packet {
    std::string sender;   // routing id, only at a ROUTER
    int connection = -1;  // file descriptor of the connection it came by
    std::vector<zmq::message_t> frames;
    std::size_t n_frames = 0;
    std::uint64_t bytes = 0;
};

enum class Sent { yes, connection_lost, timed_out };

class Channel {
 public:
    enum class End { solver, coupler };

    /// Connects (solver) or binds (coupler). Throws PeerError E_IO when the address cannot be
    /// bound.
    /// With keys a tcp connection is encrypted, and only friends get one.
    Channel(End end, const std::string& endpoint, std::uint64_t max_message,
            const CurveKeys* keys = nullptr);
    ~Channel();  // drops what has not been sent, unless linger() said otherwise
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;

    const std::string& endpoint() const { return endpoint_; }  // as bound: a port 0 is resolved

    /// Largest frame the other end takes [byte].
    void limit_frames(std::uint64_t max_message) { max_message_ = max_message; }

    /// How long the destructor may wait for unsent messages.
    void linger(double seconds);

    /// Sends to `receiver` (a routing id; empty at a solver). Large arrays are not copied: their
    /// vectors move into the frames. Throws PeerError E_SHAPE when an array is larger than the
    /// other end takes: sent, it would only break the connection.
    Sent send(Message&& message, std::string_view receiver, double seconds);

    /// Takes the next message if one is there; never waits. Frames beyond what any message has are
    /// dropped, so that they fail the frame count.
    bool receive(Packet& packet);

    /// Waits for a message or a broken connection, at most `seconds` and at most one second.
    /// Returns the time it counts as silence [s]: while this process itself was stopped (Ctrl-Z), a
    /// peer could not be heard, so a long pause counts as one second.
    double wait(double seconds);

    /// The same at the bells of shared memory, in slices after which the connections are looked at.
    double wait_at(std::span<const Segment::Ring> rings, double seconds);

    /// Connections that broke since the last call, in order.
    std::vector<int> take_broken();
    /// A coupler's connection that has been accepted and is not broken.
    bool is_open(int connection) const;
    bool any_broken() const { return !broken_.empty(); }
    /// A solver: the coupler's socket has answered at least once.
    bool ever_connected() {
        drain_monitor();
        return connected_;
    }

    /// Connections that were refused for their keys, on either side, or broke before they were made.
    int handshakes_failed() const { return handshakes_failed_; }
    /// Whose key the sender of a packet has; empty without keys.
    static std::string key_holder(const Packet& packet);

    std::uint64_t bytes_sent() const { return bytes_sent_; }
    std::uint64_t bytes_received() const { return bytes_received_; }

 private:
    void lock_with(const CurveKeys& keys);
    void drain_monitor();
    bool send_frame(zmq::message_t& frame, bool more, double seconds, Sent& result);

    Gatekeeper gatekeeper_;
    zmq::context_t context_;
    zmq::socket_t socket_;
    zmq::socket_t monitor_;
    End end_;
    std::string endpoint_;
    std::uint64_t max_message_;
    Frames frames_;  // of the message being sent
    std::vector<int> open_, broken_;
    bool connected_ = false;
    int handshakes_failed_ = 0;
    std::uint64_t bytes_sent_ = 0, bytes_received_ = 0;
};

/// decode() of a packet's frames.
void decode(const Packet& packet, Message& message);

}  // namespace undertow::wire
