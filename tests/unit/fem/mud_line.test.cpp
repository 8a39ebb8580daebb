// The mud line under a slide: clay that flows must sink smoothly, though the forces on its nodes
// are noisy.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "support.hpp"

namespace undertow::fem {
namespace {

/// How the pressure at a node of the surface differs from the mean, as a share of it.
struct Noise {
    double alternating = 0;  // from neighbor to neighbor, all the time
    double random = 0;       // anew every 2 ms, by up to this
};

struct Surface {
    std::vector<double> settlement;  // [m] of the nodes well inside the loaded part
    std::vector<double> sign;        // of the alternating pattern there
    double hourglass;                // over plastic energy
};

constexpr double h = 0.25;  // [m] edge of an element

/// A layer of clay, 4 x 2 x 2 m, elements as in the bucket's case, under a pressure on x < 1.5 m
/// for 0.1 s, as the toe of a slide brings it. s_u = 9.54 kPa carries 49 kPa.
Surface pressed(double pressure, const Noise& noise) {
    Case c = BlockCase{{4, 2, 2}, {16, 8, 12}, 4.77e6, 0.49, 1846}.settings();
    c.fem.block->box = {{0, 0, -2}, {4, 2, 0}};
    c.fem.material[0].kind = MaterialKind::tresca;
    c.fem.material[0].shear_strength = 9540;
    c.fem.support = {{"zmin", {"x", "y", "z"}},
                     {"xmin", {"x"}},
                     {"xmax", {"x"}},
                     {"ymin", {"y"}},
                     {"ymax", {"y"}}};
    c.fem.bulk_viscosity_linear = 0.06;
    c.fem.bulk_viscosity_quadratic = 1.2;
    Structure s(build_model(c), 1);
    Nodes& nodes = s.nodes();
    struct Loaded {
        std::int32_t node;
        double area, sign, random;
    };
    std::vector<Loaded> loaded;
    Surface out{};
    std::vector<std::int32_t> inside;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double x = nodes.x0[n].c[0], y = nodes.x0[n].c[1];
        if (nodes.x0[n].c[2] < -1e-9 || x > 1.5 + 1e-9) continue;
        const double edges = (x < 1e-9 ? 0.5 : 1) * (y < 1e-9 || y > 2 - 1e-9 ? 0.5 : 1);
        const double sign = (std::lround(x / h) + std::lround(y / h)) % 2 == 0 ? 1 : -1;
        loaded.push_back({std::int32_t(n), edges * h * h, sign, 0});
        if (x > 0.5 * h && x < 1.1 && y > 0.5 * h && y < 2 - 0.5 * h) {
            inside.push_back(std::int32_t(n));
            out.sign.push_back(sign);
        }
    }
    std::uint32_t state = 7;
    double t = 0, next = 0;
    while (t < 0.1) {
        const double dt = s.stable_step().dt;
        if (t >= next) {
            for (Loaded& l : loaded) {
                state = state * 1664525u + 1013904223u;
                l.random = 2.0 * state / 4294967296.0 - 1;
            }
            next += 2e-3;
        }
        s.internal_forces();
        const double p = pressure * std::min(1.0, t / 0.02);
        for (const Loaded& l : loaded)
            nodes.f[l.node].c[2] -=
                p * l.area * (1 + noise.alternating * l.sign + noise.random * l.random);
        s.kick(dt);
        s.drift(dt);
        t += dt;
    }
    for (std::int32_t n : inside) out.settlement.push_back(-s.displacement(n)[2]);
    const Energies e = s.energies();
    out.hourglass = e.hourglass / e.plastic;
    return out;
}

double mean(const std::vector<double>& a) {
    double sum = 0;
    for (double v : a) sum += v;
    return sum / double(a.size());
}

TEST_CASE("clay under a slide's toe sinks smoothly, however noisy the forces on its nodes") {
    const double pressure = GENERATE(4e4, 5e4, 6e4);
    const Surface smooth = pressed(pressure, {}), alternating = pressed(pressure, {0.1, 0}),
                  random = pressed(pressure, {0, 0.2});
    const double sink = mean(smooth.settlement);
    double saw = 0, own = 0, spread = 0;
    for (std::size_t k = 0; k < smooth.sign.size(); ++k) {
        own += smooth.sign[k] * smooth.settlement[k] / double(smooth.sign.size());
        saw += smooth.sign[k] * (alternating.settlement[k] - smooth.settlement[k]) /
               double(smooth.sign.size());
        spread += std::pow(random.settlement[k] - smooth.settlement[k], 2);
    }
    spread = std::sqrt(spread / double(smooth.sign.size()));
    WARN(1e-3 * pressure << " kPa: settlement " << 1e3 * sink
                         << " mm; saw-tooth under pressures that "
                            "alternate by 10 %: "
                         << 1e3 * saw << " mm, that vary at random by 20 %: " << 1e3 * spread
                         << " mm; hourglass over plastic energy " << smooth.hourglass << ", "
                         << alternating.hourglass << ", " << random.hourglass);
    CHECK(sink > 0.01);  // it flows
    CHECK(std::abs(own) < 0.02 * sink);
    // 7, 13, 19 %. A mesh of four times the resolution under the same loads: 3, 5, 8 %. With
    // hourglass stresses bounded by 5 % of the strength where the mean stress flows it was 293 % at
    // 50 kPa.
    CHECK(saw < 0.3 * sink);
    CHECK(spread < 0.05 * sink);  // 2 to 3 %; was 7 %
}

TEST_CASE("an element that folds ends the run, though its volume is kept") {
    Case c = BlockCase{{1, 1, 1}, {2, 2, 2}, 4.77e6, 0.49, 1846}.settings();
    Structure s(build_model(c), 1);
    const auto saw_tooth = [&](double up) {  // [m] neighbors at the top go up and down by that
        for (std::size_t n = 0; n < s.nodes().size(); ++n) {
            const NodeRow& x0 = s.nodes().x0[n];
            if (x0.c[2] < 0.99) continue;
            const double sign = std::lround(2 * (x0.c[0] + x0.c[1])) % 2 == 0 ? 1 : -1;
            s.nodes().x[n].c[2] = x0.c[2] + sign * up;
        }
        s.internal_forces();
    };
    // A corner that goes down sees its neighbors come up, but its own edge down to 0.5 - up: its
    // Jacobian falls in proportion and is -1 where up = 1.
    saw_tooth(0.9);
    CHECK_NOTHROW(s.check_health(0, 0));
    saw_tooth(1.1);
    CHECK(s.report().relative_volume > 0.99);
    CHECK_THROWS_WITH(s.check_health(0, 0), Catch::Contains("of block has folded at"));
    CHECK_NOTHROW(s.check_health(1, 0));  // not in every step
}

}  // namespace
}  // namespace undertow::fem
