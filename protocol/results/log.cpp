#include "results/log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "results/terminal_line.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace {

std::shared_ptr<spdlog::logger> file_log;    // all levels
std::shared_ptr<spdlog::logger> screen_log;  // warnings and errors

spdlog::logger& screen() {
    if (!screen_log) {
        screen_log = std::make_shared<spdlog::logger>(
            "screen", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        screen_log->set_pattern("%^%l%$: %v");
    }
    return *screen_log;
}

spdlog::level::level_enum spdlog_level(LogLevel level) {
    switch (level) {
        case LogLevel::info:
            return spdlog::level::info;
        case LogLevel::warning:
            return spdlog::level::warn;
        case LogLevel::error:
            return spdlog::level::err;
    }
    return spdlog::level::err;
}

}  // namespace

void open_log(const std::string& path, const std::string& program, LogStart start) {
    try {
        file_log = std::make_shared<spdlog::logger>(
            program, std::make_shared<spdlog::sinks::basic_file_sink_mt>(
                         path, start == LogStart::fresh));
    } catch (const spdlog::spdlog_ex& error) {
        throw InputError("the log " + path + " could not be written (" + error.what() +
                         "); check that its folder exists and can be written.");
    }
    file_log->set_pattern("%Y-%m-%d %H:%M:%S.%e %n %l: %v");
    file_log->flush_on(spdlog::level::info);  // a killed run keeps its log
    screen().set_pattern(program + ": %^%l%$: %v");
}

void log(LogLevel level, std::string_view text) {
    if (file_log) file_log->log(spdlog_level(level), text);
    // Without a log file everything goes to the screen, so that nothing is lost.
    if (level == LogLevel::info && file_log) return;
    clear_terminal_line();
    screen().log(spdlog_level(level), text);
    screen().flush();
}

}  // namespace undertow
