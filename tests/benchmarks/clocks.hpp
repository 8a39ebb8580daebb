#pragma once
// Clocks of the benchmarks.

#include <chrono>
#include <ctime>

namespace undertow::benchmarks {

/// CPU time of all threads of this process [s]: what other programs take does not count.
inline double cpu_clock() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

inline double wall_clock() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace undertow::benchmarks
