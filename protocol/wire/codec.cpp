#include "wire/codec.hpp"

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "wire/errors.hpp"
#include "wire/header_writer.hpp"
#include "wire/layout.hpp"

namespace undertow::wire {

static_assert(std::endian::native == std::endian::little, "arrays travel as they lie in memory");

namespace {

template <class T>
constexpr const char* dtype_of() {
    if constexpr (std::same_as<T, double>) return "f8";
    if constexpr (std::same_as<T, std::int32_t>) return "i4";
    if constexpr (std::same_as<T, std::uint32_t>) return "u4";
    if constexpr (std::same_as<T, std::uint64_t>) return "u8";
}

/// Bytes per element, 0 for a dtype the protocol does not know.
std::size_t size_of_dtype(std::string_view dtype) {
    if (dtype == "f8" || dtype == "i8" || dtype == "u8") return 8;
    if (dtype == "f4" || dtype == "i4" || dtype == "u4") return 4;
    return 0;
}

template <class M>
constexpr MessageType type_of_struct() {
    if constexpr (std::same_as<M, Hello>) return MessageType::hello;
    if constexpr (std::same_as<M, Welcome>) return MessageType::welcome;
    if constexpr (std::same_as<M, Mesh>) return MessageType::mesh;
    if constexpr (std::same_as<M, MeshAck>) return MessageType::mesh_ack;
    if constexpr (std::same_as<M, Surface>) return MessageType::surface;
    if constexpr (std::same_as<M, Probe>) return MessageType::probe;
    if constexpr (std::same_as<M, Active>) return MessageType::active;
    if constexpr (std::same_as<M, State>) return MessageType::state;
    if constexpr (std::same_as<M, Force>) return MessageType::force;
    if constexpr (std::same_as<M, Checkpoint>) return MessageType::checkpoint;
    if constexpr (std::same_as<M, CheckpointAck>) return MessageType::checkpoint_ack;
    if constexpr (std::same_as<M, Finish>) return MessageType::finish;
    if constexpr (std::same_as<M, Bye>) return MessageType::bye;
    if constexpr (std::same_as<M, Error>) return MessageType::error;
    if constexpr (std::same_as<M, Progress>) return MessageType::progress;
}

// ------------------------------------------------------------------ writing

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

// ------------------------------------------------------------------ reading

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
    void array(const char*, const auto&, std::size_t) {}
};

/// Visitor of describe(): every key must have come, every number must be finite.
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
        reader.skip(max_depth - 1);
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
                    reader.skip(0);
                else
                    read_array_list(reader, list);
                continue;
            }
            KeyReader one{reader, key, seen};
            describe(one, m);
            if (!one.matched) reader.skip(max_depth - 1);  // a later minor version's key
        }
        if (!reader.at_end()) throw PeerError("E_MALFORMED", "bytes follow the header's map");
        if (!list.present) throw PeerError("E_MALFORMED", "key a (the list of arrays) is missing");
        KeyCheck keys{seen};
        describe(keys, std::as_const(m));
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

void decode(Bytes header, std::span<const Bytes> arrays, Message& message) {
    if (header.size() > max_header) {
        throw PeerError("E_MALFORMED", "a header of " + std::to_string(header.size()) +
                                           " bytes passes the limit of 64 kB");
    }
    const HeaderReader reader(header);
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

MessageType type_of(const Message& message) {
    return std::visit([]<class M>(const M&) { return type_of_struct<M>(); }, message);
}

const char* name_of(MessageType type) {
    switch (type) {
        case MessageType::hello:
            return "HELLO";
        case MessageType::welcome:
            return "WELCOME";
        case MessageType::mesh:
            return "MESH";
        case MessageType::mesh_ack:
            return "MESH_ACK";
        case MessageType::state:
            return "STATE";
        case MessageType::force:
            return "FORCE";
        case MessageType::checkpoint:
            return "CHECKPOINT";
        case MessageType::checkpoint_ack:
            return "CHECKPOINT_ACK";
        case MessageType::finish:
            return "FINISH";
        case MessageType::bye:
            return "BYE";
        case MessageType::error:
            return "ERROR";
        case MessageType::progress:
            return "PROGRESS";
        case MessageType::active:
            return "ACTIVE";
        case MessageType::probe:
            return "PROBE";
        case MessageType::surface:
            return "SURFACE";
    }
    return "?";
}

std::int64_t step_of(const Message& message) {
    return std::visit(
        [](const auto& m) -> std::int64_t {
            if constexpr (requires { m.n; }) return m.n;
            return 0;
        },
        message);
}

std::uint64_t session_of(const Message& message) {
    return std::visit(
        [](const auto& m) -> std::uint64_t {
            if constexpr (requires { m.session; }) return m.session;
            return 0;
        },
        message);
}

void set_session(Message& message, std::uint64_t session) {
    std::visit(
        [&](auto& m) {
            if constexpr (requires { m.session; }) m.session = session;
        },
        message);
}

std::string label(const Message& message) {
    const std::string name = name_of(type_of(message));
    const bool has_step = std::visit(
        [](const auto& m) {
            return requires {
                m.n;
            };
        },
        message);
    return has_step ? name + "(" + std::to_string(step_of(message)) + ")" : name;
}

std::string checksum(const Mesh& mesh) {
    std::uint64_t sum = 0xcbf29ce484222325;
    const auto add = [&](const auto& data) {
        for (const std::byte byte : std::as_bytes(std::span(data))) {
            sum = (sum ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
        }
    };
    add(mesh.x);
    add(mesh.mass);
    add(mesh.quad);
    add(mesh.group);
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(sum));
    return text;
}

}  // namespace undertow::wire
