#pragma once
// What this machine can do at best, measured: the yardstick beside every figure of speed.

namespace undertow::benchmarks {

/// Float multiply-adds of one core, two operations each: twelve independent chains of the widest
/// vectors that this build uses.   [operations/s]
double fma_peak();

/// Bytes that `threads` threads together read from memory in arrays much larger than the caches.
/// [byte/s]
double read_bandwidth(int threads);

}  // namespace undertow::benchmarks
