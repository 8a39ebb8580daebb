#include "wire/recording.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include "wire/errors.hpp"
#include "wire/header_reader.hpp"

namespace undertow::wire {

namespace {

constexpr std::array<char, 8> magic{'U', 'T', 'O', 'W', 'r', 'e', 'c', '1'};
constexpr std::uint64_t multiplier = 0x9e3779b97f4a7c15;

void blank(std::string& header, std::string_view key, std::size_t bytes, char with) {
    const std::size_t at = header.find(key);
    if (at != std::string::npos && at + key.size() + bytes <= header.size())
        std::fill_n(header.begin() + std::ptrdiff_t(at + key.size()), bytes, with);
}

/// The key `wait` follows the clock, and so does the sum of a checkpoint's file, which holds times:
/// zero in a recording. Headers are canonical, so they stand there as the key's text and a float64,
/// or a text of 64 characters.
void forget_the_clock(std::string& header) {
    blank(header, "\xa4wait\xcb", 8, '\0');
    blank(header, "\xa3sha\xd9\x40", 64, '0');
}

/// Value of the key `m`, which is the first one in the canonical form.
MessageType type_of_header(const std::string& header) {
    HeaderReader reader(parse_header(std::as_bytes(std::span(header))));
    if (reader.map_size() == 0 || reader.text() != "m")
        throw PeerError("E_MALFORMED", "the recording is damaged");
    return static_cast<MessageType>(reader.unsigned_integer());
}

}  // namespace

std::uint64_t fingerprint(const Frames& frames) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < frames.n_arrays; ++i) {
        const Bytes data = frames.arrays[i];
        for (std::size_t at = 0; at < data.size(); at += 8) {
            std::uint64_t word = 0;
            std::memcpy(&word, data.data() + at, std::min<std::size_t>(8, data.size() - at));
            sum = sum * multiplier + word;
        }
    }
    return sum;
}

std::string recording_of(const std::string& folder, const std::string& participant) {
    return folder + "/recording." + participant + ".utow";
}

// -------------------------------------------------------------------- writing

RecordingWriter::RecordingWriter(const std::string& path)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc) {
    put(magic.data(), magic.size());
}

void RecordingWriter::put(const void* data, std::size_t bytes) {
    if (bytes > 0) file_.write(static_cast<const char*>(data), std::streamsize(bytes));
    if (!file_)
        throw FileError("cannot write the recording " + path_ +
                        "; free some space, or leave out --record.");
}

void RecordingWriter::add(Said who, const Message& message) {
    if (std::holds_alternative<Progress>(message)) return;
    encode(message, frames_);
    forget_the_clock(frames_.header);
    const std::uint64_t sum = fingerprint(frames_);
    std::size_t n_arrays = frames_.n_arrays;
    if (who == Said::by_participant) {
        n_arrays = 1;
        frames_.arrays[0] = std::as_bytes(std::span(&sum, 1));
    }
    const std::uint32_t head[2] = {std::uint32_t(who), std::uint32_t(frames_.header.size())};
    put(head, sizeof head);
    const std::uint64_t count = n_arrays;
    put(&count, sizeof count);
    for (std::size_t i = 0; i < n_arrays; ++i) {
        const std::uint64_t size = frames_.arrays[i].size();
        put(&size, sizeof size);
    }
    put(frames_.header.data(), frames_.header.size());
    for (std::size_t i = 0; i < n_arrays; ++i)
        put(frames_.arrays[i].data(), frames_.arrays[i].size());
    if (std::holds_alternative<Finish>(message) || std::holds_alternative<Bye>(message) ||
        std::holds_alternative<Error>(message) || std::holds_alternative<CheckpointAck>(message))
        file_.flush();
}

// -------------------------------------------------------------------- reading

RecordingReader::RecordingReader(const std::string& path)
    : path_(path), file_(path, std::ios::binary) {
    if (!file_) throw InputError("the recording " + path + " cannot be opened.");
    std::array<char, 8> first{};
    file_.read(first.data(), first.size());
    if (first != magic) throw InputError(path + " is no recording: make one with --record.");
    read_head();
}

void RecordingReader::read(void* into, std::size_t bytes) {
    if (bytes > 0) file_.read(static_cast<char*>(into), std::streamsize(bytes));
    if (!file_)
        throw PeerError("E_IO", "the recording " + path_ + " ends in the middle of a message");
}

/// Who speaks next, and the sizes of what comes.
void RecordingReader::read_head() {
    at_end_ = file_.peek() == std::ifstream::traits_type::eof();
    if (at_end_) return;
    std::uint32_t head[2];
    std::uint64_t count = 0;
    read(head, sizeof head);
    read(&count, sizeof count);
    if (head[0] > 1 || head[1] > max_header || count > max_arrays)
        throw PeerError("E_MALFORMED", "the recording " + path_ + " is damaged");
    speaker_ = Said(head[0]);
    header_.resize(head[1]);
    sizes_.resize(count);
    for (std::uint64_t& size : sizes_) read(&size, sizeof size);
}

void RecordingReader::take(Message& message) {
    read(header_.data(), header_.size());
    arrays_.resize(std::max(arrays_.size(), sizes_.size()));
    std::array<Bytes, max_arrays> views;
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
        // A damaged size must not become a request for memory that nobody has.
        if (sizes_[i] > std::uint64_t{1} << 32)
            throw PeerError("E_MALFORMED", "the recording " + path_ + " is damaged");
        arrays_[i].resize(sizes_[i]);
        read(arrays_[i].data(), arrays_[i].size());
        views[i] = arrays_[i];
    }
    const std::size_t n_arrays = sizes_.size();
    decode(std::as_bytes(std::span(header_)), std::span(views.data(), n_arrays), message);
    read_head();
}

bool RecordingReader::compare(const Message& message) {
    if (at_end_ || speaker_ != Said::by_participant)
        throw PeerError("E_STATE", label(message) + " is not in the recording " + path_ +
                                       (at_end_ ? ", which has ended" : ": the coupler is next"));
    std::uint64_t sum = 0;
    read(header_.data(), header_.size());
    if (sizes_.size() != 1 || sizes_[0] != sizeof sum)
        throw PeerError("E_MALFORMED", "the recording " + path_ + " is damaged");
    read(&sum, sizeof sum);
    encode(message, frames_);
    forget_the_clock(frames_.header);
    const MessageType recorded = type_of_header(header_);
    if (recorded != type_of(message))
        throw PeerError("E_STATE", label(message) + " came where the recording " + path_ + " has " +
                                       name_of(recorded));
    // A HELLO names the program's version and what its endpoint offers.
    const bool same = recorded == MessageType::hello ||
                      (frames_.header == header_ && fingerprint(frames_) == sum);
    read_head();
    return same;
}

}  // namespace undertow::wire
