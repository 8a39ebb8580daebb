#include "wire/gatekeeper.hpp"

#include <array>
#include <string>
#include <utility>

namespace undertow::wire {

namespace {

constexpr const char* zap_endpoint = "inproc://zeromq.zap.01";  // fixed by RFC 27
constexpr std::size_t key_frame = 6;                            // of a question about CURVE

using Question = std::vector<std::string>;

/// version, request id, domain, address, routing id, mechanism, key.
Question next_question(zmq::socket_t& socket) {
    Question frames;
    zmq::message_t frame;
    do {
        if (!socket.recv(frame)) continue;  // EINTR
        frames.push_back(frame.to_string());
    } while (frames.empty() || frame.more());
    return frames;
}

const CurveKeys::Friend* who_is(const Question& question,
                                const std::vector<CurveKeys::Friend>& friends) {
    if (question.size() <= key_frame || question[5] != "CURVE" || question[key_frame].size() != 32)
        return nullptr;
    std::array<char, 41> text{};
    zmq_z85_encode(text.data(), reinterpret_cast<const std::uint8_t*>(question[key_frame].data()),
                   32);
    for (const CurveKeys::Friend& one : friends)
        if (one.key == text.data()) return &one;
    return nullptr;
}

void answer(zmq::socket_t& socket, const Question& question, const CurveKeys::Friend* who) {
    const std::array<std::string, 6> reply{"1.0",
                                           question.size() > 1 ? question[1] : "",
                                           who ? "200" : "400",
                                           who ? "welcome" : "unknown key",
                                           who ? who->name : "",
                                           ""};
    for (std::size_t i = 0; i < reply.size(); ++i)
        socket.send(zmq::buffer(reply[i]),
                    i + 1 < reply.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
}

}  // namespace

void Gatekeeper::start(zmq::context_t& context, std::vector<CurveKeys::Friend> friends) {
    zmq::socket_t socket(context, zmq::socket_type::rep);
    socket.set(zmq::sockopt::linger, 0);
    socket.bind(zap_endpoint);
    thread_ = std::jthread([socket = std::move(socket), friends = std::move(friends)]() mutable {
        try {
            for (;;) {
                const Question question = next_question(socket);
                answer(socket, question, who_is(question, friends));
            }
        } catch (const zmq::error_t&) {
            // The context ends, and with it the run.
        }
        socket.close();
    });
}

}  // namespace undertow::wire
