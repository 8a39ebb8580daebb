#include "results/history.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "results/wall_clock.hpp"
#include "wire/errors.hpp"

namespace undertow {

History::History(const std::string& path, const std::vector<std::string>& notes,
                 const std::vector<std::string>& columns)
    : file_(std::fopen(path.c_str(), "w")), columns_(columns.size()) {
    if (file_ == nullptr)
        throw InputError(path + " could not be written: " + std::strerror(errno) +
                         "; check that its folder exists and can be written.");
    for (const std::string& note : notes) std::fprintf(file_, "# %s\n", note.c_str());
    for (std::size_t i = 0; i < columns.size(); ++i)
        std::fprintf(file_, "%s%s", i == 0 ? "" : ",", columns[i].c_str());
    std::fputc('\n', file_);
    flush();
}

History::~History() {
    if (file_ != nullptr) std::fclose(file_);
}

History::History(History&& other) noexcept
    : file_(std::exchange(other.file_, nullptr)),
      columns_(other.columns_),
      last_flush_(other.last_flush_) {}

void History::row(std::span<const double> values) {
    if (values.size() != columns_)
        throw std::logic_error("a history row must have as many values as columns");
    for (std::size_t i = 0; i < values.size(); ++i)
        std::fprintf(file_, i == 0 ? "%.9g" : ",%.9g", values[i]);
    std::fputc('\n', file_);
    if (wall_clock() - last_flush_ > 1) flush();
}

void History::flush() {
    if (std::fflush(file_) != 0)
        throw InputError(std::string("a history could not be written: ") + std::strerror(errno) +
                         "; check that the disk is not full.");
    last_flush_ = wall_clock();
}

HistoryTimes::HistoryTimes(double every, double t_end) : every_(every > 0 ? every : t_end / 2000) {}

bool HistoryTimes::due(double t) {
    constexpr double round_off = 1e-12;
    if (t < double(next_) * every_ * (1 - round_off)) return false;
    next_ = std::int64_t(std::floor(t / every_ * (1 + round_off))) + 1;
    return true;
}

}  // namespace undertow
