#include "results/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "results/summary.hpp"
#include "results/terminal_line.hpp"
#include "results/wall_clock.hpp"

namespace undertow {

namespace {

constexpr double terminal_every = 0.5;  // [s]
constexpr double log_every = 30;        // [s] when nobody watches
constexpr double status_every = 1;      // [s]
constexpr double smoothing = 5;         // [s] time constant of the rate behind the ETA
constexpr int bar_width = 20;

std::string duration_text(double seconds) {
    if (!std::isfinite(seconds)) return "--";
    const auto s = static_cast<long>(std::lround(seconds));
    if (s < 100) return fmt::format("{} s", s);
    if (s < 6000) return fmt::format("{}:{:02d} min", s / 60, s % 60);
    return fmt::format("{}:{:02d} h", s / 3600, s / 60 % 60);
}

}  // namespace

/// What a user waits for comes first: a terminal shows as many of the parts as it has columns for.
std::string line_text(const ProgressFigures& f, double particle_rate, double element_rate,
                      double eta, const std::string& kept) {
    const double share = std::clamp(f.t_end > 0 ? f.t / f.t_end : 1.0, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(share * bar_width);
    std::string text =
        fmt::format("[{}{}] {:3.0f} %  t {:.4g}/{:.4g} s", std::string(filled, '#'),
                    std::string(bar_width - filled, '-'), std::floor(100 * share), f.t, f.t_end);
    if (eta > 0) text += "  ETA " + duration_text(eta);
    if (!f.doing.empty()) text += "  " + f.doing;
    text += fmt::format("  step {}  dt {:.2e} s", f.n, f.dt);
    if (!f.limiter.empty()) text += fmt::format(" ({})", f.limiter);
    text += kept;
    if (particle_rate > 0) text += fmt::format("  {:.3g} M particle-steps/s", particle_rate / 1e6);
    if (element_rate > 0) text += fmt::format("  {:.3g} M element-steps/s", element_rate / 1e6);
    if (!f.waiting.empty()) text += "  " + f.waiting;
    if (f.force >= 0) text += fmt::format("  contact force {:.3g} N", f.force);
    return text;
}

void ProgressLine::write_status(const char* state, const ProgressFigures& f, double particle_rate,
                                double element_rate, double wall, double eta) const {
    Summary status;
    status.set("state", state);
    status.set("pid", static_cast<std::int64_t>(getpid()));
    status.set("t", f.t);
    status.set("t_end", f.t_end);
    status.set("step", f.n);
    status.set("dt", f.dt);
    status.set("limiter", f.limiter);
    status.set("wall_s", wall);
    status.set("eta_s", eta);
    status.set("particle_steps_per_s", particle_rate);
    status.set("element_steps_per_s", element_rate);
    if (f.force >= 0) status.set("force_N", f.force);
    status.set("waiting", f.waiting);
    if (!f.doing.empty()) status.set("doing", f.doing);
    if (!kept_.empty()) {
        status.set("checkpoint.folder", kept_);
        status.set("checkpoint.t", kept_t_);
        status.set("checkpoint.written_at", kept_at_);
    }
    status.write(status_file_);
}

ProgressLine::ProgressLine(bool quiet, std::string status_file)
    : quiet_(quiet),
      terminal_(on_terminal()),
      status_file_(std::move(status_file)),
      start_(wall_clock()),
      last_line_(start_),
      last_wall_(start_) {}

ProgressLine::~ProgressLine() {
    if (!quiet_) end_terminal_line();
}

bool ProgressLine::line_due(double now) const {
    return !quiet_ && now - last_line_ >= (terminal_ ? terminal_every : log_every);
}

bool ProgressLine::status_due(double now) const {
    return !status_file_.empty() && now - last_status_ >= status_every;
}

bool ProgressLine::due() const {
    const double now = wall_clock();
    return line_due(now) || status_due(now);
}

void ProgressLine::update(const ProgressFigures& figures) {
    const double now = wall_clock();
    show(figures, now, line_due(now), status_due(now));
}

void ProgressLine::update_now(const ProgressFigures& figures) {
    show(figures, wall_clock(), !quiet_ && terminal_, !status_file_.empty());
}

void ProgressLine::kept(std::string folder, double t, std::int64_t written_at) {
    kept_ = std::move(folder);
    kept_t_ = t;
    kept_at_ = written_at > 0 ? written_at : std::time(nullptr);
}

void ProgressLine::show(const ProgressFigures& figures, double now, bool line, bool status) {
    if (!line && !status) return;
    measure(figures, now);
    if (line) {
        show_terminal_line(line_text(figures, particle_rate_, element_rate_, eta_, kept_text()));
        last_line_ = now;
    }
    if (status) {
        write_status("running", figures, particle_rate_, element_rate_, now - start_, eta_);
        last_status_ = now;
    }
}

std::string ProgressLine::kept_text() const {
    if (kept_.empty()) return {};
    return fmt::format("  kept t {:.4g} s, {} ago", kept_t_,
                       duration_text(double(std::time(nullptr) - kept_at_)));
}

void ProgressLine::measure(const ProgressFigures& figures, double now) {
    const double passed = now - last_wall_;
    if (passed <= 0) return;
    // A run's speed drifts (steps shrink at impacts): recent seconds count more than old ones.
    const double weight = last_t_ == 0 ? 1 : 1 - std::exp(-passed / smoothing);
    const auto blend = [&](double& rate, double done, double done_before) {
        rate += weight * ((done - done_before) / passed - rate);
    };
    blend(rate_t_, figures.t, last_t_);
    blend(particle_rate_, figures.particle_steps, last_particle_steps_);
    blend(element_rate_, figures.element_steps, last_element_steps_);
    eta_ = rate_t_ > 0 ? std::max(0.0, figures.t_end - figures.t) / rate_t_
                       : std::numeric_limits<double>::infinity();
    last_wall_ = now;
    last_t_ = figures.t;
    last_particle_steps_ = figures.particle_steps;
    last_element_steps_ = figures.element_steps;
}

void ProgressLine::finish(const ProgressFigures& figures) {
    const double wall = std::max(wall_clock() - start_, 1e-9);
    const double particle_rate = figures.particle_steps / wall;
    const double element_rate = figures.element_steps / wall;
    if (!quiet_) {
        show_terminal_line(line_text(figures, particle_rate, element_rate, 0, kept_text()));
        end_terminal_line();
    }
    if (!status_file_.empty())
        write_status(figures.t < figures.t_end ? "interrupted" : "finished", figures, particle_rate,
                     element_rate, wall, 0);
}

}  // namespace undertow
