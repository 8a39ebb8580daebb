#pragma once
// When a checkpoint is due: at the first step at or after each multiple of a simulated time, and
// when the wall clock says so. Writing one changes nothing in the run.

#include <cstdint>

#include "case/case.hpp"

namespace undertow {

class CheckpointClock {
 public:
    /// t: where the run begins [s]; nothing is due there.
    CheckpointClock(const CheckpointSettings& settings, double t);

    bool due(double t) const;
    /// Whether the run's last state is to be kept.
    bool due_at_end(bool interrupted) const {
        return settings_.present && (interrupted ? settings_.on_interrupt : settings_.at_end);
    }
    /// One was written at t.
    void written(double t);

 private:
    CheckpointSettings settings_;
    std::int64_t next_ = 0;  // the multiple that is due next
    double last_wall_ = 0;   // [s] wall clock
};

}  // namespace undertow
