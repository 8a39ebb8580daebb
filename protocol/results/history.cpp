#include "results/history.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "results/wall_clock.hpp"
#include "wire/errors.hpp"

namespace undertow {

namespace {
constexpr std::size_t enough_rows = 32 * 1024;  // [byte] that wait before they are written
}

History::History(const std::string& path, const std::vector<std::string>& notes,
                 const std::vector<std::string>& columns, FileStart start)
    : path_(path),
      file_(start == FileStart::fresh
                ? open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)
                : open(path.c_str(), O_WRONLY | O_CLOEXEC)),
      columns_(columns.size()) {
    if (file_ < 0)
        throw FileError(path + " could not be written: " + std::strerror(errno) +
                        "; check that its folder exists and can be written.");
    rows_.reserve(2 * enough_rows);
    if (start == FileStart::continued) return;
    for (const std::string& note : notes) rows_ += "# " + note + "\n";
    for (std::size_t i = 0; i < columns.size(); ++i) rows_ += (i == 0 ? "" : ",") + columns[i];
    rows_ += '\n';
    flush();
}

History::~History() {
    if (file_ < 0) return;
    write_rows();
    close(file_);
}

History::History(History&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      columns_(other.columns_),
      rows_(std::move(other.rows_)),
      last_flush_(other.last_flush_) {}

void History::row(std::span<const double> values) {
    if (values.size() != columns_)
        throw std::logic_error("a history row must have as many values as columns");
    char text[32];
    for (std::size_t i = 0; i < values.size(); ++i) {
        const int length = std::snprintf(text, sizeof text, i == 0 ? "%.9g" : ",%.9g", values[i]);
        rows_.append(text, static_cast<std::size_t>(length));
    }
    rows_ += '\n';
    if (rows_.size() > enough_rows || wall_clock() - last_flush_ > 1) flush();
}

void History::flush() {
    last_flush_ = wall_clock();
    if (const int error = write_rows())
        throw FileError(path_ + " could not be written: " + std::strerror(error) +
                        "; check that the disk is not full. The rows before are whole.");
}

/// Whole rows go to the kernel, in one call: a killed run leaves no torn row. If the disk takes
/// only a part, what it took of the last row is cut off again. Returns errno, or 0.
int History::write_rows() noexcept {
    std::size_t done = 0;
    int error = 0;
    while (done < rows_.size() && error == 0) {
        const ssize_t taken = write(file_, rows_.data() + done, rows_.size() - done);
        if (taken >= 0)
            done += static_cast<std::size_t>(taken);
        else if (errno != EINTR)
            error = errno;
    }
    if (done > 0 && rows_[done - 1] != '\n') {
        const std::size_t end = rows_.rfind('\n', done - 1);
        const std::size_t torn = end == std::string::npos ? done : done - end - 1;
        const off_t size = lseek(file_, -static_cast<off_t>(torn), SEEK_CUR);
        if (size < 0 || ftruncate(file_, size) != 0) error = error ? error : errno;
    }
    rows_.clear();
    return error;
}

HistoryTimes::HistoryTimes(double every, double t_end) : every_(every > 0 ? every : t_end / 2000) {}

namespace {
constexpr double round_off = 1e-12;
}  // namespace

bool HistoryTimes::is_due(double t) const {
    return t >= double(next_) * every_ * (1 - round_off);
}

bool HistoryTimes::due(double t) {
    if (!is_due(t)) return false;
    next_ = std::int64_t(std::floor(t / every_ * (1 + round_off))) + 1;
    return true;
}

}  // namespace undertow
