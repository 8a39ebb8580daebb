#pragma once
// A recorded session: what a participant and the coupler said to each other, in a file. Played
// back, it stands in for the coupler and for the other participant, so that a program can be run
// again without them: to measure it, to debug it, to see whether it still says the same.
//
//     file      8 bytes "UTOWrec1", then records until its end
//     record    u4 direction (0: coupler to participant, 1: participant to coupler)
//               u4 bytes of the header, u8 number of arrays, u8 bytes of each array, the header,
//               the arrays one after the other
//
// Little-endian. Of what the participant said only the header stands there whole, and in place of
// its arrays one of 8 bytes, their fingerprint(). What follows the clock is left out: PROGRESS, the
// key `wait`, which is 0, and the sum of a checkpoint's file, `sha`, whose digits are 0.

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "wire/codec.hpp"

namespace undertow::wire {

inline constexpr const char* replay_prefix = "replay://";

/// Horner's rule over the arrays as 64-bit words, each array filled up with zero bytes, modulo
/// 2^64: h <- h P + w, P = 0x9e3779b97f4a7c15. Differs whenever exactly one word does.
std::uint64_t fingerprint(const Frames& frames);

/// "FOLDER/recording.NAME.utow"
std::string recording_of(const std::string& folder, const std::string& participant);

enum class Said : std::uint32_t { by_coupler = 0, by_participant = 1 };

class RecordingWriter {
 public:
    /// Throws FileError when the file cannot be made.
    explicit RecordingWriter(const std::string& path);
    /// Throws FileError when the disk does not take it.
    void add(Said who, const Message& message);

 private:
    void put(const void* data, std::size_t bytes);
    std::string path_;
    std::ofstream file_;
    Frames frames_;  // reused
};

class RecordingReader {
 public:
    /// Throws InputError when there is no such file, or when it is none of ours.
    explicit RecordingReader(const std::string& path);

    bool at_end() const { return at_end_; }
    Said next_speaker() const { return speaker_; }
    /// The coupler's next message. Throws PeerError like decode(), E_IO when the file is cut off.
    void take(Message& message);
    /// Compares the participant's next message with what it says now; true when they are the same
    /// in every bit (of a HELLO only that it is one). Throws PeerError E_STATE when a
    /// message of another type, or the coupler's, is next.
    bool compare(const Message& message);

 private:
    void read_head();
    void read(void* into, std::size_t bytes);
    std::string path_;
    std::ifstream file_;
    bool at_end_ = false;
    Said speaker_ = Said::by_participant;
    std::vector<std::uint64_t> sizes_;
    std::string header_;
    std::vector<std::vector<std::byte>> arrays_;
    Frames frames_;  // of what the participant says now
};

}  // namespace undertow::wire
