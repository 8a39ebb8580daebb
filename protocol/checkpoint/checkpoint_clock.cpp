#include "checkpoint/checkpoint_clock.hpp"

#include <cmath>

#include "results/wall_clock.hpp"

namespace undertow {

CheckpointClock::CheckpointClock(const CheckpointSettings& settings, double t)
    : settings_(settings) {
    written(t);
}

bool CheckpointClock::due(double t) const {
    constexpr double round_off = 1e-12;
    if (settings_.every > 0 && t >= double(next_) * settings_.every * (1 - round_off)) return true;
    return settings_.every_wall > 0 && wall_clock() - last_wall_ >= settings_.every_wall;
}

void CheckpointClock::written(double t) {
    constexpr double round_off = 1e-12;
    if (settings_.every > 0)
        next_ = std::int64_t(std::floor(t / settings_.every * (1 + round_off))) + 1;
    last_wall_ = wall_clock();
}

}  // namespace undertow
