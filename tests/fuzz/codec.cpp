// libFuzzer target: whatever bytes come, a message is decoded whole or refused with a PeerError; and what
// was decoded survives being written and read again.
//
// An input is one multipart: u8 number of arrays, u16 bytes of the header, u16 bytes of each array, then
// the header and the arrays. What is missing at the end is left out.

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <msgpack/null_visitor.hpp>
#include <msgpack/unpack.hpp>
#include <vector>

#include "wire/codec.hpp"
#include "wire/data_check.hpp"
#include "wire/errors.hpp"
#include "wire/header_reader.hpp"
#include "wire/session.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

struct Input {
    const std::uint8_t* data;
    std::size_t left;

    std::size_t number(std::size_t bytes) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < bytes && left > 0; ++i, ++data, --left)
            value |= std::size_t(*data) << (8 * i);
        return value;
    }
    Bytes bytes(std::size_t wanted) {
        const std::size_t size = std::min(wanted, left);
        const Bytes view{reinterpret_cast<const std::byte*>(data), size};
        data += size, left -= size;
        return view;
    }
};

/// The header's buffer is exactly as long as it claims, so that a read past its end is seen.
std::vector<std::byte> own_copy(Bytes bytes) {
    return {bytes.begin(), bytes.end()};
}

/// What msgpack-c thinks of the bytes, with our limits.
struct Judge : msgpack::null_visitor {
    int depth = 0;
    std::size_t n_values = 0;
    bool good = true;
    bool visit_nil() { return count(); }
    bool visit_boolean(bool) { return count(); }
    bool visit_positive_integer(std::uint64_t) { return count(); }
    bool visit_negative_integer(std::int64_t) { return count(); }
    bool visit_float32(float) { return count(); }
    bool visit_float64(double) { return count(); }
    bool visit_str(const char*, std::uint32_t) { return count(); }
    bool visit_bin(const char*, std::uint32_t) { return count(); }
    bool visit_ext(const char*, std::uint32_t) { return good = false; }
    bool start_array(std::uint32_t) { return count() && (good = ++depth <= max_depth); }
    bool start_map(std::uint32_t) { return count() && (good = ++depth <= max_depth); }
    bool end_array() { return --depth, true; }
    bool end_map() { return --depth, true; }
    void parse_error(std::size_t, std::size_t) { good = false; }
    void insufficient_bytes(std::size_t, std::size_t) { good = false; }
    bool count() { return ++n_values, true; }
};

void compare_with_msgpack(Bytes header) {
    Judge judge;
    std::size_t end = 0;
    const bool parsed =
        msgpack::parse(reinterpret_cast<const char*>(header.data()), header.size(), end, judge);
    const bool good = parsed && judge.good && end == header.size();
    std::size_t ours = 0;
    bool taken = true;
    try {
        ours = parse_header(header).size();
    } catch (const PeerError&) {
        taken = false;
    }
    if (taken != good || (taken && ours != judge.n_values)) std::abort();
}

void round_trip(const Message& message) {
    Frames frames;
    encode(message, frames);
    const std::string header = frames.header;
    Message again;
    decode(std::as_bytes(std::span(header)), std::span(frames.arrays.data(), frames.n_arrays),
           again);
    Frames second;
    encode(again, second);
    if (second.header != header || again.index() != message.index()) std::abort();
}

/// A session that is given this message in any phase refuses it in words or goes on.
void follow(const Message& message) {
    static const Mesh phases = [] {
        Mesh mesh;
        mesh.groups = {"water"};
        mesh.radius = 1;
        return mesh;
    }();
    for (const char* role : {"particles", "surface"}) {
        for (const Side side : {Side::solver, Side::coupler}) try {
                Session session(role);
                if (side == Side::coupler) session.follow(Side::solver, Hello{});
                session.follow(side, message);
                session.follow(side, message);
            } catch (const PeerError&) {
            }
        if (const auto* mesh = std::get_if<Mesh>(&message)) try {
                check_mesh(*mesh, role);
            } catch (const PeerError&) {
            }
    }
    if (const auto* probe = std::get_if<Probe>(&message)) try {
            check_probe(*probe, phases);
        } catch (const PeerError&) {
        }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input input{data, size};
    const std::size_t n_arrays = input.number(1) % (max_arrays + 2);
    const std::size_t header_size = input.number(2);
    std::array<std::size_t, max_arrays + 2> sizes{};
    for (std::size_t i = 0; i < n_arrays; ++i) sizes[i] = input.number(2);
    const std::vector<std::byte> header = own_copy(input.bytes(header_size));
    std::array<std::vector<std::byte>, max_arrays + 2> arrays;
    std::array<Bytes, max_arrays + 2> views;
    for (std::size_t i = 0; i < n_arrays; ++i) views[i] = arrays[i] = own_copy(input.bytes(sizes[i]));
    compare_with_msgpack(header);
    static Message reused;  // as a running program does
    try {
        decode(header, std::span(views.data(), n_arrays), reused);
    } catch (const PeerError&) {
        return 0;
    }
    round_trip(reused);
    follow(reused);
    return 0;
}
