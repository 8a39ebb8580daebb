// Prisms, overlaps, bodies that fills leave free, and the pressure under layers.

#include "sph_solver/setup/fill.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "sph_solver/setup/fill_plan.hpp"
#include "sph_solver/setup/start.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// Water 4 x 1 x 2 m deep with a 45 degree wedge of mud in it, spacing 0.125 m.
Case scene() {
    Case c;
    c.sph.present = true;
    c.sph.spacing = 0.125;
    c.sph.fluid = {{.name = "water", .density = 1000}, {.name = "mud", .density = 1600}};
    c.sph.fill = {{.fluid = "water", .box = {{0, 0, 0}, {4, 1, 2}}},
                  {.fluid = "mud",
                   .box = {{0, 0, 0}, {2, 1, 1}},
                   .profile = {{0, 0}, {2, 0}, {1, 1}, {0, 1}}}};
    return c;
}

std::vector<FluidLaw> laws(const Case& c) {
    std::vector<FluidLaw> all;
    for (const Fluid& f : c.sph.fluid) {
        FluidLaw law;
        law.rho0 = f.density;
        law.c0 = 50;
        law.us_up = {law.rho0, law.c0, 0, 0};
        all.push_back(law);
    }
    return all;
}

}  // namespace

TEST_CASE("where fills overlap the later one has the place, and no place is filled twice") {
    const Case c = scene();
    const Filled f = fill_particles(c, laws(c));
    CHECK(f.particles.size() == 32 * 8 * 16);
    int mud = 0;
    for (std::size_t i = 0; i < f.particles.size(); ++i) mud += f.particles.fluid[i];
    // rows of the wedge: 8.5 to 15.5 cells wide on average, 8 rows, 8 across; the face's half cells
    // all fall on one side
    CHECK(mud == (9 + 10 + 11 + 12 + 13 + 14 + 15 + 16) * 8 - 8 * 8);
    CHECK(f.first_id == std::vector<std::int64_t>{0, 4096 - mud, 4096});
    CHECK(f.particles.fluid[f.first_id[1]] == 1);
    CHECK(f.particles.fluid[f.first_id[1] - 1] == 0);
}

TEST_CASE("a particle starts under the weight of all layers above it") {
    const Case c = scene();
    const auto fluids = laws(c);
    const FillPlan plan(c);
    const std::vector<double> density{1000, 1600};
    CHECK(plan.pressure_at({3.5625, 0.5, 0.0625}, density, 10) == Approx(1000 * 10 * 1.9375));
    // 1 m of water over 0.9375 m of mud
    CHECK(plan.pressure_at({0.5625, 0.5, 0.0625}, density, 10) ==
          Approx(10 * (1000 * 1.0 + 1600 * 0.9375)));
    const Filled f = fill_particles(c, fluids);
    for (std::size_t i = 0; i < f.particles.size(); ++i) {
        const Particles& p = f.particles;
        const double expected = plan.pressure_at({p.x[i], p.y[i], p.z[i]}, density, 9.81);
        CHECK(fluids[p.fluid[i]].pressure(p.drho[i], 0) == Approx(expected).epsilon(1e-9));
    }
}

TEST_CASE("a fill with a ramp starts so far behind that it is let go where the case says") {
    Case c = scene();
    c.sph.fill[1].box = {{1, 0, 0}, {3, 1, 1}};
    c.sph.fill[1].profile = {{1, 0}, {3, 0}, {2, 1}, {1, 1}};
    c.sph.fill[1].velocity = {5, 0, 0};
    c.sph.fill[1].ramp = 0.4;   // 1 m
    const Filled behind = fill_particles(c, laws(c));
    const Filled there = fill_particles(scene(), laws(scene()));
    REQUIRE(behind.particles.size() == there.particles.size());
    CHECK(behind.first_id == there.first_id);
    for (std::size_t i = 0; i < there.particles.size(); ++i) {
        CHECK(behind.particles.x[i] == Approx(there.particles.x[i]));
        CHECK(behind.particles.vx[i] == 0);
    }
}

TEST_CASE("fills leave a cylinder free: nobody nearer than half a spacing, volume right in the mean") {
    Case c = scene();
    c.sph.spacing = 0.0625;
    c.sph.fill.pop_back();
    c.sph.obstacle = {{.name = "pile", .shape = {.from = {2.01, 0.5, -1}, .to = {2.01, 0.5, 1}, .radius = 0.4}}};
    const Filled f = fill_particles(c, laws(c));
    for (std::size_t i = 0; i < f.particles.size(); ++i) {
        const double r = std::hypot(f.particles.x[i] - 2.01, f.particles.y[i] - 0.5);
        CHECK((r > 0.4 + 0.03125 - 1e-9 || f.particles.z[i] > 1 + 0.03125 - 1e-9));
    }
    const double volume = f.particles.size() * std::pow(0.0625, 3);
    // the count of lattice points in a circle of 6.4 spacings is right to 1 or 2 %
    CHECK(8 - volume == Approx(M_PI * 0.4 * 0.4 * 1).epsilon(0.03));
}

TEST_CASE("fills leave a box free") {
    Case c = scene();
    c.sph.fill.pop_back();
    c.sph.obstacle = {{.name = "block", .shape = {.box = Box{{1, 0, 0}, {2, 1, 1}}}}};
    const Filled f = fill_particles(c, laws(c));
    CHECK(f.particles.size() == 4096 - 8 * 8 * 8);
}

TEST_CASE("a held block stands still, follows its ramp and arrives where the case says") {
    Case c = scene();
    c.start.settle = 0.1;
    c.sph.fill[1].velocity = {5, 0, 0};
    c.sph.fill[1].ramp = 0.2;
    Filled f = fill_particles(c, laws(c));
    const Start start(c, f.first_id, 50);
    CHECK(start.end() == Approx(0.3));
    CHECK(start.damping() == Approx(M_PI * 50 / 2));
    Particles& p = f.particles;
    const std::size_t mud = f.first_id[1], water = 0;
    const double x0 = p.x[mud], dt = 1e-3;
    const auto push = [&] {
        for (std::size_t i = 0; i < p.ax.size(); ++i) p.ax.set(i, 3);  // whatever pushes
    };
    double last_dt = 0, t = 0;
    for (int n = 0; t < 0.3 - 1e-9; ++n, t = n * dt, last_dt = dt) {
        push();
        const double kick = 0.5 * (dt + last_dt);
        start.constrain(t, dt, kick, {0, 0, -9.81}, p);
        p.vx[mud] += kick * p.ax[mud], p.x[mud] += dt * p.vx[mud];
        p.vx[water] += kick * p.ax[water];
        if (n == 99) {
            CHECK(p.x[mud] == Approx(x0).margin(1e-5));   // the last half step belongs to the ramp
            // tends to a/gamma; what is left after 100 steps: (1 + gamma kick)^-100 = 5e-4
            CHECK(p.vx[water] == Approx(3 / start.damping()).epsilon(6e-4));
        }
    }
    CHECK(p.x[mud] == Approx(x0 + 0.5).epsilon(1e-5));
    CHECK(p.vx[mud] == Approx(5).epsilon(1e-3));
    CHECK_FALSE(start.active(t + 1e-9));
}

TEST_CASE("a fill starts with the velocity and the pressure that its formulas give") {
    Case c = scene();
    c.sph.fill.pop_back();
    for (const char* text : {"2*z", "0", "-x"})
        c.sph.fill[0].velocity_field.emplace_back(text, "xyz", "scene");
    c.sph.fill[0].pressure.emplace("100*sin(x)", "xyz", "scene");
    const std::vector<FluidLaw> fluids = laws(c);
    const Particles p = fill_particles(c, fluids).particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        REQUIRE(p.vx[i] == 2 * p.z[i]);
        REQUIRE(p.vz[i] == -p.x[i]);
        // to 1e-14 of the density, where the inversion of the equation of state ends
        REQUIRE(fluids[p.fluid[i]].pressure(p.drho[i], 0) ==
                Approx(100 * std::sin(p.x[i])).margin(1e-6));
    }
}

TEST_CASE("more particles than fit into memory are refused before the memory is asked for") {
    Case c = scene();
    c.sph.spacing = 0.125 / 1024;
    CHECK_THROWS_WITH(fill_particles(c, laws(c)), Catch::Contains("GiB: use a spacing of"));
}
