#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "wire/codec.hpp"
#include "wire/errors.hpp"
#include "wire/header_reader.hpp"
#include "wire/layout.hpp"

namespace undertow::wire {

namespace {

/// Bytes per element, 0 for a dtype the protocol does not know.
std::size_t size_of_dtype(std::string_view dtype) {
    if (dtype == "f8" || dtype == "i8" || dtype == "u8") return 8;
    if (dtype == "f4" || dtype == "i4" || dtype == "u4") return 4;
    return 0;
}

/// One entry of "a", as the peer wrote it.
struct ArrayEntry {
    std::string_view name, dtype;
    std::array<std::uint64_t, max_depth> shape;
    std::size_t n_dims;
    Bytes bytes;
};

struct ArrayList {
    std::array<ArrayEntry, max_arrays> entries;
    std::size_t count = 0;
    bool present = false;
};

void read_array_list(HeaderReader& reader, ArrayList& list) {
    list.present = true;
    list.count = reader.array_size();
    if (list.count > max_arrays) {
        throw PeerError("E_MALFORMED", "it lists " + std::to_string(list.count) +
                                           " arrays; at most 16 are allowed");
    }
    for (std::size_t i = 0; i < list.count; ++i) {
        ArrayEntry& entry = list.entries[i];
        if (reader.array_size() != 3) {
            throw PeerError("E_MALFORMED", "an entry of \"a\" is not [name, dtype, shape]");
        }
        entry.name = reader.text();
        entry.dtype = reader.text();
        entry.n_dims = reader.array_size();
        if (entry.n_dims > entry.shape.size()) {
            throw PeerError("E_MALFORMED", "an array has more than 4 dimensions");
        }
        for (std::size_t d = 0; d < entry.n_dims; ++d) entry.shape[d] = reader.unsigned_integer();
    }
}

/// Joins the list with the frames that came: as many as listed, each of the listed size.
void bind_frames(ArrayList& list, std::span<const Bytes> frames) {
    if (frames.size() != list.count) {
        throw PeerError("E_SHAPE", "it lists " + std::to_string(list.count) + " arrays but " +
                                       std::to_string(frames.size()) + " frames came");
    }
    for (std::size_t i = 0; i < list.count; ++i) {
        ArrayEntry& entry = list.entries[i];
        const std::size_t size = size_of_dtype(entry.dtype);
        if (size == 0) {
            throw PeerError("E_SHAPE", "array " + std::string(entry.name) +
                                           " has the unknown dtype '" + std::string(entry.dtype) +
                                           "'; known: f8 f4 i4 u4 i8 u8");
        }
        unsigned __int128 bytes = size;
        for (std::size_t d = 0; d < entry.n_dims; ++d) {
            bytes *= entry.shape[d];
            if (bytes >> 64 != 0) break;  // larger than any frame; also ends before an overflow
        }
        if (bytes != frames[i].size()) {
            throw PeerError("E_SHAPE", "the frame of array " + std::string(entry.name) + " has " +
                                           std::to_string(frames[i].size()) +
                                           " bytes, which its shape and dtype do not give");
        }
        entry.bytes = frames[i];
    }
}

/// Visitor of describe(): reads the value of one key into the member of that name.
struct KeyReader {
    HeaderReader& reader;
    std::string_view wanted;
    std::uint32_t& seen;  // bit i: the i-th key of the layout has come
    bool matched = false;
    unsigned index = 0;

    void key(const char* name, auto& member) {
        const std::uint32_t bit = 1u << index++;
        if (matched || wanted != name) return;
        matched = true;
        if (seen & bit) throw PeerError("E_MALFORMED", std::string("key ") + name + " comes twice");
        seen |= bit;
        try {
            reader.value(member);
        } catch (const PeerError& error) {
            throw PeerError(error.code, std::string("key ") + name + ": " + error.what());
        }
    }
    void optional(const char* name, auto& member) { key(name, member); }
    void array(const char*, const auto&, std::size_t) {}
};

/// Visitor of describe(): every key must have come, every number must be finite. What is optional
/// and has not come is emptied: the message may have been used before.
struct KeyCheck {
    std::uint32_t seen;
    unsigned index = 0;

    void key(const char* name, const auto& member) {
        if (!(seen & 1u << index++)) {
            throw PeerError("E_MALFORMED", std::string("key ") + name + " is missing");
        }
        if constexpr (std::is_same_v<decltype(member), const double&>) {
            if (!std::isfinite(member)) {
                throw PeerError("E_NONFINITE",
                                std::string("key ") + name + " is " + std::to_string(member));
            }
        }
    }
    void optional(const char*, auto& member) {
        if (!(seen & 1u << index++)) member.clear();
    }
    void array(const char*, const auto&, std::size_t) {}
};

/// Index of the first NaN or infinity, or size. The scan has no branch per number, so it runs at
/// memory speed; the second pass runs only when there is something to name.
std::size_t first_nonfinite(const std::vector<double>& data) {
    constexpr std::uint64_t exponent = 0x7ff0000000000000;
    std::uint64_t bad = 0;
    for (const double value : data) {
        bad |= (std::bit_cast<std::uint64_t>(value) & exponent) == exponent;
    }
    if (bad == 0) return data.size();
    std::size_t i = 0;
    while (std::isfinite(data[i])) ++i;
    return i;
}

/// Visitor of describe(): copies the frames into the vectors.
struct ArrayReader {
    const ArrayList& list;

    void key(const char*, const auto&) {}
    void optional(const char*, const auto&) {}

    template <class T>
    void array(const char* name, std::vector<T>& data, std::size_t columns) {
        const ArrayEntry& entry = find(name);
        if (entry.dtype != dtype_of<T>()) {
            throw PeerError("E_SHAPE", std::string("array ") + name + " has dtype " +
                                           std::string(entry.dtype) + ", expected " +
                                           dtype_of<T>());
        }
        const bool fits =
            columns == 1 ? entry.n_dims == 1 : entry.n_dims == 2 && entry.shape[1] == columns;
        if (!fits) {
            throw PeerError("E_SHAPE",
                            std::string("array ") + name + " must have the shape (N" +
                                (columns == 1 ? ")" : ", " + std::to_string(columns) + ")"));
        }
        data.resize(entry.bytes.size() / sizeof(T));
        if (!data.empty()) std::memcpy(data.data(), entry.bytes.data(), entry.bytes.size());
        if constexpr (std::same_as<T, double>) {
            const std::size_t i = first_nonfinite(data);
            if (i < data.size()) {
                throw PeerError("E_NONFINITE",
                                std::string(name) + "[" + std::to_string(i / columns) +
                                    (columns == 1 ? "" : ", " + std::to_string(i % columns)) +
                                    "] is " + std::to_string(data[i]));
            }
        }
    }

    const ArrayEntry& find(std::string_view name) const {
        const ArrayEntry* found = nullptr;
        for (std::size_t i = 0; i < list.count; ++i) {
            if (list.entries[i].name != name) continue;
            if (found)
                throw PeerError("E_MALFORMED", "array " + std::string(name) + " comes twice");
            found = &list.entries[i];
        }
        if (!found) throw PeerError("E_MALFORMED", "array " + std::string(name) + " is missing");
        return *found;
    }
};

void same_rows(const char* first, std::size_t n_first, const char* second, std::size_t n_second) {
    if (n_first == n_second) return;
    throw PeerError("E_SHAPE", std::string(first) + " has " + std::to_string(n_first) +
                                   " rows, but " + second + " has " + std::to_string(n_second));
}

// Arrays of one message that run over the same rows.
void check_rows(const auto&) {}
void check_rows(const State& m) {
    same_rows("x", m.x.size() / 3, "v", m.v.size() / 3);
}
void check_rows(const Mesh& m) {
    same_rows("x", m.x.size() / 3, "mass", m.mass.size());
    same_rows("quad", m.quad.size() / 4, "group", m.group.size());
}
void check_rows(const Probe& m) {
    same_rows("id", m.id.size(), "x", m.x.size() / 3);
    same_rows("id", m.id.size(), "v", m.v.size() / 3);
    same_rows("id", m.id.size(), "mass", m.mass.size());
    same_rows("id", m.id.size(), "r", m.radius.size());
    same_rows("id", m.id.size(), "k", m.stiffness.size());
    same_rows("id", m.id.size(), "phase", m.phase.size());
}

/// The type stands anywhere in the map, so that a peer's library may order keys as it likes.
std::uint64_t find_type(HeaderReader reader) {
    const std::size_t n_keys = reader.map_size();
    for (std::size_t i = 0; i < n_keys; ++i) {
        if (reader.text() == "m") return reader.unsigned_integer();
        reader.skip();
    }
    throw PeerError("E_MALFORMED", "key m (the message type) is missing");
}

template <class M>
void decode_struct(HeaderReader reader, std::span<const Bytes> frames, Message& message) {
    if (!std::holds_alternative<M>(message)) message.emplace<M>();
    M& m = std::get<M>(message);
    ArrayList list;
    std::uint32_t seen = 0;
    try {
        bool type_seen = false;
        const std::size_t n_keys = reader.map_size();
        for (std::size_t i = 0; i < n_keys; ++i) {
            const std::string_view key = reader.text();
            if (key == "m" || key == "a") {
                bool& before = key == "m" ? type_seen : list.present;
                if (before) {
                    throw PeerError("E_MALFORMED", "key " + std::string(key) + " comes twice");
                }
                before = true;
                if (key == "m")
                    reader.skip();
                else
                    read_array_list(reader, list);
                continue;
            }
            KeyReader one{reader, key, seen};
            describe(one, m);
            if (!one.matched) reader.skip();  // a later minor version's key
        }
        if (!list.present) throw PeerError("E_MALFORMED", "key a (the list of arrays) is missing");
        KeyCheck keys{seen};
        describe(keys, m);
        bind_frames(list, frames);
        ArrayReader arrays{list};
        describe(arrays, m);
        check_rows(m);
    } catch (const PeerError& error) {
        std::string where = name_of(type_of_struct<M>());
        if (seen & 2u) where = label(message);  // the step number, second key where there is one
        throw PeerError(error.code, where + ": " + error.what());
    }
}

}  // namespace

void decode(Bytes header, std::span<const Bytes> arrays, Message& message) {
    if (header.size() > max_header) {
        throw PeerError("E_MALFORMED", "a header of " + std::to_string(header.size()) +
                                           " bytes passes the limit of 64 kB");
    }
    const HeaderReader reader(parse_header(header));
    const std::uint64_t type = find_type(reader);
    switch (static_cast<MessageType>(type > 0xff ? 0 : type)) {
        case MessageType::hello:
            return decode_struct<Hello>(reader, arrays, message);
        case MessageType::welcome:
            return decode_struct<Welcome>(reader, arrays, message);
        case MessageType::mesh:
            return decode_struct<Mesh>(reader, arrays, message);
        case MessageType::mesh_ack:
            return decode_struct<MeshAck>(reader, arrays, message);
        case MessageType::surface:
            return decode_struct<Surface>(reader, arrays, message);
        case MessageType::probe:
            return decode_struct<Probe>(reader, arrays, message);
        case MessageType::active:
            return decode_struct<Active>(reader, arrays, message);
        case MessageType::state:
            return decode_struct<State>(reader, arrays, message);
        case MessageType::force:
            return decode_struct<Force>(reader, arrays, message);
        case MessageType::checkpoint:
            return decode_struct<Checkpoint>(reader, arrays, message);
        case MessageType::checkpoint_ack:
            return decode_struct<CheckpointAck>(reader, arrays, message);
        case MessageType::finish:
            return decode_struct<Finish>(reader, arrays, message);
        case MessageType::bye:
            return decode_struct<Bye>(reader, arrays, message);
        case MessageType::error:
            return decode_struct<Error>(reader, arrays, message);
        case MessageType::progress:
            return decode_struct<Progress>(reader, arrays, message);
    }
    throw PeerError("E_MALFORMED", "the message type m = " + std::to_string(type) + " is unknown");
}

}  // namespace undertow::wire
