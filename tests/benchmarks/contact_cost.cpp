// Cost of contact on a bucket (cylinder with lid) under three layers of particles that flow around
// it at 10 m/s, c0 = 100 m/s, at a quarter of the acoustic step: search per particle, step per band
// particle (mean from one search to the next), and what the slowest step takes. One thread.
//   bench_contact_cost [facet size, default 0.0125 m] [particle spacing, default 0.0135 m] [speed
//   m/s, default 10] [share of the band that touches, default 0.333]
// gives 50 k facets and 100 k band particles. The band is all particles that the search is given.
// Targets: 30 ns per band particle and step, where 29 % of the band have a candidate facet and 10 %
// touch (docs/theory_contact.md, section 7), 300 ns per particle at a search.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "clocks.hpp"
#include "contact/penalty_contact.hpp"
#include "contact_scene.hpp"

using namespace undertow::contact;
using namespace undertow::benchmarks;

namespace {

/// Rotates the flow about the bucket's axis by `angle`.
void turn(std::vector<double>& x, std::vector<double>& v, double angle, double speed) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (std::size_t i = 0; i + 2 < x.size(); i += 3) {
        const double px = c * x[i] - s * x[i + 1], py = s * x[i] + c * x[i + 1];
        x[i] = px, x[i + 1] = py;
        v[i] = -speed * py, v[i + 1] = speed * px;
    }
}

}  // namespace

int main(int argc, char** argv) {
    const double size = argc > 1 ? std::atof(argv[1]) : 0.0125;
    const double spacing = argc > 2 ? std::atof(argv[2]) : 0.0135;
    const double speed = argc > 3 ? std::atof(argv[3]) : 10;
    const Mesh mesh = bucket(size);
    const double share = argc > 4 ? std::atof(argv[4]) : 1.0 / 3;
    std::vector<double> x = band_around(spacing, share), v(x.size(), 0);
    const std::size_t band = x.size() / 3;
    const double l0 = spacing / 2, skin = 0.3 * spacing, m = 1000 * spacing * spacing * spacing;
    const double c0 = 100, dt = 0.25 * spacing / c0, angle = speed * dt;
    turn(x, v, 0, speed);
    const std::vector<double> mass(band, m), radius(band, l0),
        natural(band, 1e3 * c0 * c0 * spacing);
    std::vector<std::uint64_t> id(band);
    for (std::size_t i = 0; i < band; ++i) id[i] = (i * 2654435761u) % 1000003;

    PenaltyContact contact(Surface(mesh.quad, mesh.mass), LawSettings{});
    const int steps = std::min(40, int(0.9 * skin / (speed * dt * 1.05)) + 1);
    double search = 1e300, detect = 1e300, forces = 1e300, ledger = 1e300, slowest = 0;
    std::size_t active = 0, touching = 0;
    for (int cycle = 0; cycle < 5; ++cycle) {
        const double start = cpu_clock();
        contact.rebuild({x, v, mass, radius, natural, id}, skin, mesh.x, mesh.v, dt);
        search = std::min(search, cpu_clock() - start);
        active = contact.active_rows().size();
        std::vector<double> xa, va;
        for (std::uint32_t row : contact.active_rows())
            for (int axis = 0; axis < 3; ++axis) {
                xa.push_back(x[3 * row + axis]);
                va.push_back(v[3 * row + axis]);
            }
        double parts[3] = {0, 0, 0};
        for (int n = 0; n < steps; ++n) {
            const double begin = cpu_clock();
            contact.update(xa, va, mesh.x, mesh.v, dt);
            const double found = cpu_clock();
            contact.compute_forces(dt);
            const double pushed = cpu_clock();
            contact.settle();
            const double end = cpu_clock();
            parts[0] += found - begin, parts[1] += pushed - found, parts[2] += end - pushed;
            if (cycle > 0) slowest = std::max(slowest, end - begin);
            touching = contact.contacts().size();
            turn(xa, va, angle, speed);
        }
        detect = std::min(detect, parts[0] / steps);
        forces = std::min(forces, parts[1] / steps);
        ledger = std::min(ledger, parts[2] / steps);
    }
    const double step = detect + forces + ledger,
                 of_touching = touching > 0 ? 1e9 * step / double(touching) : 0,
                 per = 1e9 / double(band);
    std::printf(
        "%zu facets, %zu nodes, %zu band particles, %zu active, %zu in contact, %d steps a "
        "search\n",
        mesh.quad.size() / 4, mesh.mass.size(), band, active, touching, steps);
    std::printf("search            %8.2f ms  %6.0f ns per band particle\n", 1e3 * search,
                search * per);
    std::printf(
        "step              %8.3f ms  %6.1f ns per band particle, %.0f ns per active one, %.0f ns "
        "per "
        "contact (%.0f %% of the band)\n",
        1e3 * step, step * per, 1e9 * step / double(active), of_touching,
        100.0 * double(touching) / double(band));
    std::printf("  detect %.3f ms, forces %.3f ms, ledger %.3f ms; slowest step %.3f ms\n",
                1e3 * detect, 1e3 * forces, 1e3 * ledger, 1e3 * slowest);
}
