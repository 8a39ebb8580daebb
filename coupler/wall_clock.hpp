#pragma once

#include <chrono>

namespace undertow::coupler {

/// Of a clock that nobody sets.  [s]
inline double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace undertow::coupler
