// A longitudinal pulse along a bar against d'Alembert.

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"

namespace undertow::fem {
namespace {

/// Relative L2 error of the velocity after the pulse (Gaussian, sigma in elements) has run 200
/// elements. Side motion is held: a plane wave with c = sqrt((lambda + 2 mu)/rho).
double dalembert_error(double cfl, double sigma) {
    const int n_elements = 400;
    const double h = 0.01;
    BlockCase block{{n_elements * h, h, h}, {n_elements, 1, 1}};
    Case c = block.settings();
    c.fem.support = {{"block", {"y", "z"}}};
    Structure s(build_model(c), 1);
    const LinearElastic law = LinearElastic::from_young(block.young_modulus, block.poisson_ratio);
    const double c0 = std::sqrt((law.lambda + 2 * law.mu) / block.density);
    const double travel = 200 * h, dt_wanted = cfl * h / c0;
    const int steps = int(std::ceil(travel / c0 / dt_wanted - 1e-9));
    const double dt = travel / c0 / steps;
    // A wave running right: u(x - c t), v = -c u', small so that strains stay below 1e-6. Positions
    // start at t = 0, velocities at -dt/2; the half kick at the start wants them at 0.
    const double amplitude = 1e-8;
    const auto u = [&](double X) { return amplitude * std::exp(-X * X / (2 * sigma * sigma)); };
    const auto velocity = [&](double x, double t) {
        const double X = (x - 100 * h - c0 * t) / h;
        return c0 / h * X / (sigma * sigma) * u(X);
    };
    Nodes& nodes = s.nodes();
    // the stress of the start enters by one step that displaces the rest shape to u(x, 0)
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double ux = u((nodes.x0[n].c[0] - 100 * h) / h);
        nodes.x[n].c[0] += ux;
        nodes.v[n].c[0] = ux / dt;
    }
    s.elements().step(nodes, dt, 1);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        as_row(nodes.f[n]) = Row{};
        nodes.v[n].c[0] = 0;
    }
    s.elements().step(nodes, dt, 1);  // forces of that stress, no strain
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        nodes.v[n].c[0] = velocity(nodes.x0[n].c[0], 0);
    }
    s.kick(dt);  // dt_before = 0: v^{1/2}
    s.drift(dt);
    march(s, dt, steps - 1);
    double error = 0, size = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double exact = u((nodes.x0[n].c[0] - 100 * h - travel) / h);
        error += std::pow(nodes.x[n].c[0] - nodes.x0[n].c[0] - exact, 2);
        size += exact * exact;
    }
    return std::sqrt(error / size);
}

TEST_CASE("a pulse runs 200 elements along a bar with the error of the scheme's dispersion") {
    // one-point elements with lumped mass: exact at CFL 1, and the phase error falls with sigma^2
    const double fast = dalembert_error(0.9, 10), slow = dalembert_error(0.5, 10);
    const double smooth = dalembert_error(0.9, 20);
    WARN("d'Alembert error after 200 elements: CFL 0.9 sigma 10: "
         << fast << ", CFL 0.5: " << slow << ", CFL 0.9 sigma 20: " << smooth);
    CHECK(fast < 3e-3);
    CHECK(slow < 1e-2);
    CHECK(smooth < fast / 3);
}

}  // namespace
}  // namespace undertow::fem
