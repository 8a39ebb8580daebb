#pragma once
// What this machine can do at best, measured: the yardstick beside every figure of speed.

namespace undertow::benchmarks {

/// Float multiply-adds of one core, two operations each: twelve independent chains of the widest
/// vectors that this build uses, per CPU second with `threads` threads at it together. Where two of
/// them reach half of what one does, they are two threads of one core: no program gains more than
/// what its memory accesses leave free.   [operations/s]
double fma_peak(int threads = 1);

/// Bytes that `threads` threads together read from memory in arrays much larger than the caches.
/// [byte/s]
double read_bandwidth(int threads);

}  // namespace undertow::benchmarks
