// Speed of the SPH solver on the developed dam break (dam_break_scene.hpp): particle-steps per
// second of the whole step (lists, packing, sums over particles and images, wall friction, kick,
// drift), for each way of stepping, kernel and rheology, at three sizes; bytes per particle; what
// the machine can do at best.
//   bench_sph_throughput [--json] [--steps N] [--sizes N] [--only KIND]
// N = 1, 2, 3 sizes (27 k, 216 k, 1.7 M); KIND as it is printed: no other figure is measured
// Speed is counted in CPU time of all threads: what other programs take does not count. Wall times
// stand beside it. Only particles count, images and dummies of the walls are named apart.

#include <malloc.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "clocks.hpp"
#include "dam_break_scene.hpp"
#include "machine_peaks.hpp"

using namespace undertow;
using namespace undertow::benchmarks;
using namespace undertow::sph;

namespace {

const std::vector<double> sampled{1.0, 1.7, 2.4};  // [t*]
constexpr int warm_up = 20;                        // steps: lists, caches, an order of their own

struct Speed {
    double cpu = 0, wall = 0;  // [particle-steps/s], cpu: per core
    double neighbors = 0;      // mean number within the support
    double rebuilds = 0;       // of the lists, per step of the runs that count
    std::size_t particles = 0, wall_records = 0;
};

/// Mean over the states: `steps` steps of each, the best of `repeats` runs.
Speed speed(const Case& input, const std::vector<Snapshot>& states, bool two_pass, int steps,
            int repeats) {
    Speed mean;
    double cpu = 0, wall = 0, count = 0;
    for (const Snapshot& state : states) {
        FluidSystem fluid(input, two_pass ? 0.4 : 0.2);
        load(state, fluid);
        Steps at;
        at.t = state.t;
        Health health = fluid.health();
        double best_cpu = 1e300, best_wall = 1e300, rebuilds = 0;
        const auto take = [&](int n) {
            for (int k = 0; k < n; ++k) {
                at.dt = step_size(input, fluid, health, two_pass);
                health = take_step(fluid, at, two_pass);
            }
        };
        take(warm_up);
        for (int r = 0; r < repeats; ++r) {
            const auto rebuilt = fluid.rebuilds();
            const double cpu_start = cpu_clock(), wall_start = wall_clock();
            take(steps);
            const double cpu_now = cpu_clock() - cpu_start;
            if (cpu_now < best_cpu)
                best_cpu = cpu_now, rebuilds = double(fluid.rebuilds() - rebuilt) / steps;
            best_wall = std::min(best_wall, wall_clock() - wall_start);
        }
        cpu += best_cpu, wall += best_wall, count += double(fluid.particles.size()) * steps;
        mean.rebuilds += rebuilds / double(states.size());
        mean.neighbors += fluid.mean_neighbors() / double(states.size());
        mean.particles = fluid.particles.size();
        mean.wall_records = std::max(mean.wall_records,
                                     fluid.neighbors().records().size() - fluid.particles.size());
    }
    mean.cpu = count / cpu, mean.wall = count / wall;
    return mean;
}

/// Bytes that the allocator has given out [byte].
double allocated() {
    const struct mallinfo2 info = mallinfo2();
    return double(info.uordblks) + double(info.hblkhd);
}

/// Of a solver with all its lists and records, after some steps [byte].
double bytes_per_particle(const Case& input, const Snapshot& state) {
    const double before = allocated();
    FluidSystem fluid(input, 0.4);
    load(state, fluid);
    Steps at;
    at.t = state.t;
    Health health = fluid.health();
    for (int n = 0; n < 5; ++n) {
        at.dt = step_size(input, fluid, health, true);
        health = take_step(fluid, at, true);
    }
    return (allocated() - before) / double(fluid.particles.size());
}

void print(const std::string& name, const Speed& s) {
    std::fprintf(
        stderr,
        "%-34s %9zu particles (walls %7zu), %5.1f neighbors, %5.3f rebuilds a step: %6.2f M particle-steps/CPU s, "
        "%6.2f M/s wall\n",
        name.c_str(), s.particles, s.wall_records, s.neighbors, s.rebuilds, 1e-6 * s.cpu, 1e-6 * s.wall);
}

/// The slurry of the bucket scene. "auto" would take the implicit update here.
std::vector<std::string> slurry(const std::string& viscosity_solver) {
    return {"sph.fluid.water.yield_stress=7.3", "sph.fluid.water.consistency=3",
            "sph.fluid.water.flow_index=0.35", "sph.viscosity_solver=" + viscosity_solver};
}

std::string key(const std::string& name, double value) {
    char text[160];
    std::snprintf(text, sizeof text, "\"%s\": %.5g", name.c_str(), value);
    return text;
}

}  // namespace

int main(int argc, char** argv) {
    bool json = false;
    int steps = 60, sizes = 3;
    std::string only;
    for (int a = 1; a < argc; ++a) {
        if (!std::strcmp(argv[a], "--json")) json = true;
        if (!std::strcmp(argv[a], "--steps") && a + 1 < argc)
            steps = std::max(1, std::atoi(argv[++a]));
        if (!std::strcmp(argv[a], "--sizes") && a + 1 < argc)
            sizes = std::clamp(std::atoi(argv[++a]), 1, 3);
        if (!std::strcmp(argv[a], "--only") && a + 1 < argc) only = argv[++a];
    }
    const int cores = omp_get_num_procs();
    omp_set_num_threads(1);
    std::vector<std::string> figures;
    const auto tell = [&](const std::string& name, const Speed& s) {
        figures.push_back(key("sph." + name, s.cpu));
        figures.push_back(key("sph.wall." + name, s.wall));
    };

    const double peak = fma_peak(), one = read_bandwidth(1), all = read_bandwidth(cores);
    std::fprintf(
        stderr,
        "machine: %.0f GF/s per core (float FMA), reads %.1f GB/s on one core, %.1f on %d\n",
        1e-9 * peak, 1e-9 * one, 1e-9 * all, cores);
    figures.push_back(key("machine.fma_flops_per_core", peak));
    // 2 on two free cores, 1 on two threads of one core: what two threads can gain at all
    const double gain = cores > 1 ? 2 * fma_peak(2) / peak : 1;
    if (cores > 1)
        std::fprintf(stderr, "machine: two threads do %.2f times the arithmetic of one\n", gain);
    figures.push_back(key("machine.two_thread_gain", gain));
    figures.push_back(key("machine.read_bytes_per_s_one_core", one));
    figures.push_back(key("machine.read_bytes_per_s", all));

    constexpr double dx = 0.01;
    const Case base = dam_break(dx);
    const std::vector<Snapshot> states = develop(base, sampled);
    const struct {
        const char* name;
        std::vector<std::string> set;
        bool two_pass;
    } kinds[] = {
        {"newtonian_one_pass", {}, false},
        {"newtonian_two_pass", {}, true},
        {"cubic_spline_two_pass", {"sph.kernel=cubic_spline"}, true},
        {"double", {"sph.precision=double"}, true},
        {"double_one_pass", {"sph.precision=double"}, false},
        {"herschel_bulkley", slurry("explicit"), true},
        {"herschel_bulkley_one_pass", slurry("explicit"), false},
        {"herschel_bulkley_implicit", slurry("implicit"), true},
    };
    Speed two_pass;
    for (const auto& kind : kinds) {
        if (!only.empty() && only != kind.name) continue;
        const Speed s = speed(dam_break(dx, kind.set), states, kind.two_pass, steps, 3);
        print(kind.name, s);
        tell(kind.name, s);
        if (!std::strcmp(kind.name, "newtonian_two_pass")) two_pass = s;
    }
    const bool large = only.find("_216k") != only.npos || only.find("_1728k") != only.npos;
    if (!only.empty() && !large) return 0;
    figures.push_back(key("sph.particles", double(two_pass.particles)));
    figures.push_back(key("sph.wall_particles", double(two_pass.wall_records)));
    figures.push_back(key("sph.neighbors_mean", two_pass.neighbors));
    figures.push_back(key("sph.support_over_spacing", 2 * base.sph.smoothing_ratio));

    if (cores > 1 && !large) {
        omp_set_num_threads(2);
        const Speed s = speed(base, states, true, steps, 5);
        omp_set_num_threads(1);
        print("newtonian_two_pass, 2 threads", s);
        figures.push_back(key("sph.two_thread_speedup", s.wall / two_pass.wall));
        // what two threads would gain on free cores if all of their time were work: without waiting
        figures.push_back(key("sph.two_thread_cpu_efficiency", s.cpu / two_pass.cpu));
        std::fprintf(stderr, "two threads: %.2f times the speed (wall), CPU efficiency %.2f\n",
                     s.wall / two_pass.wall, s.cpu / two_pass.cpu);
    }

    double bytes = bytes_per_particle(base, states[1]);
    const char* names[] = {"", "_216k", "_1728k"};
    for (int size = 1, copies = 8; size < sizes; ++size, copies *= 8) {
        if (large && only != std::string("newtonian_two_pass") + names[size]) continue;
        const Case wide = widened(base, copies);
        const Snapshot state = side_by_side(states[1], copies);
        const Speed s = speed(wide, {state}, true, size == 1 ? steps : std::max(1, steps / 3), 2);
        print(std::string("newtonian_two_pass") + names[size], s);
        tell(std::string("newtonian_two_pass") + names[size], s);
        if (size == 1 && cores > 1) {
            omp_set_num_threads(2);
            const Speed two = speed(wide, {state}, true, steps, 3);
            omp_set_num_threads(1);
            figures.push_back(key("sph.two_thread_speedup_216k", two.wall / s.wall));
            std::fprintf(stderr, "two threads: %.2f times the speed (wall), CPU efficiency %.2f\n",
                         two.wall / s.wall, two.cpu / s.cpu);
        }
        bytes = bytes_per_particle(wide, state);
    }
    figures.push_back(key("sph.bytes_per_particle", bytes));
    std::fprintf(stderr, "%.0f bytes per particle, walls' share included\n", bytes);

    if (json) {
        std::string text = "{";
        for (const std::string& figure : figures) text += (text.size() > 1 ? ", " : "") + figure;
        std::printf("%s}\n", text.c_str());
    }
}
