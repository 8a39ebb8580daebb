#include "wire/header_reader.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <limits>

#include "wire/errors.hpp"

namespace undertow::wire {

namespace {

using Kind = HeaderValue::Kind;

[[noreturn]] void malformed(const std::string& what) {
    throw PeerError("E_MALFORMED", what);
}

[[noreturn]] void unexpected(const char* wanted, const HeaderValue& value) {
    static constexpr const char* names[] = {"an integer", "an integer", "a number",     "a text",
                                            "a list",     "a map",      "another value"};
    malformed(std::string(wanted) + " expected, but " + names[static_cast<int>(value.kind)] +
              " came");
}

/// MessagePack -> flat list. By hand and not by msgpack-c, whose parser reserves memory on every call.
class Parser {
 public:
    Parser(Bytes header, std::vector<HeaderValue>& values)
        : first_(reinterpret_cast<const std::uint8_t*>(header.data())),
          next_(first_),
          end_(first_ + header.size()),
          values_(values) {}

    /// One value with all it holds.
    void parse() {
        std::uint64_t due = 1;  // values that the innermost open list or map still lacks
        for (;;) {
            while (due == 0) {
                if (depth_ == 0) return;
                due = outer_[--depth_];
            }
            --due;
            if (const std::uint64_t inside = value(); opened_) {
                if (depth_ == max_depth) malformed("the header is nested deeper than 4 levels");
                outer_[depth_++] = due;
                due = inside;
            }
        }
    }
    bool at_end() const { return next_ == end_; }

 private:
    /// Adds one value. Of a list or map: sets opened_ and returns the number of values inside.
    std::uint64_t value() {
        opened_ = false;
        const std::uint8_t mark = static_cast<std::uint8_t>(big_endian(1));
        if (mark <= 0x7f) return positive(mark);
        if (mark <= 0x8f) return open(Kind::map, mark & 0x0f);
        if (mark <= 0x9f) return open(Kind::list, mark & 0x0f);
        if (mark <= 0xbf) return text(mark & 0x1f);
        if (mark >= 0xe0) return negative(static_cast<std::int8_t>(mark));
        switch (mark) {
            case 0xc0: case 0xc2: case 0xc3: return other(0);             // nil, false, true
            case 0xc4: return other(big_endian(1));                       // bin 8, 16, 32
            case 0xc5: return other(big_endian(2));
            case 0xc6: return other(big_endian(4));
            case 0xca: return number(std::bit_cast<float>(std::uint32_t(big_endian(4))));
            case 0xcb: return number(std::bit_cast<double>(big_endian(8)));
            case 0xcc: return positive(big_endian(1));
            case 0xcd: return positive(big_endian(2));
            case 0xce: return positive(big_endian(4));
            case 0xcf: return positive(big_endian(8));
            case 0xd0: return negative(static_cast<std::int8_t>(big_endian(1)));
            case 0xd1: return negative(static_cast<std::int16_t>(big_endian(2)));
            case 0xd2: return negative(static_cast<std::int32_t>(big_endian(4)));
            case 0xd3: return negative(static_cast<std::int64_t>(big_endian(8)));
            case 0xd9: return text(big_endian(1));
            case 0xda: return text(big_endian(2));
            case 0xdb: return text(big_endian(4));
            case 0xdc: return open(Kind::list, big_endian(2));
            case 0xdd: return open(Kind::list, big_endian(4));
            case 0xde: return open(Kind::map, big_endian(2));
            case 0xdf: return open(Kind::map, big_endian(4));
            case 0xc1:
                malformed("byte " + std::to_string(next_ - first_ - 1) +
                          " of the header is not MessagePack");
        }
        malformed("extension types are not allowed");  // 0xc7 - 0xc9, 0xd4 - 0xd8
    }

    std::uint64_t big_endian(std::size_t n_bytes) {
        const std::uint8_t* bytes = take(n_bytes);
        std::uint64_t number = 0;
        for (std::size_t i = 0; i < n_bytes; ++i) number = number << 8 | bytes[i];
        return number;
    }
    const std::uint8_t* take(std::uint64_t n_bytes) {
        if (n_bytes > std::uint64_t(end_ - next_))
            malformed("the header ends in the middle of a value");
        next_ += n_bytes;
        return next_ - n_bytes;
    }

    HeaderValue& add(Kind kind) { return values_.emplace_back(HeaderValue{kind, {}, {}}); }
    std::uint64_t positive(std::uint64_t number) {
        add(Kind::unsigned_integer).unsigned_integer = number;
        return 0;
    }
    std::uint64_t negative(std::int64_t number) {  // or a positive one that a peer wrote as signed
        add(Kind::integer).integer = number;
        return 0;
    }
    std::uint64_t number(double value) {
        add(Kind::number).number = value;
        return 0;
    }
    std::uint64_t text(std::uint64_t size) {
        const auto* bytes = reinterpret_cast<const char*>(take(size));
        add(Kind::text).text = {bytes, std::size_t(size)};
        return 0;
    }
    std::uint64_t other(std::uint64_t size) {
        take(size);
        add(Kind::other);
        return 0;
    }
    std::uint64_t open(Kind kind, std::uint64_t count) {
        opened_ = true;
        add(kind).count = count;
        return kind == Kind::map ? 2 * count : count;
    }

    const std::uint8_t *first_, *next_, *end_;
    std::vector<HeaderValue>& values_;
    std::array<std::uint64_t, max_depth> outer_;  // what the open lists and maps around still lack
    int depth_ = 0;
    bool opened_ = false;
};

}  // namespace

std::span<const HeaderValue> parse_header(Bytes header) {
    thread_local std::vector<HeaderValue> values;  // keeps its capacity from message to message
    values.clear();
    Parser parser(header, values);
    parser.parse();
    if (!parser.at_end()) malformed("bytes follow the header's map");
    return values;
}

const HeaderValue& HeaderReader::take() {
    assert(!rest_.empty());  // parse_header() saw to it that nothing is missing
    const HeaderValue& value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
}

std::size_t HeaderReader::map_size() {
    const HeaderValue& value = take();
    if (value.kind != Kind::map) unexpected("a map", value);
    return value.count;
}

std::size_t HeaderReader::array_size() {
    const HeaderValue& value = take();
    if (value.kind != Kind::list) unexpected("a list", value);
    return value.count;
}

std::string_view HeaderReader::text() {
    const HeaderValue& value = take();
    if (value.kind != Kind::text) unexpected("a text", value);
    return value.text;
}

std::uint64_t HeaderReader::unsigned_integer() {
    const HeaderValue& value = take();
    if (value.kind == Kind::unsigned_integer) return value.unsigned_integer;
    if (value.kind != Kind::integer) unexpected("an integer", value);
    if (value.integer < 0) {  // an int8 to int64 may still hold a positive number
        malformed("an integer >= 0 expected, but it is " + std::to_string(value.integer));
    }
    return static_cast<std::uint64_t>(value.integer);
}

std::int64_t HeaderReader::integer() {
    const HeaderValue& value = take();
    if (value.kind == Kind::integer) return value.integer;
    if (value.kind != Kind::unsigned_integer) unexpected("an integer", value);
    if (value.unsigned_integer > std::uint64_t(std::numeric_limits<std::int64_t>::max())) {
        malformed("an integer does not fit in 64 signed bits");
    }
    return static_cast<std::int64_t>(value.unsigned_integer);
}

double HeaderReader::number() {
    if (!rest_.empty() && rest_.front().kind == Kind::number) return take().number;
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

void HeaderReader::skip() {
    for (std::size_t due = 1; due > 0; --due) {
        const HeaderValue& value = take();
        if (value.kind == Kind::list) due += value.count;
        if (value.kind == Kind::map) due += 2 * value.count;
    }
}

}  // namespace undertow::wire
