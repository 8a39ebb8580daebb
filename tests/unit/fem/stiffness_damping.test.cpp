// Rayleigh damping by stiffness: decay of modes, energy, and the step that it leaves.

#include "fem_solver/physics/stiffness_damping.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);

/// A bar of n elements, held at x = 0, in its mode `k` (1, 2, ...), at its largest speed.
struct Bar {
    BlockCase block{{1, 0.05, 0.05}, {20, 1, 1}};
    Case c;
    double wave_number, omega;  // [1/m], [1/s] of the mesh: 2 (c/h) sin(kappa h/2)
    explicit Bar(int k) {
        block.poisson_ratio = 0;
        c = block.settings();
        c.fem.support = {{"xmin", {"x", "y", "z"}}};
        wave_number = (2 * k - 1) * pi / 2;
        omega =
            2 * std::sqrt(block.young_modulus / block.density) * 20 * std::sin(wave_number / 40);
    }
    void start(Structure& structure) const {
        for (std::size_t n = 0; n < structure.nodes().size(); ++n)
            structure.nodes().v[n].c[0] =
                1e-3 * std::sin(wave_number * structure.nodes().x[n].c[0]);
    }
};

TEST_CASE("two modes of a bar decay at beta omega^2/2, and the energy lost is booked") {
    const double beta = 1e-5;
    for (int k : {1, 3}) {
        Bar bar(k);
        bar.c.fem.damping_beta = beta;
        Structure structure(build_model(bar.c), 1);
        bar.start(structure);
        const double rate = 0.5 * beta * bar.omega * bar.omega, ratio = rate / bar.omega;
        // to about 1/e in whole periods, after one more: the energy falls in waves
        const double period = 2 * pi / (bar.omega * std::sqrt(1 - ratio * ratio));
        const int in_period = int(std::ceil(period / (0.2 * structure.stable_step().dt)));
        const double dt = period / in_period;
        const int steps = in_period * std::max(1, int(1 / (rate * period)));
        const auto stored = [&](const Energies& e) { return e.kinetic + e.internal + e.hourglass; };
        Energies start, e;
        march(structure, dt, in_period + steps + 1, [&](int n) {
            e = structure.energies();
            if (n == in_period) start = e;
        });
        const double first = stored(start), left = stored(e);
        const double measured = -0.5 * std::log(left / first) / (steps * dt);
        WARN("mode " << k << ": damping ratio " << 0.5 * beta * bar.omega << ", rate "
                     << measured / rate - 1 << " off theory in " << steps << " steps");
        // The velocity that is taken lags by half a step; that also moves the frequency by
        // ratio omega dt/2, so that the waves of the energy are met 0.03 rad off.
        CHECK(measured == Approx(rate * (1 + ratio * bar.omega * dt)).epsilon(2e-3));
        CHECK(e.damping - start.damping == Approx(first - left).epsilon(1e-6));
        CHECK(std::abs(e.balance_error() - start.balance_error()) < 1e-6 * first);
    }
}

TEST_CASE("the step leaves room for the lag of damping by stiffness, and no more") {
    BlockCase block{{0.4, 0.3, 0.2}, {4, 3, 2}};
    Case c = block.settings();
    const double plain = Structure(build_model(c), 1).stable_step().dt;
    const double omega = 2 * c.fem.cfl / plain;
    c.fem.damping_beta = 1 / omega;  // half of critical in the fastest mode
    c.fem.cfl = 0.99;
    const auto speed_after = [&](double share) {
        Structure structure(build_model(c), 1);
        const double dt = share * structure.stable_step().dt;
        const double expected = 2 / omega * (std::sqrt(0.99 * 0.99 + 0.25) - 0.5);
        CHECK(structure.stable_step().dt == Approx(expected).epsilon(1e-3));
        structure.nodes().v[0].c[0] = structure.nodes().v[7].c[1] = 1e-6;
        march(structure, dt, 400);
        return std::sqrt(2 * std::abs(structure.kinetic_energy()) / 24);
    };
    CHECK(speed_after(1) < 1e-6);
    CHECK(!(speed_after(1.08) < 1e-3));  // Lanczos keeps 1 %, cfl 1 %
}

TEST_CASE("shells and elements of other kinds are damped by stiffness as well, rotations too") {
    BlockCase block{{1, 0.2, 0}, {10, 2, 0}};
    block.cells = BlockCells::shells;
    block.element = ElementFormulation::shell;
    block.poisson_ratio = 0;
    Case c = block.settings();
    c.fem.part[0].thickness = 0.02;
    c.fem.support = {{"xmin", {"clamp"}}};
    // first bending frequency of a clamped strip
    const double omega = std::pow(first_cantilever_root, 2) *
                         std::sqrt(block.young_modulus * 0.02 * 0.02 / (12 * block.density));
    c.fem.damping_beta = 0.1 / omega;  // 5 % of critical
    Structure structure(build_model(c), 1);
    for (std::size_t n = 0; n < structure.nodes().size(); ++n)
        structure.nodes().v[n].c[2] = 1e-4 * std::pow(structure.nodes().x[n].c[0], 2);
    const double dt = structure.stable_step().dt;
    // once all but the first mode is gone, by e per 1/(0.05 omega)
    const int wait = int(2 * pi / omega / dt), span = int(1 / (0.05 * omega) / dt);
    double at_first = 0;
    const auto energy = [&] {
        const Energies e = structure.energies();
        return e.kinetic + e.internal + e.hourglass;
    };
    march(structure, dt, wait + span, [&](int n) {
        if (n == wait) at_first = energy();
    });
    const double measured = -0.5 * std::log(energy() / at_first) / (span * dt);
    WARN("strip of shells: rate " << measured / (0.05 * omega) - 1 << " off theory");
    CHECK(measured == Approx(0.05 * omega).epsilon(0.03));  // f1 of the mesh is 1 % low
    CHECK_THROWS_WITH(
        [&] {
            Case implicit = BlockCase().settings();
            implicit.fem.part[0].implicit = true;
            implicit.time.max_step = 1e-4;
            implicit.fem.damping_beta = 1e-5;
            build_model(implicit);
        }(),
        Catch::Contains("damping_beta has no effect"));
}

}  // namespace
}  // namespace undertow::fem
