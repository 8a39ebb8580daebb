// Particle-steps per second of the whole step (lists, packing, sums, kick and drift) of a block of
// moving fluid in a basin, on the threads given: one Newtonian fluid, two, two of which the lower
// fifth is viscoplastic (a slide under water), and one that is viscoplastic all through.
//   bench_sph_throughput [--json] [--steps N]
// CPU time of all threads, divided by their number: what other programs take does not count.

#include <omp.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>
#include <string>

#include "sph_solver/fluid_system.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

double cpu_clock() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

enum class Scene { one_newtonian, two_newtonian, slide_under_water, one_viscoplastic };

/// A basin of 60 x 20 x 40 particles that sloshes, its lower fifth of another fluid.
Case make_case(Scene scene) {
    Case c;
    c.file = "benchmark";
    c.sph.present = true;
    c.sph.spacing = 0.0625;
    const double dx = c.sph.spacing, length = 60 * dx, width = 20 * dx, depth = 40 * dx;
    Fluid water{.name = "water", .density = 1000, .viscosity = 1e-3};
    Fluid slide{.name = "slide", .density = 1681};
    if (scene == Scene::two_newtonian) slide.viscosity = 10;
    if (scene == Scene::slide_under_water || scene == Scene::one_viscoplastic)
        slide.yield_stress = 7.3, slide.consistency = 3, slide.flow_index = 0.35;
    c.sph.max_speed = 7;
    const Fill whole{.fluid = "water", .box = {{0, 0, 0}, {length, width, depth}}};
    const Fill low{.fluid = "slide", .box = {{0, 0, 0}, {length, width, 0.2 * depth}}};
    switch (scene) {
        case Scene::one_newtonian:
            c.sph.fluid = {water};
            c.sph.fill = {whole};
            break;
        case Scene::one_viscoplastic:
            c.sph.fluid = {slide};
            c.sph.fill = {whole};
            c.sph.fill[0].fluid = "slide";
            break;
        default:
            c.sph.fluid = {water, slide};
            c.sph.fill = {whole, low};
    }
    c.sph.plane = {{"floor", {0, 0, 0}, {0, 0, 1}},
                   {"left", {0, 0, 0}, {1, 0, 0}},
                   {"right", {length, 0, 0}, {-1, 0, 0}},
                   {"near", {0, 0, 0}, {0, 1, 0}},
                   {"far", {0, width, 0}, {0, -1, 0}}};
    return c;
}

/// Million particle-steps per second and thread.
double throughput(Scene scene, bool two_pass, int steps) {
    FluidSystem fluid(make_case(scene), 0.4);
    Particles& p = fluid.particles;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> in(-1, 1);
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.x[i] += 0.1 * fluid.spacing() * in(random);
        p.y[i] += 0.1 * fluid.spacing() * in(random);
        p.z[i] += 0.1 * fluid.spacing() * in(random);
        p.vx[i] = std::sin(p.z[i]);
    }
    const double dt = (two_pass ? 0.8 : 0.22) * fluid.spacing() / fluid.fluid().c0;
    double t = 0, before = 0, before_that = 0, start = 0;
    for (int n = -20; n < steps; ++n) {
        if (n == 0) start = cpu_clock();
        fluid.refresh_neighbors(t);
        fluid.pack(t);
        if (two_pass) {
            fluid.sum_over_neighbors(Terms::rate);
            fluid.advance_density(before);
            fluid.pack(t);
        }
        fluid.sum_over_neighbors(two_pass ? Terms::force : Terms::both);
        fluid.kick_and_drift(dt, before, before_that, !two_pass);
        before_that = before, before = dt, t += dt;
    }
    return double(p.size()) * steps / (cpu_clock() - start) * 1e-6;
}

}  // namespace

int main(int argc, char** argv) {
    bool json = false;
    int steps = 100;
    for (int a = 1; a < argc; ++a) {
        if (!std::strcmp(argv[a], "--json")) json = true;
        if (!std::strcmp(argv[a], "--steps") && a + 1 < argc) steps = std::atoi(argv[a + 1]);
    }
    const struct {
        const char* name;
        Scene scene;
    } scenes[] = {{"newtonian", Scene::one_newtonian},
                  {"two_newtonian", Scene::two_newtonian},
                  {"slide_under_water", Scene::slide_under_water},
                  {"viscoplastic", Scene::one_viscoplastic}};
    if (json) std::printf("{\"threads\": %d", omp_get_max_threads());
    else
        std::printf("%-20s %10s %10s   M particle-steps/s and thread, %d threads\n", "", "one pass",
                    "two pass", omp_get_max_threads());
    for (const auto& s : scenes) {
        double best[2] = {0, 0};   // of three: what disturbs only slows
        for (int k = 0; k < 6; ++k)
            best[k % 2] = std::max(best[k % 2], throughput(s.scene, k % 2, steps));
        if (json)
            std::printf(", \"%s_one_pass\": %.4g, \"%s_two_pass\": %.4g", s.name, best[0] * 1e6,
                        s.name, best[1] * 1e6);
        else
            std::printf("%-20s %10.2f %10.2f\n", s.name, best[0], best[1]);
    }
    if (json) std::printf("}\n");
}
