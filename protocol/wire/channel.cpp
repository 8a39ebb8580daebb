#include "wire/channel.hpp"

#include <malloc.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <utility>

#include "wire/errors.hpp"
#include "wire/patience.hpp"

namespace undertow::wire {

namespace {

constexpr double longest_wait = 1.0;  // [s] of one system call
constexpr double longest_sleep = 0.05;  // [s] at a bell, until a peer that died is noticed
constexpr int send_slice = 100;       // [ms] a full queue is looked at again, and the monitor
constexpr int high_water_mark = 16;   // messages; in lock-step two or three are under way
constexpr std::size_t copy_below = 16 * 1024;  // [byte] of arrays; moving pays only above

// Heartbeats find half-open tcp links. They must not be faster than the protocol's deadline: a
// program stopped for a while may come back. (A Unix socket breaks at once when its peer dies.)
constexpr int heartbeat_interval = 5000;  // [ms]
constexpr int heartbeat_timeout = 60000;  // [ms]

constexpr int refused = ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                        ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;

/// Keeps the arrays of a sent message alive until ZeroMQ's thread has written the last of them.
struct Parcel {
    Message message;
    std::atomic<std::size_t> frames_left;
};

void release_parcel(void*, void* hint) {
    auto* parcel = static_cast<Parcel*>(hint);
    if (parcel->frames_left.fetch_sub(1) == 1) delete parcel;
}

/// The arrays of a step are allocated and freed by different threads, every step. With glibc's
/// defaults their pages go back to the system each time; keeping them halves the time and the CPU
/// of a step from 10,000 points on (docs/protocol.md). Costs memory only when large blocks lie
/// unused.
void keep_large_blocks() {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);   // [byte] the largest value glibc takes
    mallopt(M_TRIM_THRESHOLD, 256 << 20);  // [byte]
}

}  // namespace

Channel::Channel(End end, const std::string& endpoint, std::uint64_t max_message,
                 const CurveKeys* keys)
    : context_(1),
      socket_(context_, end == End::solver ? zmq::socket_type::dealer : zmq::socket_type::router),
      monitor_(context_, zmq::socket_type::pair),
      end_(end),
      max_message_(max_message) {
    keep_large_blocks();
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::sndhwm, high_water_mark);
    socket_.set(zmq::sockopt::rcvhwm, high_water_mark);
    socket_.set(zmq::sockopt::sndtimeo, send_slice);
    socket_.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(max_message));
    if (endpoint.starts_with("tcp://")) {
        socket_.set(zmq::sockopt::heartbeat_ivl, heartbeat_interval);
        socket_.set(zmq::sockopt::heartbeat_timeout, heartbeat_timeout);
        if (keys) lock_with(*keys);
    }
    if (end == End::solver) {
        // Not ZMQ_IMMEDIATE: with it libzmq throws away what has come but has not been read when
        // the other end hangs up, and with it the ERROR that says why.
        socket_.set(zmq::sockopt::reconnect_ivl, 20);  // [ms] the coupler may start later
        socket_.set(zmq::sockopt::reconnect_ivl_max, 200);
    } else {
        socket_.set(zmq::sockopt::router_mandatory,
                    true);  // a lost receiver is an error, not silence
    }
    const int events = ZMQ_EVENT_CONNECTED | ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED | refused;
    monitor_.set(zmq::sockopt::linger, 0);
    if (zmq_socket_monitor(socket_.handle(), "inproc://monitor", events) != 0) {
        throw PeerError("E_IO",
                        std::string("cannot watch the socket: ") + zmq_strerror(zmq_errno()));
    }
    monitor_.connect("inproc://monitor");
    try {
        if (end == End::solver) {
            socket_.connect(endpoint);
        } else {
            const mode_t before = umask(0077);  // the socket file is the owner's alone
            try {
                socket_.bind(endpoint);
            } catch (...) {
                umask(before);
                throw;
            }
            umask(before);
        }
    } catch (const zmq::error_t& error) {
        throw PeerError("E_IO", "cannot open the endpoint " + endpoint + ": " + error.what());
    }
    endpoint_ = socket_.get(zmq::sockopt::last_endpoint);
}

void Channel::lock_with(const CurveKeys& keys) {
    if (!zmq_has("curve"))
        throw InputError("this machine's ZeroMQ library has no CURVE; install one that has.");
    socket_.set(zmq::sockopt::curve_publickey, keys.own_public);
    socket_.set(zmq::sockopt::curve_secretkey, keys.own_secret);
    if (end_ == End::solver) {
        socket_.set(zmq::sockopt::curve_serverkey, keys.coupler);
        return;
    }
    gatekeeper_.start(context_, keys.friends);
    socket_.set(zmq::sockopt::zap_domain, "undertow");
    socket_.set(zmq::sockopt::curve_server, true);
}

std::string Channel::key_holder(const Packet& packet) {
    if (packet.n_frames == 0) return {};
    const char* name = zmq_msg_gets(const_cast<zmq_msg_t*>(packet.frames[0].handle()), "User-Id");
    return name ? name : "";
}

Channel::~Channel() {
    zmq_socket_monitor(socket_.handle(), nullptr, 0);
}

void Channel::linger(double seconds) {
    socket_.set(zmq::sockopt::linger, static_cast<int>(seconds * 1000));
}

bool Channel::send_frame(zmq::message_t& frame, bool more, double seconds, Sent& result) {
    const auto start = Clock::now();
    for (;;) {
        if (zmq_msg_send(frame.handle(), socket_.handle(), more ? ZMQ_SNDMORE : 0) >= 0)
            return true;
        const int error_number = zmq_errno();
        // EINTR is a signal such as Ctrl-C, whose flag the caller looks at later; EAGAIN a full
        // queue; anything else (EHOSTUNREACH) means that the receiver is gone.
        if (error_number != EAGAIN && error_number != EINTR) {
            result = Sent::connection_lost;
            return false;
        }
        drain_monitor();
        if (end_ == End::solver && any_broken()) {
            result = Sent::connection_lost;
            return false;
        }
        if (seconds_since(start) > seconds) {
            result = Sent::timed_out;
            return false;
        }
    }
}

Sent Channel::send(Message&& message, std::string_view receiver, double seconds) {
    encode(message, frames_);
    std::size_t bytes = frames_.header.size();
    for (std::size_t i = 0; i < frames_.n_arrays; ++i) {
        if (frames_.arrays[i].size() <= max_message_) continue;
        throw PeerError("E_SHAPE", label(message) + " has an array of " +
                                       std::to_string(frames_.arrays[i].size()) +
                                       " bytes; the other end takes " +
                                       std::to_string(max_message_));
    }

    // From here on the arrays belong to the frames: either as copies or together with the message.
    const bool move_arrays = frames_.array_bytes() >= copy_below;
    Parcel* parcel = nullptr;
    if (move_arrays) parcel = new Parcel{std::move(message), frames_.n_arrays};
    std::array<zmq::message_t, max_arrays> arrays;
    for (std::size_t i = 0; i < frames_.n_arrays; ++i) {
        const Bytes data = frames_.arrays[i];
        bytes += data.size();
        if (move_arrays) {
            arrays[i].rebuild(const_cast<std::byte*>(data.data()), data.size(), release_parcel,
                              parcel);
        } else {
            arrays[i].rebuild(data.size());
            if (!data.empty()) std::memcpy(arrays[i].data(), data.data(), data.size());
        }
    }

    Sent result = Sent::yes;
    if (end_ == End::coupler) {
        zmq::message_t address(receiver.data(), receiver.size());
        if (!send_frame(address, true, seconds, result)) return result;
    }
    zmq::message_t header(frames_.header.data(), frames_.header.size());
    if (!send_frame(header, frames_.n_arrays > 0, seconds, result)) return result;
    for (std::size_t i = 0; i < frames_.n_arrays; ++i) {
        if (!send_frame(arrays[i], i + 1 < frames_.n_arrays, seconds, result)) return result;
    }
    bytes_sent_ += bytes;
    return Sent::yes;
}

bool Channel::receive(Packet& packet) {
    packet.n_frames = 0;
    packet.bytes = 0;
    packet.connection = -1;
    bool more = true;
    bool address_due = end_ == End::coupler;
    constexpr std::size_t most_frames = max_arrays + 2;  // one too many is kept, to be noticed
    zmq::message_t beyond;
    while (more) {
        const bool keep = packet.n_frames < most_frames;
        if (keep && packet.frames.size() <= packet.n_frames) packet.frames.emplace_back();
        zmq::message_t& frame = keep ? packet.frames[packet.n_frames] : beyond;
        const int size = zmq_msg_recv(frame.handle(), socket_.handle(), ZMQ_DONTWAIT);
        if (size < 0) {
            if (zmq_errno() == EINTR) continue;
            return false;  // EAGAIN, only before the first frame: a multipart arrives whole
        }
        more = frame.more();
        if (address_due) {
            packet.sender.assign(frame.data<char>(), frame.size());
            address_due = false;
            continue;
        }
        if (packet.n_frames == 0) packet.connection = zmq_msg_get(frame.handle(), ZMQ_SRCFD);
        packet.bytes += frame.size();
        if (keep) ++packet.n_frames;
    }
    bytes_received_ += packet.bytes;
    return true;
}

double Channel::wait(double seconds) {
    const auto start = Clock::now();
    const double slice = std::clamp(seconds, 0.0, longest_wait);
    zmq_pollitem_t items[] = {{socket_.handle(), 0, ZMQ_POLLIN, 0},
                              {monitor_.handle(), 0, ZMQ_POLLIN, 0}};
    // Rounded up: a wait of 0.4 ms must not become a busy loop of waits of 0 ms.
    const long milliseconds = static_cast<long>(slice * 1000) + (slice > 0 ? 1 : 0);
    const int ready = zmq_poll(items, 2, milliseconds);  // a signal ends it early, with ready = -1
    if (ready > 0 && (items[1].revents & ZMQ_POLLIN)) drain_monitor();
    return std::min(seconds_since(start), longest_wait);
}

double Channel::wait_at(std::span<const Segment::Ring> rings, double seconds) {
    const auto start = Clock::now();
    const bool nobody_rang = Segment::wait(rings, std::clamp(seconds, 0.0, longest_sleep));
    if (nobody_rang) drain_monitor();
    return std::min(seconds_since(start), longest_wait);
}

void Channel::drain_monitor() {
    for (;;) {
        zmq::message_t event, address;
        int size = zmq_msg_recv(event.handle(), monitor_.handle(), ZMQ_DONTWAIT);
        if (size < 0 && zmq_errno() == EINTR) continue;
        if (size < 0) return;
        while (zmq_msg_recv(address.handle(), monitor_.handle(), 0) < 0 && zmq_errno() == EINTR) {
        }
        if (event.size() < 6) continue;
        std::uint16_t kind = 0;
        std::int32_t connection = -1;
        std::memcpy(&kind, event.data<char>(), 2);
        std::memcpy(&connection, event.data<char>() + 2, 4);
        if (kind == ZMQ_EVENT_CONNECTED) connected_ = true;
        if (kind & refused) ++handshakes_failed_;
        if (kind == ZMQ_EVENT_ACCEPTED) {
            open_.push_back(connection);
        } else if (kind == ZMQ_EVENT_DISCONNECTED) {
            std::erase(open_, connection);
            broken_.push_back(connection);
        }
    }
}

std::vector<int> Channel::take_broken() {
    drain_monitor();
    return std::exchange(broken_, {});
}

bool Channel::is_open(int connection) const {
    return std::find(open_.begin(), open_.end(), connection) != open_.end();
}

void decode(const Packet& packet, Message& message) {
    if (packet.n_frames == 0) throw PeerError("E_MALFORMED", "the message is empty");
    std::array<Bytes, max_arrays + 1> views;
    const std::size_t n_arrays = packet.n_frames - 1;
    for (std::size_t i = 0; i < n_arrays; ++i) {
        const zmq::message_t& frame = packet.frames[i + 1];
        views[i] = {static_cast<const std::byte*>(frame.data()), frame.size()};
    }
    const zmq::message_t& header = packet.frames[0];
    decode(Bytes(static_cast<const std::byte*>(header.data()), header.size()),
           std::span(views.data(), n_arrays), message);
}

}  // namespace undertow::wire
