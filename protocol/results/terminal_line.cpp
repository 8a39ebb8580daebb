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
    const int shown =
        text.size() < static_cast<std::size_t>(most) ? static_cast<int>(text.size()) : most;
    std::fprintf(stderr, "\r%.*s\033[K", shown, text.data());
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
