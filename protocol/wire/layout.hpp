#pragma once
// The keys and arrays of every message, in the order in which they are written: the one place that
// fixes the bytes of protocol version 1. docs/protocol.md has the same tables with units.
//
// A new message is one describe() here, one line in type_of_struct() below and one in decode().
//
// `describe(io, message)` visits them: io.key(name, member) for what stands in the header,
// io.array(name, member, columns) for what travels as a raw frame; columns = 1 means shape (N),
// otherwise (N, columns); io.optional(name, member) for a key that a later minor version added,
// which is left out while the member is empty. Key "m" (the type) comes first and "a" (the list of
// arrays) last; both are the codec's. At most 32 keys: the decoder keeps a bit for each.

#include <concepts>
#include <type_traits>

#include "wire/messages.hpp"

namespace undertow::wire {

template <class M, class T>
concept Is = std::same_as<std::remove_const_t<M>, T>;  // reading and writing share one list

void describe(auto& io, Is<Hello> auto& m) {
    io.key("p", m.protocol);
    io.key("v", m.version);
    io.key("name", m.name);
    io.key("role", m.role);
    io.key("caps", m.capabilities);
    io.key("sw", m.software);
    io.key("units", m.units);
    io.optional("case", m.case_keys);
}

void describe(auto& io, Is<Welcome> auto& m) {
    io.key("s", m.session);
    io.key("v", m.version);
    io.key("caps", m.capabilities);
    io.key("n0", m.first_step);
    io.key("t0", m.t0);
    io.key("te", m.t_end);
    io.key("deadline", m.deadline);
    io.key("share", m.contact_share);
    io.key("max", m.max_message);
}

void describe(auto& io, Is<Mesh> auto& m) {
    io.key("s", m.session);
    io.key("mesh", m.mesh);
    io.key("rev", m.revision);
    io.key("kind", m.kind);
    io.key("groups", m.groups);
    io.key("r", m.radius);
    io.key("h", m.thickness);
    io.array("x", m.x, 3);
    io.array("mass", m.mass, 1);
    io.array("quad", m.quad, 4);
    io.array("group", m.group, 1);
}

void describe(auto& io, Is<MeshAck> auto& m) {
    io.key("s", m.session);
    io.key("mesh", m.mesh);
    io.key("rev", m.revision);
    io.key("sum", m.sum);
}

void describe(auto& io, Is<Surface> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("range", m.range);
    io.array("x", m.x, 3);
    io.array("quad", m.quad, 4);
    io.array("boxes", m.boxes, 6);
}

void describe(auto& io, Is<Probe> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("t", m.t);
    io.key("dl", m.dt_limit);
    io.key("lim", m.limiter);
    io.key("fl", m.flags);
    io.key("work", m.work);
    io.key("wait", m.wait);
    io.array("id", m.id, 1);
    io.array("x", m.x, 3);
    io.array("v", m.v, 3);
    io.array("mass", m.mass, 1);
    io.array("r", m.radius, 1);
    io.array("k", m.stiffness, 1);
    io.array("phase", m.phase, 1);
}

void describe(auto& io, Is<Active> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.array("row", m.row, 1);
}

void describe(auto& io, Is<State> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("t", m.t);
    io.key("dl", m.dt_limit);
    io.key("rev", m.revision);
    io.key("lim", m.limiter);
    io.key("fl", m.flags);
    io.key("reach", m.reach);
    io.key("work", m.work);
    io.key("wait", m.wait);
    io.array("x", m.x, 3);
    io.array("v", m.v, 3);
}

void describe(auto& io, Is<Force> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("dt", m.dt);
    io.key("t1", m.t1);
    io.key("fl", m.flags);
    io.key("lim", m.limiter);
    io.array("f", m.f, 3);
}

void describe(auto& io, Is<Checkpoint> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("id", m.id);
}

void describe(auto& io, Is<CheckpointAck> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("file", m.file);
    io.key("sha", m.sha256);
}

void describe(auto& io, Is<Finish> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("reason", m.reason);
}

void describe(auto& io, Is<Bye> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
}

void describe(auto& io, Is<Error> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("code", m.code);
    io.key("text", m.text);
    io.key("who", m.who);
}

void describe(auto& io, Is<Progress> auto& m) {
    io.key("s", m.session);
    io.key("n", m.n);
    io.key("frac", m.fraction);
    io.key("text", m.text);
}

/// dtype code of an array's element type.
template <class T>
constexpr const char* dtype_of() {
    if constexpr (std::same_as<T, double>) return "f8";
    if constexpr (std::same_as<T, std::int32_t>) return "i4";
    if constexpr (std::same_as<T, std::uint32_t>) return "u4";
    if constexpr (std::same_as<T, std::uint64_t>) return "u8";
}

/// Value of key "m".
template <class M>
constexpr MessageType type_of_struct() {
    if constexpr (std::same_as<M, Hello>) return MessageType::hello;
    if constexpr (std::same_as<M, Welcome>) return MessageType::welcome;
    if constexpr (std::same_as<M, Mesh>) return MessageType::mesh;
    if constexpr (std::same_as<M, MeshAck>) return MessageType::mesh_ack;
    if constexpr (std::same_as<M, Surface>) return MessageType::surface;
    if constexpr (std::same_as<M, Probe>) return MessageType::probe;
    if constexpr (std::same_as<M, Active>) return MessageType::active;
    if constexpr (std::same_as<M, State>) return MessageType::state;
    if constexpr (std::same_as<M, Force>) return MessageType::force;
    if constexpr (std::same_as<M, Checkpoint>) return MessageType::checkpoint;
    if constexpr (std::same_as<M, CheckpointAck>) return MessageType::checkpoint_ack;
    if constexpr (std::same_as<M, Finish>) return MessageType::finish;
    if constexpr (std::same_as<M, Bye>) return MessageType::bye;
    if constexpr (std::same_as<M, Error>) return MessageType::error;
    if constexpr (std::same_as<M, Progress>) return MessageType::progress;
}

}  // namespace undertow::wire
