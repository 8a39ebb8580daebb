#pragma once
// How long either end of the link waits, for what, and by which clock.

#include <chrono>

namespace undertow::wire {

inline constexpr double on_its_way = 0.01;   // [s] for a message whose bell has been heard
inline constexpr double tell_every = 0.1;    // of the deadline, that this program is busy
inline constexpr double error_linger = 0.5;  // [s] for ERROR to leave; then the program ends anyway

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace undertow::wire
