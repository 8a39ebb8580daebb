#pragma once
// Reads the MessagePack header of a message, strictly: a peer's bytes may be wrong in any way and
// must never cost more memory or time than in proportion to the header's length. The bytes
// become a flat list of values; HeaderReader takes from the list what the protocol expects.
// Every mistake is a PeerError E_MALFORMED. Texts are views into the frame.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wire/codec.hpp"

namespace undertow::wire {

/// One value of a header. A list's entries, or a map's keys and values in turn, follow it.
struct HeaderValue {
    enum class Kind : std::uint8_t { unsigned_integer, integer, number, text, list, map, other };
    Kind kind;  // other: nil, true, false, bin - legal in keys of later versions only
    union {
        std::uint64_t unsigned_integer;
        std::int64_t integer;
        double number;
        std::uint64_t count;  // of a list's or map's entries
    };
    std::string_view text;
};

/// The header's values, whole: every list and map has the entries it claims. Refuses extension
/// types, more than max_depth levels, and bytes after the first value. The result lives until the
/// thread's next call.
std::span<const HeaderValue> parse_header(Bytes header);

class HeaderReader {
 public:
    explicit HeaderReader(std::span<const HeaderValue> values) : rest_(values) {}

    std::size_t map_size();  // number of entries
    std::size_t array_size();

    std::string_view text();
    std::uint64_t unsigned_integer();
    std::int64_t integer();
    double number();  // float64, float32 or an integer; not yet checked to be finite

    void value(std::uint64_t& into) { into = unsigned_integer(); }
    void value(std::uint32_t& into);
    void value(std::int64_t& into) { into = integer(); }
    void value(double& into) { into = number(); }
    void value(std::string& into) { into = text(); }
    void value(std::array<int, 2>& into);
    void value(std::vector<std::string>& into);

    /// Skips one value of any kind.
    void skip();

 private:
    const HeaderValue& take();
    std::span<const HeaderValue> rest_;
};

}  // namespace undertow::wire
