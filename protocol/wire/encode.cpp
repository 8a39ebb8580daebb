#include <bit>
#include <msgpack/pack.hpp>
#include <stdexcept>

#include "wire/codec.hpp"
#include "wire/layout.hpp"

namespace undertow::wire {

static_assert(std::endian::native == std::endian::little, "arrays travel as they lie in memory");

namespace {

/// Where msgpack-c writes: the end of a text whose capacity is reused from message to message.
struct Appender {
    std::string& out;
    void write(const char* bytes, std::size_t n_bytes) { out.append(bytes, n_bytes); }
};

/// Packs in the canonical form, in which a message always gives the same bytes: integers in their
/// shortest form, doubles as float64, strings as str.
class HeaderWriter {
 public:
    explicit HeaderWriter(std::string& out) : out_(out), appender_{out}, packer_(appender_) {}

    void value(std::uint64_t number) { packer_.pack_uint64(number); }
    void value(std::int64_t number) { packer_.pack_int64(number); }
    void value(std::uint32_t number) { packer_.pack_uint32(number); }
    void value(double number) {
        // pack_double() would shorten whole numbers to integers. A float64 is laid out as a
        // uint64 of full width behind another marker.
        packer_.pack_fix_uint64(std::bit_cast<std::uint64_t>(number));
        out_[out_.size() - 9] = '\xcb';
    }
    void value(std::string_view text) {
        const auto size = static_cast<std::uint32_t>(text.size());  // a header has 64 kB at most
        packer_.pack_str(size);
        packer_.pack_str_body(text.data(), size);
    }
    void value(const std::array<int, 2>& pair) {
        array_of(2);
        for (const int number : pair) packer_.pack_int(number);
    }
    void value(const std::vector<std::string>& texts) {
        array_of(texts.size());
        for (const std::string& text : texts) value(text);
    }
    void array_of(std::size_t count) { packer_.pack_array(static_cast<std::uint32_t>(count)); }
    void map_of(std::size_t count) { packer_.pack_map(static_cast<std::uint32_t>(count)); }

 private:
    std::string& out_;
    Appender appender_;
    msgpack::packer<Appender> packer_;
};

/// Visitor of describe(): how many keys a message has.
struct KeyCount {
    std::size_t n_keys = 0;
    void key(const char*, const auto&) { ++n_keys; }
    void optional(const char*, const auto& value) { n_keys += !value.empty(); }
    void array(const char*, const auto&, std::size_t) {}
};

/// Visitor of describe(): writes keys at once and collects the arrays for "a".
class Encoder {
 public:
    Encoder(Frames& frames, MessageType type, std::size_t n_keys)
        : frames_(frames), writer_(frames.header) {
        frames_.header.clear();
        frames_.n_arrays = 0;
        writer_.map_of(n_keys + 2);  // "m" and "a" beside the message's own
        key("m", std::uint64_t(type));
    }

    void key(const char* name, const auto& value) {
        writer_.value(std::string_view(name));
        writer_.value(value);
    }

    void optional(const char* name, const auto& value) {
        if (!value.empty()) key(name, value);
    }

    template <class T>
    void array(const char* name, const std::vector<T>& data, std::size_t columns) {
        if (data.size() % columns != 0) {
            throw std::logic_error(std::string("array ") + name + " has " +
                                   std::to_string(data.size()) + " numbers, not a multiple of " +
                                   std::to_string(columns));
        }
        entries_[frames_.n_arrays] = {name, dtype_of<T>(), data.size() / columns, columns};
        frames_.arrays[frames_.n_arrays++] = std::as_bytes(std::span(data));
    }

    void finish() {
        writer_.value(std::string_view("a"));
        writer_.array_of(frames_.n_arrays);
        for (std::size_t i = 0; i < frames_.n_arrays; ++i) {
            writer_.array_of(3);
            writer_.value(entries_[i].name);
            writer_.value(entries_[i].dtype);
            writer_.array_of(entries_[i].columns == 1 ? 1 : 2);
            writer_.value(std::uint64_t(entries_[i].rows));
            if (entries_[i].columns != 1) writer_.value(std::uint64_t(entries_[i].columns));
        }
        if (frames_.header.size() > max_header) {
            throw std::logic_error("a header of " + std::to_string(frames_.header.size()) +
                                   " bytes passes the limit of 64 kB");
        }
    }

 private:
    struct Entry {
        std::string_view name, dtype;
        std::size_t rows, columns;
    };
    Frames& frames_;
    HeaderWriter writer_;
    std::array<Entry, max_arrays> entries_;
};

}  // namespace

std::size_t Frames::array_bytes() const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < n_arrays; ++i) sum += arrays[i].size();
    return sum;
}

void encode(const Message& message, Frames& frames) {
    std::visit(
        [&]<class M>(const M& m) {
            KeyCount count;
            describe(count, m);
            Encoder encoder(frames, type_of_struct<M>(), count.n_keys);
            describe(encoder, m);
            encoder.finish();
        },
        message);
}

}  // namespace undertow::wire
