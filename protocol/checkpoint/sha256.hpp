#pragma once
// SHA-256, so that a damaged file is noticed before a run goes on from it.   [FIPS 180-4]

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "checkpoint/pulse.hpp"

namespace undertow {

class Sha256 {
 public:
    void add(std::string_view bytes);
    /// 64 hex digits of all that was added; nothing may be added afterwards.
    std::string hex();

 private:
    void block(const unsigned char* bytes);

    std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<unsigned char, 64> rest_{};
    std::size_t rest_size_ = 0;
    std::uint64_t length_ = 0;  // [byte]
};

/// Throws std::runtime_error (E_IO) when the file cannot be read.
std::string sha256_of_file(const std::string& path, const Pulse& pulse = {});

}  // namespace undertow
