// The implicit viscous update: decay, momentum, threads, and how the solver is chosen.

#include <omp.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "scenes.hpp"
#include "sph_solver/physics/stable_step.hpp"
#include "sph_solver/physics/viscosity_plan.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double length = 0.4, dx = 0.01, wave = M_PI / length;   // [m], [m], [1/m]

/// Vortices in a box of free-slip walls (see herschel_bulkley.test.cpp), so viscous that the acoustic
/// step is `ratio` times the explicit limit.
struct Vortices {
    double nu, dt;
    FluidSystem fluid;

    static Case make(double ratio, ViscousForm form, double tolerance) {
        Case input = scenes::water_box(dx, {length, dx, length}, 2);
        input.info.gravity = {0, 0, 0};
        input.sph.max_speed = 0.2;
        input.sph.artificial_viscosity = 0;
        input.sph.smoothing_ratio = 1.5;
        input.sph.viscosity_solver = ViscositySolver::implicit;
        input.sph.viscosity_tolerance = tolerance;
        input.sph.viscous_form = form;
        input.sph.fluid[0].viscosity = 1000 * viscosity(ratio);
        input.sph.plane = {scenes::plane("left", {0, 0, 0}, {1, 0, 0}),
                           scenes::plane("right", {length, 0, 0}, {-1, 0, 0}),
                           scenes::plane("floor", {0, 0, 0}, {0, 0, 1}),
                           scenes::plane("lid", {0, 0, length}, {0, 0, -1})};
        return input;
    }
    static double step() { return 0.9 * dx / 2; }   // c0 = 2 m/s
    static double viscosity(double ratio) {
        return ratio * viscous_cfl * std::pow(1.5 * dx, 2) / step();
    }

    Vortices(double ratio, ViscousForm form, double tolerance)
        : nu(viscosity(ratio)), dt(step()), fluid(make(ratio, form, tolerance), 0.4) {
        Particles& p = fluid.particles;
        const double speed = 1e-3;
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.vx[i] = speed * std::sin(wave * p.x[i]) * std::cos(wave * p.z[i]);
            p.vz[i] = -speed * std::cos(wave * p.x[i]) * std::sin(wave * p.z[i]);
        }
    }
    double energy() const {
        double sum = 0;
        const Particles& p = fluid.particles;
        for (std::size_t i = 0; i < p.size(); ++i) sum += p.vx[i] * p.vx[i] + p.vz[i] * p.vz[i];
        return sum;
    }
};

void step(FluidSystem& fluid, double& t, double dt, double before) {
    fluid.refresh_neighbors(t);
    fluid.pack(t);
    fluid.sum_over_neighbors(Terms::rate);
    fluid.advance_density(before);
    fluid.pack(t);
    fluid.sum_over_neighbors(Terms::force);
    fluid.add_wall_friction();
    fluid.take_viscosity(t, dt, before);
    fluid.kick_and_drift(dt, before, 0, false);
    t += dt;
}

}  // namespace

TEST_CASE("vortices decay by exp(-2 nu k^2 t) at 1, 10 and 100 times the explicit limit") {
    const double ratio = GENERATE(1.0, 10.0, 100.0);
    const ViscousForm form = GENERATE(ViscousForm::laplacian, ViscousForm::strain);
    Vortices of(ratio, form, 1e-3);
    const double rate = 2 * of.nu * wave * wave;   // of the velocity [1/s]
    const double start = of.energy(), end = 0.5 / rate;
    double t = 0, before = 0;
    int n = 0;
    while (t < end) {
        step(of.fluid, t, of.dt, before);
        before = of.dt;
        ++n;
    }
    // the first kick is half a step
    const double exponent = 0.5 * std::log(start / of.energy()), z = rate * of.dt;
    const double exact = z * (n - 0.5);
    const double euler = std::log1p(z) * (n - 1) + std::log1p(0.5 * z);
    const ImplicitFigures& f = of.fluid.implicit_viscosity()->figures();
    WARN("ratio " << ratio << (form == ViscousForm::strain ? " strain" : " laplacian") << ": " << n << " steps, exponent/exact " << exponent / exact
                           << ", /backward Euler's " << exponent / euler << ", iterations "
                           << double(f.iterations) / double(f.steps));
    CHECK(exponent == Approx(euler).epsilon(0.01));

}
