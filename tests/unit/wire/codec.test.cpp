// Bytes to messages and back; whatever the bytes, decoding ends in a message or a PeerError.

#include <bit>
#include <catch2/catch.hpp>
#include <cstring>
#include <msgpack.hpp>
#include <random>

#include "../../golden/samples.hpp"
#include "wire/codec.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

std::string code_of(const RawFrames& frames) {
    try {
        decoded(frames);
    } catch (const PeerError& error) {
        return error.code;
    }
    return "";
}

std::string text_of(const RawFrames& frames) {
    try {
        decoded(frames);
    } catch (const PeerError& error) {
        return error.what();
    }
    return "";
}

State sample_state(std::size_t n_points) {
    State state;
    state.session = 42;
    state.n = 1234567;
    state.t = 0.1;
    state.dt_limit = 1e-6;
    state.limiter = "sound";
    state.x.resize(3 * n_points);
    state.v.resize(3 * n_points);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
        state.x[i] = 0.001 * double(i);
        state.v[i] = -0.5 * double(i);
    }
    return state;
}

/// msgpack-c's bytes of a value, except that a double stays a float64: msgpack-c shortens whole
/// doubles to integers, the protocol does not.
void repack(const msgpack::object& value, std::string& out) {
    std::stringstream bytes;
    msgpack::packer<std::stringstream> pack(bytes);
    if (value.type == msgpack::type::MAP) {
        pack.pack_map(value.via.map.size);
        out += bytes.str();
        for (const auto& entry : value.via.map) {
            repack(entry.key, out);
            repack(entry.val, out);
        }
    } else if (value.type == msgpack::type::ARRAY) {
        pack.pack_array(value.via.array.size);
        out += bytes.str();
        for (const msgpack::object& element : value.via.array) repack(element, out);
    } else if (value.type == msgpack::type::FLOAT64) {
        const auto bits = std::bit_cast<std::uint64_t>(value.via.f64);
        out += '\xcb';
        for (int shift = 56; shift >= 0; shift -= 8) out += static_cast<char>(bits >> shift);
    } else {
        pack.pack(value);
        out += bytes.str();
    }
}

}  // namespace

TEST_CASE("a STATE survives the round trip to the last bit") {
    const State sent = sample_state(1000);
    const Message received = decoded(raw_frames(sent));
    const State& state = std::get<State>(received);
    CHECK(state.session == sent.session);
    CHECK(state.n == sent.n);
    CHECK(state.t == sent.t);
    CHECK(state.dt_limit == sent.dt_limit);
    CHECK(state.limiter == sent.limiter);
    CHECK(state.x == sent.x);
    CHECK(state.v == sent.v);
}

TEST_CASE("the headers are what msgpack-c reads and writes") {
    for (const Sample& sample : golden_samples()) {
        INFO(sample.file);
        const std::string header = raw_frames(sample.message)[0];
        const msgpack::object_handle read = msgpack::unpack(header.data(), header.size());
        REQUIRE(read.get().type == msgpack::type::MAP);
        std::string written;
        repack(read.get(), written);
        CHECK(written == header);
    }
}

TEST_CASE("an optional key that does not come leaves nothing of the message before") {
    Hello hello;
    hello.case_keys = {"a = 1", "b = 2"};
    Message message = decoded(raw_frames(hello));
    CHECK(std::get<Hello>(message).case_keys == hello.case_keys);
    hello.case_keys.clear();
    const RawFrames frames = raw_frames(hello);
    CHECK(frames[0].find("case") == std::string::npos);
    decode(std::as_bytes(std::span(frames[0])), {}, message);
    CHECK(std::get<Hello>(message).case_keys.empty());
}

TEST_CASE("integers at every width boundary keep their value and their shortest form") {
    for (const std::uint64_t value :
         {0ull, 127ull, 128ull, 255ull, 256ull, 65535ull, 65536ull, 4294967295ull, 4294967296ull,
          9223372036854775807ull, 18446744073709551615ull}) {
        const RawFrames frames = raw_frames(Bye{value, 0});
        CHECK(std::get<Bye>(decoded(frames)).session == value);
        std::stringstream packed;
        msgpack::pack(packed, value);
        CHECK(frames[0].find("\xa1s" + packed.str()) != std::string::npos);
    }
    for (const std::int64_t value :
         {-1ll, -32ll, -33ll, -128ll, -129ll, -32768ll, -32769ll, -2147483648ll, -2147483649ll}) {
        const RawFrames frames = raw_frames(Bye{1, value});
        CHECK(std::get<Bye>(decoded(frames)).n == value);
        std::stringstream packed;
        msgpack::pack(packed, value);
        CHECK(frames[0].find("\xa1n" + packed.str()) != std::string::npos);
    }
}

TEST_CASE("keys may come in any order, and unknown keys and arrays are ignored") {
    msgpack::sbuffer buffer;
    msgpack::packer<msgpack::sbuffer> pack(buffer);
    pack.pack_map(8);
    pack.pack(std::string("a"));
    pack.pack_array(2);
    pack.pack_array(3);
    pack.pack(std::string("added_in_1_1"));
    pack.pack(std::string("f4"));
    pack.pack(std::vector<int>{1});
    pack.pack_array(3);
    pack.pack(std::string("f"));
    pack.pack(std::string("f8"));
    pack.pack(std::vector<int>{0, 3});
    pack.pack(std::string("future"));
    pack.pack(std::vector<std::string>{"x", "y"});
    pack.pack(std::string("lim"));
    pack.pack(std::string("sph: sound"));
    pack.pack(std::string("n"));
    pack.pack(3);
    pack.pack(std::string("t1"));
    pack.pack(2);  // an integer where a number is due
    pack.pack(std::string("dt"));
    pack.pack(0.5f);
    pack.pack(std::string("m"));
    pack.pack(6);
    pack.pack(std::string("s"));
    pack.pack(9);
    RawFrames frames{{buffer.data(), buffer.size()}, std::string(4, '\0'), ""};
    CHECK(code_of(frames) == "E_MALFORMED");
    CHECK(text_of(frames).find("key fl is missing") != std::string::npos);
    frames[0][0] = '\x89';
    frames[0] +=
        "\xa2"
        "fl"
        "\x02";
    const Message message = decoded(frames);
    const Force& force = std::get<Force>(message);
    CHECK(force.n == 3);
    CHECK(force.t1 == 2.0);
    CHECK(force.dt == 0.5);
    CHECK(force.flags == 2);
    CHECK(force.f.empty());
}

TEST_CASE("a fault is named: message, step, array, place and value") {
    State state = sample_state(4);
    state.n = 88;
    state.v[7] = std::numeric_limits<double>::infinity();
    const std::string text = text_of(raw_frames(state));
    CHECK(text.find("STATE(88)") != std::string::npos);
    CHECK(text.find("v[2, 1] is inf") != std::string::npos);
}

TEST_CASE("a header beyond 64 kB is refused before it is looked at") {
    RawFrames frames = raw_frames(Bye{1, 1});
    frames[0].resize(max_header + 1);
    CHECK(code_of(frames) == "E_MALFORMED");
}

TEST_CASE("a key or array that comes twice is refused") {
    RawFrames frames = raw_frames(Bye{1, 1});
    frames[0][0] = static_cast<char>(frames[0][0] + 1);
    frames[0] += "\xa1n\x02";
    CHECK(code_of(frames) == "E_MALFORMED");
}

TEST_CASE("a shape whose size overflows 64 bits does not pass for an empty frame") {
    RawFrames frames = raw_frames(sample_state(0));
    const std::string shape =
        "\xa2"
        "f8"
        "\x92" +
        std::string(1, '\0') + "\x03";
    const std::size_t place = frames[0].find(shape);
    REQUIRE(place != std::string::npos);
    // (2^61, 3) elements of 8 bytes are 3 * 2^64 bytes: 0 in 64 bits.
    const std::string huge =
        "\xa2"
        "f8"
        "\x92\xcf\x20" +
        std::string(7, '\0') + "\x03";
    frames[0].replace(place, shape.size(), huge);
    frames[0].replace(frames[0].find(shape), shape.size(), huge);  // v as well
    CHECK(code_of(frames) == "E_SHAPE");
}

TEST_CASE("decoding into the same message again moves no vector") {
    const RawFrames frames = raw_frames(sample_state(500));
    std::vector<Bytes> arrays{std::as_bytes(std::span(frames[1])),
                              std::as_bytes(std::span(frames[2]))};
    const Bytes header = std::as_bytes(std::span(frames[0]));
    Message message;
    decode(header, arrays, message);
    const double* x = std::get<State>(message).x.data();
    for (int i = 0; i < 100; ++i) decode(header, arrays, message);
    CHECK(std::get<State>(message).x.data() == x);
}

TEST_CASE("100000 mutated messages end in a message or a PeerError, never otherwise") {
    std::mt19937_64 random(20240607);
    std::vector<RawFrames> seeds;
    for (const Sample& sample : golden_samples()) seeds.push_back(raw_frames(sample.message));
    int n_refused = 0;
    for (int round = 0; round < 100000; ++round) {
        RawFrames frames = seeds[random() % seeds.size()];
        std::string& header = frames[0];
        for (std::uint64_t edits = 1 + random() % 4; edits > 0; --edits) {
            const std::size_t place = random() % (header.size() + 1);
            switch (random() % 4) {
                case 0:
                    header.insert(place, 1, static_cast<char>(random()));
                    break;
                case 1:
                    header.resize(place);
                    break;
                case 2:
                    header.erase(place, random() % 4);
                    break;
                default:
                    if (place < header.size()) header[place] = static_cast<char>(random());
            }
        }
        if (random() % 8 == 0 && frames.size() > 1) frames.back().resize(random() % 64);
        n_refused += !code_of(frames).empty();
    }
    CHECK(n_refused > 50000);  // most edits break a message; some only change a number or a text
}
