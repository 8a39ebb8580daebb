// Cost of contact on a bucket (cylinder with lid) in a band of particles three layers deep:
// search per particle, step per active and per band particle. One thread.
//   bench_contact_cost [facet size, default 0.02 m] [particle spacing, default 0.02 m]
// Targets: 40 ns per band particle and step, 300 ns per particle at a search.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <vector>

#include "contact/penalty_contact.hpp"

using namespace undertow::contact;

namespace {

/// CPU time of this process: other programs on the machine cost cache, but not time slices.
double seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

template <typename Work>
double best_of(int repetitions, Work work) {
    double best = 1e300;
    for (int i = 0; i < repetitions; ++i) {
        const double start = seconds();
        work();
        best = std::min(best, seconds() - start);
    }
    return best;
}

struct Mesh {
    std::vector<double> x, v, mass;
    std::vector<std::int32_t> quad;
};

/// Side wall of radius 1 m and height 0.5 m and a lid, wet side outward.
Mesh bucket(double size) {
    const double radius = 1, height = 0.5;
    const int around = int(2 * M_PI * radius / size), up = int(height / size);
    Mesh mesh;
    const auto ring = [&](double r, double z) {
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * M_PI * i / around;
            mesh.x.insert(mesh.x.end(), {r * std::cos(angle), r * std::sin(angle), z});
        }
    };
    for (int k = 0; k <= up; ++k) ring(radius, height * k / up);
    const int inward = int(radius / size);
    for (int k = inward - 1; k > inward / 8; --k) ring(radius * k / inward, height);
    const int rings = int(mesh.x.size()) / 3 / around;
    for (int k = 0; k + 1 < rings; ++k)
        for (int i = 0; i < around; ++i) {
            const int a = k * around + i, b = k * around + (i + 1) % around;
            mesh.quad.insert(mesh.quad.end(), {a, b, b + around, a + around});
        }
    mesh.v.assign(mesh.x.size(), 0);
    mesh.mass.assign(mesh.x.size() / 3, 0.06);
    return mesh;
}

}  // namespace

int main(int argc, char** argv) {
    const double size = argc > 1 ? std::atof(argv[1]) : 0.02;
    const double spacing = argc > 2 ? std::atof(argv[2]) : 0.02;
    const Mesh mesh = bucket(size);

    std::mt19937 random(1);
    std::uniform_real_distribution<double> jitter(-0.05 * spacing, 0.05 * spacing);
    std::vector<double> x;
    for (double px = -1.1; px < 1.1; px += spacing)
        for (double py = -1.1; py < 1.1; py += spacing)
            for (double pz = spacing / 2; pz < 0.6; pz += spacing) {
                const double out = std::max(std::hypot(px, py) - 1, pz - 0.5);
                if (out < 0.45 * spacing || out > 3 * spacing) continue;
                x.insert(x.end(), {px + jitter(random), py + jitter(random), pz + jitter(random)});
            }
    const std::size_t band = x.size() / 3;
    const double l0 = spacing / 2, skin = 0.3 * spacing, m = 1000 * spacing * spacing * spacing;
    std::vector<double> v(x.size(), 0), mass(band, m), radius(band, l0), stiffness(band, 1e6);
    std::vector<std::uint64_t> id(band);
    for (std::size_t i = 0; i < band; ++i) id[i] = (i * 2654435761u) % 1000003;
    const Points points{x, v, mass, radius, stiffness, id};

    PenaltyContact contact(Surface(mesh.quad, mesh.mass), LawSettings{});
    const double search = best_of(7, [&] { contact.rebuild(points, skin, mesh.x, mesh.v); });
    std::vector<double> x_active, v_active;
    for (std::uint32_t row : contact.active_rows())
        for (int axis = 0; axis < 3; ++axis) {
            x_active.push_back(x[3 * row + axis]);
            v_active.push_back(0);
        }
    const std::size_t active = contact.active_rows().size();
    const auto update = [&] { contact.update(x_active, v_active, mesh.x, mesh.v); };
    const double detect = best_of(50, update);
    const double forces = best_of(50, [&] { contact.compute_forces(1e-6); });
    const double settle = best_of(50, [&] { contact.settle(); });
    const double step = detect + forces + settle;
    std::printf("%zu facets, %zu nodes, %zu band particles, %zu active, %zu in contact\n",
                mesh.quad.size() / 4, mesh.mass.size(), band, active, contact.contacts().size());
    std::printf("search            %8.2f ms  %6.0f ns per band particle\n", 1e3 * search,
                1e9 * search / double(band));
    std::printf("step              %8.3f ms  %6.1f ns per band particle, %.0f ns per active one\n",
                1e3 * step, 1e9 * step / double(band), 1e9 * step / double(active));
    std::printf("  detect %.3f ms, forces %.3f ms, ledger %.3f ms\n", 1e3 * detect, 1e3 * forces,
                1e3 * settle);
}
