#pragma once
// Message <-> frames. Frame 0 is a MessagePack map, frames 1..k are the arrays' raw bytes.
// Knows no sockets. Decoding trusts nothing: whatever the bytes, it returns a complete message or
// throws a PeerError (E_MALFORMED, E_SHAPE, E_NONFINITE).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "wire/messages.hpp"

namespace undertow::wire {

using Bytes = std::span<const std::byte>;

inline constexpr std::size_t max_header = 64 * 1024;  // [byte]
inline constexpr int max_depth = 4;                   // map > "a" > entry > shape
inline constexpr std::size_t max_arrays = 16;         // per message

/// One encoded message. The arrays are views into the message: keep it alive while they are used.
struct Frames {
    std::string header;
    std::array<Bytes, max_arrays> arrays;
    std::size_t n_arrays = 0;

    std::size_t array_bytes() const;  // [byte] all arrays together
};

/// Fills `frames`, whose buffers are reused. Throws std::logic_error when the header passes 64 kB
/// or an array is not a whole number of rows: both are mistakes of this program.
void encode(const Message& message, Frames& frames);

/// Fills `message`; when it holds the same type already, its vectors and strings are reused, so
/// that a message of a running step costs no allocation. After
/// an exception its content is unspecified, but destructible and assignable.
void decode(Bytes header, std::span<const Bytes> arrays, Message& message);

MessageType type_of(const Message& message);
const char* name_of(MessageType type);             // "STATE"
std::int64_t step_of(const Message& message);      // n; 0 for messages without a step
std::uint64_t session_of(const Message& message);  // s; 0 for HELLO
void set_session(Message& message, std::uint64_t session);
std::string label(const Message& message);  // "STATE(7)", "MESH"

/// FNV-1a, 64 bits, over the bytes of x, mass, quad and group in this order; 16 hex digits.
std::string checksum(const Mesh& mesh);

}  // namespace undertow::wire
