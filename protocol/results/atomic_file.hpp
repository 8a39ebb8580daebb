#pragma once
// Small text files that others may read at any moment.

#include <string>
#include <string_view>

namespace undertow {

/// Writes path.tmp and renames it, so that a reader sees the old text or the new one, never half.
/// Throws InputError when the folder cannot be written.
void write_file_atomically(const std::string& path, std::string_view text);
/// The same, and on the disk before it returns: it outlives a power failure.
void write_file_durably(const std::string& path, std::string_view text);

}  // namespace undertow
