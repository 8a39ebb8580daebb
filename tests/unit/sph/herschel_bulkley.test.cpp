// Viscosity of viscoplastic fluids: the law, the shear rate, and the stress it makes.

#include "sph_solver/physics/herschel_bulkley.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>

#include "scenes.hpp"
#include "sph_solver/physics/stable_step.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr HerschelBulkley slide{7.3, 3, 0.35, 0, 1000};

}  // namespace

TEST_CASE("the flow curve is tau_y + K gd^n beyond the cap") {
    // exp(-mu_max gd/tau_y) is below 1e-12 from gd = 0.2 on
    for (const double gd : {0.2, 1.0, 10.0, 80.0})
        CHECK(slide(gd) * gd == Approx(7.3 + 3 * std::pow(gd, 0.35)).epsilon(1e-10));
    CHECK(slide(5.0f) * 5.0f == Approx(slide(5.0) * 5).epsilon(1e-6));
}

TEST_CASE("the viscosity falls from its cap at rest without a jump, and never rises with shear") {
    CHECK(slide(0.0) == 1000);
    CHECK(slide(0.0f) == 1000);
    double before = slide(0.0);
    for (double gd = 1e-8; gd < 1e3; gd *= 1.1) {
        const double mu = slide(gd);
        CHECK(mu <= before);
        CHECK(mu >= 0.8 * before);  // steps of 10 %: at most mu ~ 1/gd
        before = mu;
    }
    // both sides of the switch to the exact limit
    const double at = 1e-4 * 7.3 / 1000;
    CHECK(slide(0.999 * at) == Approx(slide(1.001 * at)).epsilon(1e-6));
}

TEST_CASE("Bingham, power law and Newton are its special cases") {
    const HerschelBulkley bingham{5, 2, 1, 0, 1e6};
    CHECK(bingham(4.0) == Approx(5.0 / 4 + 2));
    const HerschelBulkley thickening{0, 2, 1.5, 0, 1e6};
    CHECK(thickening(0.0) == 0);
    CHECK(thickening(4.0) == Approx(2 * std::sqrt(4.0)));
    const HerschelBulkley newton{0, 2, 1, 0.5, 1e6};
    CHECK(newton(0.0) == 2.5);
    CHECK(newton(7.0) == 2.5);
}

TEST_CASE("a linear shear has its shear rate in any arrangement, at the surface too") {
    const int dimension = GENERATE(2, 3);
    const bool plastic_alone = GENERATE(false, true);
    const double rate = 3;  // [1/s]
    Case input = scenes::two_layers(0.01, {0.14, 0.14, 0.14}, 0.07, true, dimension);
    if (plastic_alone) {
        input.sph.fluid.erase(input.sph.fluid.begin());
        input.sph.fill.pop_back();
        input.sph.fill[0].fluid = "slide";
    }
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.2, 0, 0);
    Particles& p = fluid.particles;
    // vx = gd z, plus a rotation and an expansion, which do not shear
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.vx[i] = rate * p.z[i] + 2 * p.z[i];
        p.vz[i] = -2 * p.x[i];
        if (dimension == 3)
            p.vx[i] += 0.5 * p.x[i], p.vy[i] = 0.5 * p.y[i], p.vz[i] += 0.5 * p.z[i];
    }
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::force);
    int plastic = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const FluidLaw& law = fluid.fluid_of(i);
        if (!law.viscoplastic()) {
            CHECK(p.viscosity[i] == 1e-3f);
            continue;
        }
        // exact in a linear field up to float32 sums
        CHECK(p.shear_rate[i] == Approx(rate).epsilon(1e-4));
        CHECK(p.viscosity[i] == Approx(law.rheology(rate)).epsilon(1e-4));
        ++plastic;
    }
    CHECK(plastic > 90);
}

TEST_CASE(
    "a fluid that moves as a block has its largest viscosity, and the step it was chosen for") {
    Case input = scenes::two_layers(0.01, {0.1, 0.1, 0.1}, 0.05, true);
    for (Fill& fill : input.sph.fill) fill.velocity = {5, 0, 0};
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    fluid.sum_over_neighbors(Terms::force);
    const double cap = fluid.fluid(1).rheology.max_viscosity;
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        if (fluid.particles.fluid[i] == 1) CHECK(fluid.particles.viscosity[i] == float(cap));
    // the acoustic limit of fluid at rest is met exactly
    const Health health = fluid.health();
    const double cfl = acoustic_cfl(input.sph), h = fluid.physics().h;
    StepLimits limits{h, fluid.largest_sound_speed(), 0, 0, health.max_kinematic_viscosity};
    CHECK(std::string(stable_step(limits, cfl * 0.999, 0.25).limiter) == "sound");
    limits.max_kinematic_viscosity *= 1.01;
    const StableStep step = stable_step(limits, cfl, 0.25);
    CHECK(std::string(step.limiter) == "viscosity");
    CHECK(step.dt == Approx(cfl * h / limits.c0).epsilon(0.02));
}

TEST_CASE("a cap below the Newtonian viscosity is refused, and so is none where none is left") {
    Case input = scenes::two_layers(0.01, {0.1, 0.1, 0.1}, 0.05, true);
    input.sph.fluid[1].viscosity = 10;
    input.sph.fluid[1].max_viscosity = 5;
    CHECK_THROWS_WITH(FluidSystem(input, 0.2), Catch::Contains("\"slide\": max_viscosity = 5") &&
                                                   Catch::Contains("10 Pa s"));
    input.sph.fluid[1].viscosity = 1e5;
    input.sph.fluid[1].max_viscosity = 0;
    input.sph.viscosity_solver = ViscositySolver::explicit_sums;
    CHECK_THROWS_WITH(FluidSystem(input, 0.2), Catch::Contains("give max_viscosity"));
}

namespace {

/// Four vortices in a box of free-slip walls, vx = U sin kx cos kz, vz = -U cos kx sin kz:
/// an exact flow, whose energy falls as exp(-4 nu k^2 t)  [Taylor & Green 1937]. So slow that
/// particles move a third of a spacing: the lattice stays, and with it the accuracy of the sums.
/// Returns the fall's exponent over the exact one.
double decay_of_vortices(const Fluid& of, double nu, double h_over_dx) {
    const double length = 0.4, dx = 0.01, k = M_PI / length, speed = 1e-3;
    Case input = scenes::water_box(dx, {length, dx, length}, 2);
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 0.2;
    input.sph.artificial_viscosity = 0;
    input.sph.smoothing_ratio = h_over_dx;
    input.sph.fluid = {of};
    input.sph.plane = {scenes::plane("left", {0, 0, 0}, {1, 0, 0}),
                       scenes::plane("right", {length, 0, 0}, {-1, 0, 0}),
                       scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                       scenes::plane("lid", {0, 0, length}, {0, 0, -1})};
    FluidSystem fluid(input, 0.4);
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.vx[i] = speed * std::sin(k * p.x[i]) * std::cos(k * p.z[i]);
        p.vz[i] = -speed * std::cos(k * p.x[i]) * std::sin(k * p.z[i]);
    }
    const auto energy = [&] {
        double sum = 0;
        for (std::size_t i = 0; i < p.size(); ++i) sum += p.vx[i] * p.vx[i] + p.vz[i] * p.vz[i];
        return sum;
    };
    const double start = energy();
    const double end = 0.25 / (nu * k * k);  // a fall to 1/e
    const double dt =
        std::min(0.9 * dx / fluid.fluid().c0, viscous_cfl * std::pow(fluid.physics().h, 2) / nu);
    double t = 0, before = 0;
    while (t < end) {
        scenes::two_pass_step(fluid, t, dt, before);
        before = dt;
    }
    return -std::log(energy() / start) / (4 * nu * k * k * (t - 0.5 * dt));
}

}  // namespace

TEST_CASE("vortices between free-slip walls decay by the viscosity, Newtonian or of a shear rate") {
    Fluid newtonian;
    newtonian.name = "water";  // of the scene's fill
    newtonian.viscosity = 1;
    Fluid by_shear_rate = newtonian;  // K gd^1 through strain rate, cap, and pair means
    by_shear_rate.viscosity = 0;
    by_shear_rate.consistency = 1;
    const double one = decay_of_vortices(newtonian, 1e-3, 1.5);
    const double other = decay_of_vortices(by_shear_rate, 1e-3, 1.5);
    INFO("exponents over exact: " << one << ", " << other);
    CHECK(one == Approx(1).epsilon(0.01));  // Morris' Laplacian on a lattice at h = 1.5 dx: 0.34 %
    CHECK(other == Approx(one).epsilon(1e-3));
}

TEST_CASE("a slide at its largest viscosity calms down at the acoustic step that goes with it") {
    const Integrator integrator = GENERATE(Integrator::one_pass, Integrator::two_pass);
    const Vec3 size{0.1, 0.1, 0.1};
    Case input = scenes::two_layers(0.01, size, 0.05, true);
    input.sph.fluid[1].yield_stress = 1e6;  // never yields: the cap everywhere
    input.sph.viscosity_solver = ViscositySolver::explicit_sums;
    input.sph.integrator = integrator;
    scenes::add_basin(input, size);
    FluidSystem fluid(input, 0.4);
    scenes::disturb(fluid, 0.1, 0.05, 0);
    const bool two_pass = integrator == Integrator::two_pass;
    const double dt = acoustic_cfl(input.sph) * fluid.physics().h / fluid.largest_sound_speed();
    const auto energy_of_slide = [&] {
        double sum = 0;
        const Particles& p = fluid.particles;
        for (std::size_t i = 0; i < p.size(); ++i)
            if (p.fluid[i] == 1) sum += p.vx[i] * p.vx[i] + p.vy[i] * p.vy[i] + p.vz[i] * p.vz[i];
        return sum;
    };
    const double start = energy_of_slide();
    double t = 0, before = 0, before_that = 0;
    for (int n = 0; n < 200; ++n) {
        if (two_pass) {
            scenes::two_pass_step(fluid, t, dt, before);
        } else {
            fluid.refresh_neighbors(t);
            fluid.pack(t);
            fluid.sum_over_neighbors(Terms::both);
            fluid.kick_and_drift(dt, before, before_that, true);
            t += dt;
        }
        before_that = before, before = dt;
    }
    // 0.2 %: a slow motion of the whole under disordered water. At 1.5 times this step it is the
    // same.
    CHECK(energy_of_slide() < 0.01 * start);
}

TEST_CASE("a shear rate is held while sound goes two spacings, then found anew") {
    Case input = scenes::two_layers(0.01, {0.1, 0.1, 0.1}, 0.05, true);
    input.sph.viscosity_solver = ViscositySolver::explicit_sums;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.1, 1, 0);
    Particles& p = fluid.particles;
    const double dt = 0.9 * fluid.spacing() / fluid.largest_sound_speed();
    double t = 0;
    scenes::two_pass_step(fluid, t, dt, dt);
    std::vector<std::pair<std::int64_t, float>> before;  // found in the first step
    const auto rates = [&] {
        std::vector<std::pair<std::int64_t, float>> of;
        for (std::size_t i = 0; i < p.size(); ++i)
            if (p.fluid[i] == 1) of.push_back({p.id[i], p.shear_rate[i]});
        std::sort(of.begin(), of.end());
        return of;
    };
    before = rates();
    scenes::two_pass_step(fluid, t, dt, dt);
    scenes::two_pass_step(fluid, t, dt, dt);  // 1.8 dx: whoever was sorted has kept its own
    CHECK(rates() == before);
    scenes::two_pass_step(fluid, t, dt, dt);
    CHECK(rates() != before);
}

TEST_CASE("a step that holds the shear rate has the forces of one that finds it") {
    const bool alone = GENERATE(true, false);
    Case input = scenes::two_layers(0.01, {0.12, 0.1, 0.11}, 0.05, true);
    if (alone) {
        input.sph.fluid.erase(input.sph.fluid.begin());
        input.sph.fill.pop_back();
        input.sph.fill[0].fluid = "slide";
    }
    input.sph.viscosity_solver = ViscositySolver::explicit_sums;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.15, 1, 2000);
    fluid.refresh_neighbors(0);
    for (int k = 0; k < 2; ++k) {  // viscosities that differ
        fluid.pack(0);
        fluid.sum_over_neighbors(Terms::both);
    }
    const Particles found = fluid.particles;
    sum_over_neighbors(fluid.physics(), fluid.neighbors(), NoSlipImages(), Terms::both,
                       fluid.particles, ShearRate::held);
    double largest = 0, error = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        largest = std::max<double>(largest, std::abs(found.ax[i]));
        error = std::max<double>(error, std::abs(found.ax[i] - fluid.particles.ax[i]));
    }
    CHECK(largest > 0);
    CHECK(error < 1e-6 * largest);  // two loops of one formula: round-off
    CHECK(found.viscosity == fluid.particles.viscosity);
}
