#include "wire/header_reader.hpp"

#include <bit>
#include <cstdio>
#include <limits>

#include "wire/errors.hpp"

namespace undertow::wire {

namespace {

[[noreturn]] void malformed(const std::string& what) {
    throw PeerError("E_MALFORMED", what);
}

[[noreturn]] void unexpected(const char* wanted, unsigned char marker) {
    char text[96];
    std::snprintf(text, sizeof text, "%s expected, but the MessagePack byte is 0x%02x", wanted,
                  marker);
    malformed(text);
}

}  // namespace

unsigned char HeaderReader::take() {
    if (rest_.empty()) malformed("the header ends in the middle of a value");
    const auto byte = static_cast<unsigned char>(rest_.front());
    rest_ = rest_.subspan(1);
    return byte;
}

std::uint64_t HeaderReader::take_big_endian(int n_bytes) {
    std::uint64_t bits = 0;
    for (int i = 0; i < n_bytes; ++i) bits = bits << 8 | take();
    return bits;
}

std::size_t HeaderReader::checked_count(std::uint64_t count, std::size_t bytes_each) const {
    if (count > rest_.size() / bytes_each) {
        malformed("a list or map claims " + std::to_string(count) + " entries, but only " +
                  std::to_string(rest_.size()) + " bytes follow");
    }
    return static_cast<std::size_t>(count);
}

void HeaderReader::drop(std::uint64_t n_bytes) {
    if (n_bytes > rest_.size()) malformed("the header ends in the middle of a value");
    rest_ = rest_.subspan(static_cast<std::size_t>(n_bytes));
}

std::size_t HeaderReader::map_size() {
    const unsigned char marker = take();
    if ((marker & 0xf0) == 0x80) return checked_count(marker & 0x0f, 2);
    if (marker == 0xde) return checked_count(take_big_endian(2), 2);
    if (marker == 0xdf) return checked_count(take_big_endian(4), 2);
    unexpected("a map", marker);
}

std::size_t HeaderReader::array_size() {
    const unsigned char marker = take();
    if ((marker & 0xf0) == 0x90) return checked_count(marker & 0x0f, 1);
    if (marker == 0xdc) return checked_count(take_big_endian(2), 1);
    if (marker == 0xdd) return checked_count(take_big_endian(4), 1);
    unexpected("a list", marker);
}

std::string_view HeaderReader::text() {
    const unsigned char marker = take();
    std::uint64_t length = 0;
    if ((marker & 0xe0) == 0xa0)
        length = marker & 0x1f;
    else if (marker == 0xd9)
        length = take_big_endian(1);
    else if (marker == 0xda)
        length = take_big_endian(2);
    else if (marker == 0xdb)
        length = take_big_endian(4);
    else
        unexpected("a text", marker);
    const Bytes from = rest_;
    drop(length);
    return {reinterpret_cast<const char*>(from.data()), static_cast<std::size_t>(length)};
}

std::uint64_t HeaderReader::unsigned_integer() {
    const unsigned char marker = rest_.empty() ? 0 : static_cast<unsigned char>(rest_.front());
    if (marker == 0xcf) {
        take();
        return take_big_endian(8);
    }
    const std::int64_t signed_value = integer();
    if (signed_value < 0) {
        malformed("an integer >= 0 expected, but it is " + std::to_string(signed_value));
    }
    return static_cast<std::uint64_t>(signed_value);
}

std::int64_t HeaderReader::integer() {
    const unsigned char marker = take();
    if (marker < 0x80) return marker;
    if (marker >= 0xe0) return static_cast<std::int8_t>(marker);
    switch (marker) {
        case 0xcc:
            return static_cast<std::int64_t>(take_big_endian(1));
        case 0xcd:
            return static_cast<std::int64_t>(take_big_endian(2));
        case 0xce:
            return static_cast<std::int64_t>(take_big_endian(4));
        case 0xcf: {
            const std::uint64_t value = take_big_endian(8);
            if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
                malformed("an integer does not fit in 64 signed bits");
            }
            return static_cast<std::int64_t>(value);
        }
        case 0xd0:
            return static_cast<std::int8_t>(take_big_endian(1));
        case 0xd1:
            return static_cast<std::int16_t>(take_big_endian(2));
        case 0xd2:
            return static_cast<std::int32_t>(take_big_endian(4));
        case 0xd3:
            return static_cast<std::int64_t>(take_big_endian(8));
        default:
            unexpected("an integer", marker);
    }
}

double HeaderReader::number() {
    const unsigned char marker = rest_.empty() ? 0 : static_cast<unsigned char>(rest_.front());
    if (marker == 0xcb) {
        take();
        return std::bit_cast<double>(take_big_endian(8));
    }
    if (marker == 0xca) {
        take();
        return std::bit_cast<float>(static_cast<std::uint32_t>(take_big_endian(4)));
    }
    return static_cast<double>(integer());
}

void HeaderReader::value(std::uint32_t& into) {
    const std::uint64_t wide = unsigned_integer();
    if (wide > 0xffffffff) malformed("an integer does not fit in 32 bits");
    into = static_cast<std::uint32_t>(wide);
}

void HeaderReader::value(std::array<int, 2>& into) {
    if (array_size() != 2) malformed("a pair of integers expected");
    for (int& number : into) {
        const std::int64_t wide = integer();
        if (wide < 0 || wide > std::numeric_limits<int>::max()) {
            malformed("a version number is " + std::to_string(wide));
        }
        number = static_cast<int>(wide);
    }
}

void HeaderReader::value(std::vector<std::string>& into) {
    into.resize(array_size());
    for (std::string& text_of_list : into) text_of_list = text();
}

void HeaderReader::skip(int depth) {
    if (rest_.empty()) take();  // throws: the header ends here
    const auto marker = static_cast<unsigned char>(rest_.front());
    const bool is_array = (marker & 0xf0) == 0x90 || marker == 0xdc || marker == 0xdd;
    const bool is_map = (marker & 0xf0) == 0x80 || marker == 0xde || marker == 0xdf;
    if (is_array || is_map) {
        if (depth <= 0) malformed("the header is nested deeper than 4 levels");
        const std::size_t values = is_array ? array_size() : 2 * map_size();
        for (std::size_t i = 0; i < values; ++i) skip(depth - 1);
        return;
    }
    if ((marker & 0xe0) == 0xa0 || (marker >= 0xd9 && marker <= 0xdb)) {
        text();
        return;
    }
    take();
    if (marker < 0x80 || marker >= 0xe0 || marker == 0xc0 || marker == 0xc2 || marker == 0xc3) {
        return;  // small integers, nil, false, true
    }
    switch (marker) {
        case 0xc4:
            return drop(take_big_endian(1));  // bin
        case 0xc5:
            return drop(take_big_endian(2));
        case 0xc6:
            return drop(take_big_endian(4));
        case 0xcc:
        case 0xd0:
            return drop(1);
        case 0xcd:
        case 0xd1:
            return drop(2);
        case 0xca:
        case 0xce:
        case 0xd2:
            return drop(4);
        case 0xcb:
        case 0xcf:
        case 0xd3:
            return drop(8);
        default:
            unexpected("a value without extension types", marker);
    }
}

}  // namespace undertow::wire
