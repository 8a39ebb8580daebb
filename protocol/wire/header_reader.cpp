#include "wire/header_reader.hpp"

#include <cassert>
#include <limits>
#include <msgpack/null_visitor.hpp>
#include <msgpack/unpack.hpp>  // parse.hpp does not stand alone

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

/// Collects what msgpack-c meets. Its strings are views, as nothing is copied; its base answers
/// what needs no answer here. A false result would only stop the parser, so mistakes are thrown.
class Collector : public msgpack::null_visitor {
 public:
    explicit Collector(std::vector<HeaderValue>& values) : values_(values) {}

    bool visit_nil() { return other(); }
    bool visit_boolean(bool) { return other(); }
    bool visit_bin(const char*, std::uint32_t) { return other(); }
    bool visit_ext(const char*, std::uint32_t) { malformed("extension types are not allowed"); }

    bool visit_positive_integer(std::uint64_t number) {
        add(Kind::unsigned_integer).unsigned_integer = number;
        return true;
    }
    bool visit_negative_integer(std::int64_t number) {
        add(Kind::integer).integer = number;
        return true;
    }
    bool visit_float32(float number) { return visit_float64(number); }
    bool visit_float64(double number) {
        add(Kind::number).number = number;
        return true;
    }
    bool visit_str(const char* text, std::uint32_t size) {
        add(Kind::text).text = {text, size};
        return true;
    }

    bool start_array(std::uint32_t count) { return open(Kind::list, count); }
    bool start_map(std::uint32_t count) { return open(Kind::map, count); }
    bool end_array() { return close(); }
    bool end_map() { return close(); }

    void parse_error(std::size_t, std::size_t place) {
        malformed("byte " + std::to_string(place) + " of the header is not MessagePack");
    }

 private:
    HeaderValue& add(Kind kind) { return values_.emplace_back(HeaderValue{kind, {}, {}}); }
    bool other() {
        add(Kind::other);
        return true;
    }
    bool open(Kind kind, std::uint32_t count) {
        if (++depth_ > max_depth) malformed("the header is nested deeper than 4 levels");
        add(kind).count = count;
        return true;
    }
    bool close() {
        --depth_;
        return true;
    }

    std::vector<HeaderValue>& values_;
    int depth_ = 0;
};

}  // namespace

std::span<const HeaderValue> parse_header(Bytes header) {
    thread_local std::vector<HeaderValue> values;  // keeps its capacity from message to message
    values.clear();
    Collector collector(values);
    std::size_t end = 0;
    if (!msgpack::parse(reinterpret_cast<const char*>(header.data()), header.size(), end,
                        collector)) {
        malformed("the header ends in the middle of a value");
    }
    if (end < header.size()) malformed("bytes follow the header's map");
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
