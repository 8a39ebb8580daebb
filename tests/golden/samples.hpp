#pragma once
// One message of every type, and faults, with fixed numbers: the content of protocol_v1/*.hex.

#include <string>
#include <vector>

#include "wire/messages.hpp"

namespace undertow::wire {

using RawFrames = std::vector<std::string>;  // bytes of frame 0, 1, ...

struct Sample {
    std::string file;  // without ".hex"
    std::string comment;
    Message message;
};

struct Fault {
    std::string file;
    std::string comment;
    std::string code;  // E_ code that decoding must give
    RawFrames frames;
};

std::vector<Sample> golden_samples();
std::vector<Fault> golden_faults();

RawFrames raw_frames(const Message& message);  // encode()
Message decoded(const RawFrames& frames);      // decode()

/// The text of a .hex file: comment lines start with '#'; then one frame per line as hex digits,
/// an empty frame as '-'.
std::string to_hex(const RawFrames& frames);
RawFrames from_hex(const std::string& text);

}  // namespace undertow::wire
