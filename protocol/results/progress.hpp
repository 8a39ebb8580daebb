#pragma once
// The live line: rewritten twice a second on a terminal, one line per 30 s otherwise.

#include <cstdint>
#include <limits>
#include <string>

namespace undertow {

struct ProgressFigures {
    double t = 0, t_end = 1;         // [s]
    std::int64_t n = 0;              // steps done
    double dt = 0;                   // [s]
    std::string limiter;             // who limits dt
    double particle_steps = 0;       // done so far, 0 = not shown
    double element_steps = 0;        // done so far, 0 = not shown
    double force = -1;               // [N] contact force, < 0 = not shown
    std::string waiting;             // "sph 83 % fem 4 % coupler 9 %": who is busy, who waits for whom
    std::string doing{};             // "writing step_000001200": what holds the steps up
};

/// The live line: rates in 1/s (0 = not shown), eta in s (0 = not shown), `kept` as it is.
std::string line_text(const ProgressFigures& figures, double particle_rate, double element_rate,
                      double eta, const std::string& kept);

class ProgressLine {
 public:
    /// quiet: nothing at all is shown. Also writes `status_file` (JSON, atomic rename, once a
    /// second) for `undertow status`; empty = none.
    ProgressLine(bool quiet, std::string status_file);
    ~ProgressLine();
    /// Whether the line or the status is to be renewed: one clock read.
    bool due() const;
    /// Nothing when nothing is due.
    void update(const ProgressFigures& figures);
    /// In any case: before something that takes long.
    void update_now(const ProgressFigures& figures);
    /// The last checkpoint: its folder within the results, its time [s], and when it was written
    /// [s since 1970; 0: now]. Shown from now on.
    void kept(std::string folder, double t, std::int64_t written_at = 0);
    /// Ends the line, so that the next output starts on its own.
    void finish(const ProgressFigures& figures);

 private:
    bool line_due(double now) const;
    bool status_due(double now) const;
    void show(const ProgressFigures& figures, double now, bool line, bool status);
    void measure(const ProgressFigures& figures, double now);
    std::string kept_text() const;
    void write_status(const char* state, const ProgressFigures& figures, double particle_rate,
                      double element_rate, double wall, double eta) const;

    bool quiet_, terminal_;
    std::string status_file_;
    double start_ = 0, last_line_ = 0, last_status_ = 0;              // [s] wall clock
    double rate_t_ = 0;              // smoothed simulated seconds per wall second
    double particle_rate_ = 0, element_rate_ = 0;                     // [1/s] smoothed
    double eta_ = std::numeric_limits<double>::infinity();            // [s]
    double last_t_ = 0, last_wall_ = 0, last_particle_steps_ = 0, last_element_steps_ = 0;
    std::string kept_;          // folder; empty = none yet
    double kept_t_ = 0;         // [s]
    std::int64_t kept_at_ = 0;  // [s] since 1970
};

}  // namespace undertow
