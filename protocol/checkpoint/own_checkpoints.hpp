#pragma once
// Checkpoints of a solver that runs alone: it decides when, and writes the manifest, as the coupler
// does for a coupled run.

#include <string>

#include "checkpoint/checkpoint_clock.hpp"
#include "checkpoint/checkpoint_set.hpp"

namespace undertow {

class OwnCheckpoints {
 public:
    /// results: folder; who: "fem".
    OwnCheckpoints(const Case& input, std::string results, std::string who)
        : settings_(input.checkpoint),
          clock_(input.checkpoint, 0),
          results_(std::move(results)),
          who_(std::move(who)) {}

    /// Is one due before step n at t? `ending`: no step follows. Nothing is due where the run
    /// begins (again).
    bool due(std::int64_t n, double t, bool ending, bool interrupted);
    /// The solver has written its file: the manifest, and the oldest sets go.
    void complete(std::int64_t n, double t, const WrittenFile& file);

 private:
    CheckpointSettings settings_;
    CheckpointClock clock_;
    std::string results_, who_;
    std::int64_t first_ = -1;
};

}  // namespace undertow
