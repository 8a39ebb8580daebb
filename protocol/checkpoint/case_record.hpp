#pragma once
// The case as it was written, kept in each checkpoint: a run goes on only with the same one.

#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow {

class Archive;

/// "sph.spacing = 0.01", a line per key with level, variants and --set laid over; a text that names
/// a file of the case (mesh, STL, table) is followed by the SHA-256 of its content.
std::vector<std::string> record_of(const Case& input);

/// Writes the record; reading, compares it with that of `input` and throws InputError that names
/// the first key that differs. What decides when the run ends and what it writes when may differ:
/// time.end, [output], [checkpoint], [report], case.title and the patience of [coupling].
void archive_case(Archive& a, const Case& input, const std::string& where);

}  // namespace undertow
