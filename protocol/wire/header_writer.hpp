#pragma once
// Writes the MessagePack header of a message: positive integers in their shortest form, doubles as
// float64, strings as str. That is the canonical form: the same message always gives the same
// bytes.

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace undertow::wire {

class HeaderWriter {
 public:
    /// Appends to `out`, whose capacity is reused from message to message.
    explicit HeaderWriter(std::string& out) : out_(out) {}

    void value(std::uint64_t number) {
        if (number < 0x80)
            byte(number);
        else if (number <= 0xff)
            big_endian<1>(0xcc, number);
        else if (number <= 0xffff)
            big_endian<2>(0xcd, number);
        else if (number <= 0xffffffff)
            big_endian<4>(0xce, number);
        else
            big_endian<8>(0xcf, number);
    }
    void value(std::uint32_t number) { value(std::uint64_t{number}); }
    void value(std::int64_t number) {
        const auto bits = static_cast<std::uint64_t>(number);
        if (number >= 0)
            value(bits);
        else if (number >= -32)
            byte(bits);
        else if (number >= -0x80)
            big_endian<1>(0xd0, bits);
        else if (number >= -0x8000)
            big_endian<2>(0xd1, bits);
        else if (number >= -0x80000000LL)
            big_endian<4>(0xd2, bits);
        else
            big_endian<8>(0xd3, bits);
    }
    void value(int number) { value(std::int64_t{number}); }
    void value(double number) { big_endian<8>(0xcb, std::bit_cast<std::uint64_t>(number)); }
    void value(std::string_view text) {
        if (text.size() < 32)
            byte(0xa0 | text.size());
        else if (text.size() <= 0xff)
            big_endian<1>(0xd9, text.size());
        else if (text.size() <= 0xffff)
            big_endian<2>(0xda, text.size());
        else
            big_endian<4>(0xdb, text.size());
        out_.append(text);
    }
    void value(const std::string& text) { value(std::string_view(text)); }
    void value(const char* text) { value(std::string_view(text)); }
    void value(const std::array<int, 2>& pair) {
        array_of(2);
        value(pair[0]);
        value(pair[1]);
    }
    void value(const std::vector<std::string>& texts) {
        array_of(texts.size());
        for (const std::string& text : texts) value(text);
    }
    void array_of(std::size_t count) {
        if (count < 16)
            byte(0x90 | count);
        else if (count <= 0xffff)
            big_endian<2>(0xdc, count);
        else
            big_endian<4>(0xdd, count);
    }

 private:
    void byte(std::uint64_t bits) { out_.push_back(static_cast<char>(bits & 0xff)); }
    template <int n_bytes>
    void big_endian(unsigned char marker, std::uint64_t bits) {
        byte(marker);
        for (int shift = 8 * (n_bytes - 1); shift >= 0; shift -= 8) byte(bits >> shift);
    }
    std::string& out_;
};

}  // namespace undertow::wire
