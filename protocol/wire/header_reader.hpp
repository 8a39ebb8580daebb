#pragma once
// Reads the MessagePack header of a message, strictly: a peer's bytes may be wrong in any way and
// must never cost more than the header's own length in memory or time. Every mistake is a PeerError
// E_MALFORMED. Nothing is allocated: strings are views into the frame.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace undertow::wire {

using Bytes = std::span<const std::byte>;

class HeaderReader {
 public:
    explicit HeaderReader(Bytes header) : rest_(header) {}

    bool at_end() const { return rest_.empty(); }

    /// Number of entries. Refused when the rest of the header is too short to hold them.
    std::size_t map_size();
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

    /// Skips one value of any kind but extension types. `depth`: levels it may still open.
    void skip(int depth);

 private:
    unsigned char take();
    std::uint64_t take_big_endian(int n_bytes);
    std::size_t checked_count(std::uint64_t count, std::size_t bytes_each) const;
    void drop(std::uint64_t n_bytes);
    Bytes rest_;
};

}  // namespace undertow::wire
