#include <bit>
#include <stdexcept>

#include "wire/codec.hpp"
#include "wire/header_writer.hpp"
#include "wire/layout.hpp"

namespace undertow::wire {

static_assert(std::endian::native == std::endian::little, "arrays travel as they lie in memory");

namespace {

/// Visitor of describe(): writes keys at once and collects the arrays for "a".
class Encoder {
 public:
    Encoder(Frames& frames, MessageType type) : frames_(frames), writer_(frames.header) {
        frames_.header.assign(1, '\x80');  // a map; its size is filled in by finish()
        frames_.n_arrays = 0;
        key("m", std::uint64_t(type));
    }

    void key(const char* name, const auto& value) {
        writer_.value(name);
        writer_.value(value);
        ++n_keys_;
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
        writer_.value("a");
        ++n_keys_;
        writer_.array_of(frames_.n_arrays);
        for (std::size_t i = 0; i < frames_.n_arrays; ++i) {
            writer_.array_of(3);
            writer_.value(entries_[i].name);
            writer_.value(entries_[i].dtype);
            writer_.array_of(entries_[i].columns == 1 ? 1 : 2);
            writer_.value(std::uint64_t(entries_[i].rows));
            if (entries_[i].columns != 1) writer_.value(std::uint64_t(entries_[i].columns));
        }
        if (n_keys_ > 15) throw std::logic_error("a header holds 15 keys at most");
        frames_.header[0] = static_cast<char>(0x80 | n_keys_);
        if (frames_.header.size() > max_header) {
            throw std::logic_error("a header of " + std::to_string(frames_.header.size()) +
                                   " bytes passes the limit of 64 kB");
        }
    }

 private:
    struct Entry {
        const char* name;
        const char* dtype;
        std::size_t rows, columns;
    };
    Frames& frames_;
    HeaderWriter writer_;
    std::array<Entry, max_arrays> entries_;
    unsigned n_keys_ = 0;
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
            Encoder encoder(frames, type_of_struct<M>());
            describe(encoder, m);
            encoder.finish();
        },
        message);
}

}  // namespace undertow::wire
