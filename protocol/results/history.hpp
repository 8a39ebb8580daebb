#pragma once
// A CSV history: '#' header lines (quantity, units, filter), a column line, rows flushed in time.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "results/file_start.hpp"

namespace undertow {

class Archive;

class History {
 public:
    /// columns like "t [s]"; notes become '#' lines. Creates the file at once (InputError if not).
    History(const std::string& path, const std::vector<std::string>& notes,
            const std::vector<std::string>& columns, FileStart start = FileStart::fresh);
    ~History();
    History(History&&) noexcept;
    History(const History&) = delete;

    /// One row, %.9g; as many values as columns. Rows go to the kernel whole, at least once per
    /// second of wall time and by flush(), so that a killed run or a full disk leaves whole rows.
    void row(std::span<const double> values);
    void flush();
    void archive(Archive& a);  // how long the file is

 private:
    int write_rows() noexcept;

    std::string path_;
    int file_ = -1;  // descriptor
    std::size_t columns_ = 0;
    std::string rows_;  // whole ones, on their way
    double last_flush_ = 0;
};

/// When rows of a history are due: at the first step at or after each multiple of an interval. The
/// multiples are computed afresh, so that no round-off adds up; a step longer than the interval
/// gets one row.
class HistoryTimes {
 public:
    /// every [s] = output.history_every; 0 means a 2000th of t_end [s].
    HistoryTimes(double every, double t_end);

    /// Asked once per step, with rising t [s]; true when the step deserves a row.
    bool due(double t);
    bool is_due(double t) const;  // the same, and it stays due
    void archive(Archive& a, double t);  // t [s]: now

 private:
    double every_;  // [s]
    std::int64_t next_ = 0;
};

}  // namespace undertow
