// Viscoplastic bodies that come to rest, or never leave it.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "scenes.hpp"
#include "sph_solver/physics/stable_step.hpp"
#include "sph_solver/physics/viscosity_plan.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double dx = 0.01, height = 0.1, width = 0.2, rho = 1600, g = 9.81;  // SI

/// Half a heap on a floor that holds it, beside a plane of symmetry.
Case heap(double yield_stress, ViscositySolver solver, ViscousForm form) {
    Case input = scenes::water_box(dx, {width, dx, height}, 2);
    Fluid& f = input.sph.fluid[0];
    f.density = rho, f.viscosity = 0;
    f.yield_stress = yield_stress, f.consistency = 20;
    input.sph.smoothing_ratio = 1.5;
    input.sph.tension_control = TensionControl::none;   // a corner counts as spray, and creeps
    input.sph.viscosity_solver = solver;
    input.sph.viscous_form = form;
    input.sph.plane = {scenes::plane("floor", {0, 0, 0}, {0, 0, 1}, Slip::no_slip),
                       scenes::plane("middle", {0, 0, 0}, {1, 0, 0})};
    return input;
}

FluidSystem run(const Case& input, double end) {
    FluidSystem fluid(input, 0.4);
    double t = 0, before = 0;
    Health health = fluid.health();
    while (t < end) {
        const double c0 = fluid.largest_sound_speed();
        const double stable = stable_step({fluid.physics().h, c0, health.max_speed,
                                           health.max_acceleration, health.max_kinematic_viscosity},
                                          acoustic_cfl(input.sph), input.sph.force_cfl)
                                  .dt;
        const double dt = before > 0 ? std::min(stable, 1.05 * before) : stable;
        health = scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
    return fluid;
}

double runout(const FluidSystem& fluid) {
    double far = 0;
    for (const double x : fluid.particles.x) far = std::max(far, x + dx / 2);
    return far;
}

}  // namespace

namespace {

/// Final shape of a heap that yields all through. Thrust and friction along the floor balance,
///   d/dx [rho g h^2/2 - (pi/2) tau_y h] = -tau_y    so    h^2/(2 l) - (pi/2) h = L - x,   l = tau_y/(rho g)
/// with the horizontal tension 2 sqrt(tau_y^2 - tau^2) of a plastic layer that spreads, tau linear in
/// depth (Nye 1951). It ends as a cliff, pi l high. Without that tension (a thin layer) h^2 = 2 l (L - x).
struct FinalHeap {
    double l, L;   // [m]

    FinalHeap(double tau_y, double area) : l(tau_y / (rho * g)) {
        const auto volume = [&](double h) { return h * h * h / (3 * l) - M_PI / 4 * h * h; };
        double low = M_PI * l, high = 1;   // of the height at x = 0
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (low + high);
            (volume(middle) - volume(M_PI * l) < area ? low : high) = middle;
        }
        L = low * low / (2 * l) - M_PI / 2 * low;
    }
    double height(double x) const {
        return l * (M_PI / 2 + std::sqrt(M_PI * M_PI / 4 + 2 * (L - x) / l));
    }
};

}  // namespace

TEST_CASE("a slow heap comes to rest in the shape that its yield stress holds") {
    const double tau_y = 100;
    const FluidSystem fluid = run(heap(tau_y, ViscositySolver::implicit, ViscousForm::strain), 4);
    const FinalHeap exact(tau_y, height * width);
    INFO("runout " << runout(fluid) << ", exact " << exact.L);
    // 0.387 against 0.356 m, still creeping on by 7 mm/s; 0.375 with dx = 6.7 mm
    CHECK(runout(fluid) == Approx(exact.L).epsilon(0.1));
    double error = 0, size = 0;
    for (double x = dx; x < 0.85 * exact.L; x += dx) {
        double volume = 0;  // of a column two spacings wide
        for (std::size_t i = 0; i < fluid.particles.size(); ++i)
            if (std::abs(fluid.particles.x[i] - x) < dx) volume += dx * dx;
        const double h = volume / (2 * dx), wanted = exact.height(x);
        error += (h - wanted) * (h - wanted), size += wanted * wanted;
    }
    INFO("profile off by " << std::sqrt(error / size));
    CHECK(std::sqrt(error / size) < 0.1);
}

TEST_CASE("a block that its yield stress carries stands, where the capped explicit one spreads") {
    const double tau_y = 2000;  // half of rho g height is 785 Pa
    const FluidSystem stands =
        run(heap(tau_y, ViscositySolver::implicit, ViscousForm::strain), 0.5);
    const FluidSystem spreads =
        run(heap(tau_y, ViscositySolver::explicit_sums, ViscousForm::laplacian), 0.5);
    CHECK(runout(stands) < width + 0.1 * dx);
    CHECK(runout(spreads) > width + 3 * dx);
    const Creep creep = creep_of(stands.fluid(), 0, stands.particles);
    CHECK(creep.share_at_cap > 0.1);
    CHECK(creep.rate < 0.1);  // [1/s]
}
