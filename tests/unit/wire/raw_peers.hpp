#pragma once
// Peers that say anything, in any order: the faults of a protocol are made with them.

#include <chrono>
#include <span>

#include "../../golden/samples.hpp"
#include "peers.hpp"
#include "wire/channel.hpp"

namespace undertow::wire {

/// A bare socket. As solver it talks to a Host, as coupler to one Participant.
class RawPeer {
 public:
    RawPeer(Channel::End end, const std::string& endpoint)
        : channel_(end, endpoint, default_max_message) {}

    /// Sends with the session id as it stands in the message.
    void send(Message message) { channel_.send(std::move(message), partner_, 5); }

    /// Next message that is not PROGRESS. Throws std::runtime_error when none comes in `seconds`.
    Message receive(double seconds = 5) {
        const auto start = std::chrono::steady_clock::now();
        for (;;) {
            if (channel_.receive(packet_)) {
                partner_ = packet_.sender;
                Message message;
                decode(packet_, message);
                if (!std::holds_alternative<Progress>(message)) return message;
                ++n_progress;
                continue;
            }
            const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
            if (waited.count() > seconds) throw std::runtime_error("no message came");
            channel_.wait(seconds);
        }
    }

    template <class M>
    M expect() {
        return std::get<M>(receive());
    }

    Channel& channel() { return channel_; }
    int n_progress = 0;

 private:
    Channel channel_;
    Packet packet_;
    std::string partner_;
};

/// Sends bytes as they are, from a socket of its own.
class ByteSender {
 public:
    explicit ByteSender(const std::string& endpoint) : socket_(context_, zmq::socket_type::dealer) {
        socket_.set(zmq::sockopt::linger, 0);
        socket_.set(zmq::sockopt::rcvtimeo, 5000);
        socket_.set(zmq::sockopt::sndtimeo, 5000);
        socket_.connect(endpoint);
    }
    void send(const RawFrames& frames) {
        for (std::size_t i = 0; i < frames.size(); ++i) {
            socket_.send(zmq::buffer(frames[i]),
                         i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
        }
    }
    Message receive() {
        RawFrames frames;
        zmq::message_t frame;
        do {
            if (!socket_.recv(frame)) throw std::runtime_error("no message came");
            frames.push_back(frame.to_string());
        } while (frame.more());
        return decoded(frames);
    }
    bool has_answer() {
        zmq_pollitem_t item{socket_.handle(), 0, ZMQ_POLLIN, 0};
        return zmq_poll(&item, 1, 0) > 0;
    }

 private:
    zmq::context_t context_{1};
    zmq::socket_t socket_;
};

inline Hello hello_of(const std::string& name, const std::string& role) {
    Hello hello;
    hello.name = name;
    hello.role = role;
    hello.software = "raw";
    return hello;
}

}  // namespace undertow::wire
