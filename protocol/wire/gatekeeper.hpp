#pragma once
// Lets known keys in at the coupler's socket, and nobody else (ZeroMQ's ZAP, RFC 27).

#include <thread>
#include <vector>
#include <zmq.hpp>

#include "wire/curve_keys.hpp"

namespace undertow::wire {

/// A thread that answers the library's questions about the sockets of `context`, until the context
/// ends. Declare it before the context: it can be joined only after.
class Gatekeeper {
 public:
    void start(zmq::context_t& context, std::vector<CurveKeys::Friend> friends);

 private:
    std::jthread thread_;
};

}  // namespace undertow::wire
