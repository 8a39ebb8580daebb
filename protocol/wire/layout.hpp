#pragma once
// The keys and arrays of every message, in the order in which they are written: the one place that
// fixes the bytes of protocol version 1. docs/protocol.md has the same tables with units.
//
// `describe(io, message)` visits them: io.key(name, member) for what stands in the header,
// io.array(name, member, columns) for what travels as a raw frame; columns = 1 means shape (N),
// otherwise (N, columns). Key "m" (the type) comes first and "a" (the list of arrays) last; both
// are the codec's. At most 15 keys, so that the map's size is one byte.

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

}  // namespace undertow::wire
