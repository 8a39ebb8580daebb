#pragma once
// Wall time for figures and intervals.

#include <chrono>

namespace undertow {

/// [s] since an arbitrary start; never jumps when the system's time is set.
inline double wall_clock() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
}

}  // namespace undertow
