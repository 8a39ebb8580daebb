#include "machine_peaks.hpp"

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "clocks.hpp"

namespace undertow::benchmarks {

namespace {

#ifdef __AVX512F__
constexpr int vector_bytes = 64;
#else
constexpr int vector_bytes = 32;
#endif
typedef float Vector __attribute__((vector_size(vector_bytes)));

constexpr int chains = 12;  // more than latency x ports of today's cores
volatile float sink;

}  // namespace

double fma_peak(int threads) {
    constexpr int steps = 4000000;
    double best = 0;
    for (int repeat = 0; repeat < 5; ++repeat) {
        const double start = cpu_clock();
#pragma omp parallel num_threads(threads)
        {
            Vector sum[chains];
            for (int c = 0; c < chains; ++c) sum[c] = Vector{} + 0.1f * float(c);
            Vector factor = Vector{} + 0.999999f, addend = Vector{} + 1e-6f;
            asm volatile("" : "+x"(factor), "+x"(addend));  // not constants to the compiler
            for (int n = 0; n < steps; ++n)
                for (int c = 0; c < chains; ++c) sum[c] = sum[c] * factor + addend;
            for (int c = 0; c < chains; ++c) sink = sum[c][0];
        }
        const double time = cpu_clock() - start;
        const double operations = 2.0 * chains * steps * (vector_bytes / sizeof(float));
        best = std::max(best, threads * operations / time);
    }
    return best;
}

double read_bandwidth(int threads) {
    const std::size_t size = std::size_t(48) << 20;  // doubles: 384 MiB
    std::vector<double> data(size);
    double best = 0;
    for (int repeat = 0; repeat < 6; ++repeat) {
        const double start = wall_clock();
        double sum = 0;
#pragma omp parallel for simd schedule(static) num_threads(threads) reduction(+ : sum)
        for (std::size_t i = 0; i < size; ++i)
            sum += repeat == 0 ? (data[i] = double(i)) : data[i];  // first touch by the reader
        sink = float(sum);
        if (repeat > 0)
            best = std::max(best, double(size * sizeof(double)) / (wall_clock() - start));
    }
    return best;
}

}  // namespace undertow::benchmarks
