// What can be said of any message: its type, step and session.

#include <cstdio>

#include "wire/codec.hpp"
#include "wire/layout.hpp"

namespace undertow::wire {

MessageType type_of(const Message& message) {
    return std::visit([]<class M>(const M&) { return type_of_struct<M>(); }, message);
}

const char* name_of(MessageType type) {
    switch (type) {
        case MessageType::hello:
            return "HELLO";
        case MessageType::welcome:
            return "WELCOME";
        case MessageType::mesh:
            return "MESH";
        case MessageType::mesh_ack:
            return "MESH_ACK";
        case MessageType::state:
            return "STATE";
        case MessageType::force:
            return "FORCE";
        case MessageType::checkpoint:
            return "CHECKPOINT";
        case MessageType::checkpoint_ack:
            return "CHECKPOINT_ACK";
        case MessageType::finish:
            return "FINISH";
        case MessageType::bye:
            return "BYE";
        case MessageType::error:
            return "ERROR";
        case MessageType::progress:
            return "PROGRESS";
        case MessageType::active:
            return "ACTIVE";
        case MessageType::probe:
            return "PROBE";
        case MessageType::surface:
            return "SURFACE";
    }
    return "?";
}

std::int64_t step_of(const Message& message) {
    return std::visit(
        [](const auto& m) -> std::int64_t {
            if constexpr (requires { m.n; }) return m.n;
            return 0;
        },
        message);
}

std::uint64_t session_of(const Message& message) {
    return std::visit(
        [](const auto& m) -> std::uint64_t {
            if constexpr (requires { m.session; }) return m.session;
            return 0;
        },
        message);
}

void set_session(Message& message, std::uint64_t session) {
    std::visit(
        [&](auto& m) {
            if constexpr (requires { m.session; }) m.session = session;
        },
        message);
}

std::string label(const Message& message) {
    const std::string name = name_of(type_of(message));
    const bool has_step = std::visit(
        [](const auto& m) {
            return requires {
                m.n;
            };
        },
        message);
    return has_step ? name + "(" + std::to_string(step_of(message)) + ")" : name;
}

std::string checksum(const Mesh& mesh) {
    std::uint64_t sum = 0xcbf29ce484222325;
    const auto add = [&](const auto& data) {
        for (const std::byte byte : std::as_bytes(std::span(data))) {
            sum = (sum ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
        }
    };
    add(mesh.x);
    add(mesh.mass);
    add(mesh.quad);
    add(mesh.group);
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(sum));
    return text;
}

}  // namespace undertow::wire
