// What tension control, shifting and gradient correction gain, and cost, in flows that are known:
//
//   patch     a rotating square of water in 2D, free on all sides [Colagrossi 2005]: the pressure
//   inside
//             is negative. Inviscid: kinetic energy and angular momentum stay.
//   vortices  a cell of Taylor-Green vortices between free-slip planes, Re given, negative pressure
//   in the
//             corners: energy decays with exp(-4 nu k^2 t), k = pi/L.
//
//   bench_sph_disorder SCENE N T [KEY=VALUE ...]      N particles along an edge, T [rotations or
//   L/U] keys: tension, shifting, jitter (over dx), kernel (c2, c4, cubic), h (over dx), delta,
//   alpha, re, cfl

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "sph_solver/fluid_system.hpp"
#include "sph_solver/physics/stable_step.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double pi = 3.14159265358979;

double cpu_seconds() {
    rusage use;
    getrusage(RUSAGE_SELF, &use);
    return double(use.ru_utime.tv_sec) + 1e-6 * double(use.ru_utime.tv_usec);
}

/// p/(rho omega^2 L^2) of the rigidly rotating square 0..1 with p = 0 on its edge:
/// laplace(p) = 2 rho omega^2, by its sine series.
double patch_pressure(double x, double z) {
    double p = 0;
    for (int m = 1; m < 40; m += 2)
        for (int n = 1; n < 40; n += 2)
            p -= 32 / (pi * pi * pi * pi * m * n * (m * m + n * n)) * std::sin(m * pi * x) *
                 std::sin(n * pi * z);
    return p;
}

struct Scene {
    bool patch;
    double speed;  // [m/s] largest of the start
    Case input;
};

Scene make_scene(const std::string& name, int n, std::map<std::string, std::string>& keys) {
    Scene scene;
    scene.patch = name == "patch";
    const double dx = 1.0 / n;
    Case& c = scene.input;
    c.file = "bench";
    c.info.dimension = 2;
    c.info.gravity = {0, 0, 0};
    c.sph.spacing = dx;
    const auto number = [&](const char* key, double otherwise) {
        return keys.count(key) ? std::stod(keys[key]) : otherwise;
    };
    c.sph.smoothing_ratio = number("h", 1.5);
    c.sph.density_diffusion = number("delta", 0.1);
    c.sph.artificial_viscosity = number("alpha", 0.02);
    c.sph.shifting = number("shifting", 0);
    c.sph.cfl = number("cfl", 0);
    c.sph.integrator = Integrator::two_pass;
    if (keys["kernel"] == "cubic") c.sph.kernel = Kernel::cubic_spline;
    if (keys["kernel"] == "c4") c.sph.kernel = Kernel::wendland_c4;
    const std::map<std::string, TensionControl> tension{{"none", TensionControl::none},
                                                        {"spray", TensionControl::spray},
                                                        {"switched", TensionControl::switched}};
    if (keys.count("tension")) c.sph.tension_control = tension.at(keys["tension"]);
    Fluid water;
    water.name = "water";
    water.density = 1000;
    if (!scene.patch) water.viscosity = 1000 / number("re", 100);
    c.sph.fluid = {water};
    Fill fill;
    fill.fluid = "water";
    fill.box = {{0, 0, 0}, {1, 1, 1}};
    c.sph.fill = {fill};
    scene.speed = scene.patch ? std::sqrt(0.5) : 1;
    c.sph.max_speed = scene.speed;
    if (!scene.patch)
        c.sph.plane = {{"floor", {0, 0, 0}, {0, 0, 1}, {}},
                       {"left", {0, 0, 0}, {1, 0, 0}, {}},
                       {"roof", {0, 0, 1}, {0, 0, -1}, {}},
                       {"right", {1, 0, 0}, {-1, 0, 0}, {}}};
    return scene;
}

void set_state(const Scene& scene, FluidSystem& fluid, double jitter) {
    Particles& s = fluid.particles;
    // a lattice in a straining flow stays symmetric, and shifting has nothing to see, until it
    // breaks
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in(-jitter * fluid.spacing(), jitter * fluid.spacing());
    for (std::size_t i = 0; i < s.size(); ++i) s.x[i] += in(random), s.z[i] += in(random);
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double x = s.x[i], z = s.z[i];
        double p;
        if (scene.patch) {
            s.vx[i] = z - 0.5, s.vz[i] = 0.5 - x;
            p = 1000 * patch_pressure(x, z);
        } else {
            s.vx[i] = std::sin(pi * x) * std::cos(pi * z);
            s.vz[i] = -std::cos(pi * x) * std::sin(pi * z);
            p = 250 * (std::cos(2 * pi * x) + std::cos(2 * pi * z));
        }
        s.drho[i] = fluid.fluid().deviation_at(p);
    }
}

struct Measured {
    double kinetic = 0, angular = 0, px = 0, pz = 0;  // sums over particles, per mass
    double speed = 0, deviation = 0;                  // largest [m/s], [-]
    double center = 0;                                // mean p within 0.1 of the center [Pa]
    double clumped = 0;         // share of particles with a neighbor closer than 0.6 dx
    double velocity_error = 0;  // root mean square, vortices, over the largest speed now
    double spread = 0;          // standard deviation of the distance to the nearest over dx
};

Measured measure(const Scene& scene, const FluidSystem& fluid, double t, double nu) {
    const Particles& s = fluid.particles;
    Measured m;
    int near_center = 0;
    const int n = static_cast<int>(s.size());
    double error2 = 0, sum = 0, sum2 = 0;
    const double decay = std::exp(-2 * nu * pi * pi * t);
    const ClusterLists& lists = fluid.neighbors().fluid_lists();
    for (int i = 0; i < n; ++i) {
        const double x = s.x[i] - 0.5, z = s.z[i] - 0.5;
        m.kinetic += 0.5 * (s.vx[i] * s.vx[i] + s.vz[i] * s.vz[i]);
        m.angular += z * s.vx[i] - x * s.vz[i];
        m.px += s.vx[i], m.pz += s.vz[i];
        m.speed = std::max(m.speed, std::hypot(s.vx[i], s.vz[i]));
        m.deviation = std::max(m.deviation, std::abs(s.drho[i]) / 1000);
        if (x * x + z * z < 0.01) m.center += s.p[i], ++near_center;
        const double ux = decay * std::sin(pi * s.x[i]) * std::cos(pi * s.z[i]) - s.vx[i],
                     uz = -decay * std::cos(pi * s.x[i]) * std::sin(pi * s.z[i]) - s.vz[i];
        error2 += ux * ux + uz * uz;
        double closest = 1e300;
        for (const int* j = lists.begin(i / lanes); j != lists.end(i / lanes); ++j)
            if (*j != i && *j < n)
                closest = std::min(closest, std::hypot(s.x[i] - s.x[*j], s.z[i] - s.z[*j]));
        closest /= fluid.spacing();
        m.clumped += closest < 0.6;
        closest = std::min(closest, 2.0);
        sum += closest, sum2 += closest * closest;
    }
    m.center /= std::max(1, near_center);
    m.clumped /= n;
    m.spread = std::sqrt(sum2 / n - sum / n * sum / n);
    if (!scene.patch) m.velocity_error = std::sqrt(error2 / n) / decay;
    return m;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        std::printf("bench_sph_disorder patch|vortices N T [KEY=VALUE ...]\n");
        return 2;
    }
    std::map<std::string, std::string> keys;
    for (int a = 4; a < argc; ++a) {
        const std::string word = argv[a];
        keys[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
    }
    const Scene scene = make_scene(argv[1], std::stoi(argv[2]), keys);
    const double end = std::stod(argv[3]);
    FluidSystem fluid(scene.input, 0.4);
    set_state(scene, fluid, keys.count("jitter") ? std::stod(keys["jitter"]) : 0);
    const double nu = scene.input.sph.fluid[0].viscosity / 1000;
    fluid.refresh_neighbors(0);
    const Measured first = measure(scene, fluid, 0, nu);
    setvbuf(stdout, nullptr, _IOLBF, 0);
    std::printf("%6s %9s %9s %9s %7s %8s %9s %8s %8s %8s %7s\n", "t", "kinetic", "angular",
                "momentum", "speed", "drho", "p center", "clumped", "spread", "v error", "cpu s");
    double t = 0, before = 0, next = 0;
    const double start = cpu_seconds();
    Health health = fluid.health();
    std::int64_t steps = 0;
    const double cfl = acoustic_cfl(scene.input.sph);
    bool due = false;
    while (true) {
        fluid.refresh_neighbors(t);
        fluid.pack(t);
        if (due) {
            fluid.sum_over_neighbors(Terms::rate);
            fluid.advance_density(before);
            fluid.pack(t);
        }
        fluid.sum_over_neighbors(Terms::force);
        if (t >= next - 1e-12) {
            const Measured m = measure(scene, fluid, t, nu);
            std::printf("%6.2f %9.5f %9.5f %9.1e %7.3f %8.5f %9.4f %8.4f %8.4f %8.4f %7.2f\n", t,
                        m.kinetic / first.kinetic, m.angular / (first.angular ? first.angular : 1),
                        std::hypot(m.px, m.pz) / (double(fluid.particles.size()) * scene.speed),
                        m.speed / scene.speed, m.deviation, m.center / 1000, m.clumped, m.spread,
                        m.velocity_error, cpu_seconds() - start);
            next += end / 8;
            if (t >= end - 1e-12) break;
        }
        StableStep step = stable_step({fluid.physics().h, fluid.fluid().c0, health.max_speed,
                                       health.max_acceleration, health.max_kinematic_viscosity},
                                      cfl, 0.25);
        const double dt = std::min(step.dt, next - t);
        health = fluid.kick_and_drift(dt, before, 0, false);
        if (!health.finite) {
            std::printf("not finite at t = %g\n", t);
            break;
        }
        before = dt, t += dt, due = true, ++steps;
    }
    std::printf("%lld steps, %.2f M particle-steps/s\n", static_cast<long long>(steps),
                double(steps) * double(fluid.particles.size()) / (cpu_seconds() - start) * 1e-6);
    return 0;
}
