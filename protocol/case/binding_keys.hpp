#pragma once
// Which keys make a case the same case: what decides the results. When the run ends, what it writes
// when, and the patience of [coupling] decide none of them. A run goes on from a checkpoint, and
// the programs of a coupled run work together, only where these keys agree.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "case/case.hpp"

namespace undertow {

/// Of "sph.spacing = 0.01" or its key: false for time.end, [output], [checkpoint], [report],
/// case.title, and deadline, join_timeout and transport of [coupling].
bool is_binding(std::string_view line);

/// The binding keys of a case as HELLO carries them: "sph.spacing = 0.01", as written, with level,
/// variants and --set laid over. A value of more than 64 bytes or lines stands there as "#" and its
/// FNV-1a sum, 16 hex digits. If all lines together would not fit a HELLO, each table is one line:
/// "sph = #0123456789abcdef", the sum over its lines. Contents of files are not compared: each is
/// read by one program, perhaps on another host.
std::vector<std::string> binding_keys(const Case& input);

/// The first key that differs between two such lists, in the order of `ours`, and how many do.
struct KeyDifference {
    std::string key;
    std::optional<std::string> ours, theirs;  // values; none where the key is not there
    std::size_t count = 0;                    // of all keys that differ
};
std::optional<KeyDifference> first_difference(std::vector<std::string> ours,
                                              std::vector<std::string> theirs);

}  // namespace undertow
