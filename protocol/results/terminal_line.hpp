#pragma once
// The one line on stderr that is rewritten in place, shared by the progress line and the log so that
// a message never lands in the middle of it.

#include <string_view>

namespace undertow {

/// Is stderr a terminal?
bool on_terminal();
/// As many whole parts of `text`, parted by two spaces or more, as have room in `columns`.
std::string_view whole_parts(std::string_view text, std::size_t columns);
/// Rewrites the line (whole parts, up to the terminal's width); on a pipe or file prints it as a line of its own.
void show_terminal_line(std::string_view text);
/// Removes the line, so that other output starts at its place. Nothing happens without a line.
void clear_terminal_line();
/// Leaves the line as it is and starts a new one.
void end_terminal_line();

}  // namespace undertow
