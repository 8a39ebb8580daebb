#pragma once
// One log per program: DIR/<program>.log, and warnings and errors on stderr as well.

#include <string>
#include <string_view>

namespace undertow {

enum class LogLevel { info, warning, error };

/// Opens the log of this process. Before it is called, messages go to stderr only.
enum class LogStart { fresh, continued };  // continued: behind what a run before has written
void open_log(const std::string& path, const std::string& program,
              LogStart start = LogStart::fresh);
void log(LogLevel level, std::string_view text);
inline void log_info(std::string_view text) { log(LogLevel::info, text); }
inline void log_warning(std::string_view text) { log(LogLevel::warning, text); }
inline void log_error(std::string_view text) { log(LogLevel::error, text); }

}  // namespace undertow
