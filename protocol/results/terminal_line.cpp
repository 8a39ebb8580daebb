#include "results/terminal_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace undertow {

namespace {

bool line_open = false;

int columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 100;
}

}  // namespace

std::string_view whole_parts(std::string_view text, std::size_t columns) {
    if (text.size() <= columns) return text;
    const std::size_t gap = text.substr(0, columns + 2).rfind("  ");
    return text.substr(0, gap == std::string_view::npos || gap == 0 ? columns : gap);
}

bool on_terminal() {
    static const bool terminal = isatty(STDERR_FILENO) == 1;
    return terminal;
}

void show_terminal_line(std::string_view text) {
    if (!on_terminal()) {
        std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
        return;
    }
    const int most = columns() - 1;  // a full line would wrap and scroll
    const std::string_view shown = whole_parts(text, static_cast<std::size_t>(most));
    std::fprintf(stderr, "\r%.*s\033[K", static_cast<int>(shown.size()), shown.data());
    std::fflush(stderr);
    line_open = true;
}

void clear_terminal_line() {
    if (!line_open) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    line_open = false;
}

void end_terminal_line() {
    if (!line_open) return;
    std::fputc('\n', stderr);
    line_open = false;
}

}  // namespace undertow
