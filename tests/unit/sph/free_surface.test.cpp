#include "sph_solver/physics/free_surface.hpp"

#include <catch2/catch.hpp>

#include "scenes.hpp"

using namespace undertow;
using namespace undertow::sph;

TEST_CASE("the outermost layer of a tank is its free surface, and its walls are none") {
    const int dimension = GENERATE(2, 3);
    const double h = GENERATE(1.2, 1.5), dx = 0.01;
    const Vec3 size{0.12, 0.12, 0.1};
    Case input = scenes::water_box(dx, size, dimension);
    input.sph.smoothing_ratio = h;
    scenes::add_basin(input, size);
    FluidSystem fluid(input, 0.2);
    fluid.refresh_neighbors(0);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        const double below = (size[2] - fluid.particles.z[i]) / dx - 0.5;  // of the outermost [dx]
        const Depth expected = below < 0.5            ? Depth::surface
                               : below < 2 * h - 0.01 ? Depth::near_surface
                                                      : Depth::inside;
        CHECK(fluid.neighbors().depth()[i] == expected);
    }
}

TEST_CASE("spray bears no tension, and the inside of the fluid does") {
    Case input = scenes::water_box(0.01, {0.15, 0.15, 0.15});
    Fill drop = input.sph.fill[0];
    drop.box = {{0.3, 0, 0}, {0.32, 0.02, 0.02}};
    input.sph.fill.push_back(drop);
    FluidSystem fluid(input, 0.2);
    for (double& drho : fluid.particles.drho) drho = -1;
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
        const Depth depth = fluid.neighbors().depth()[i];
        const bool in_drop = fluid.particles.x[i] > 0.2;
        if (in_drop) CHECK(depth == Depth::loose);
        if (depth == Depth::loose) {
            CHECK(fluid.particles.p[i] == 0);
            CHECK(fluid.particles.drho[i] == 0);
        } else {
            CHECK(fluid.particles.p[i] < 0);
        }
    }
}

TEST_CASE("where nothing is under tension its control changes no bit") {
    const Vec3 size{0.1, 0.1, 0.1};
    Case input = scenes::water_box(0.01, size);
    scenes::add_basin(input, size);
    const auto run = [&](TensionControl control) {
        input.sph.tension_control = control;
        FluidSystem fluid(input, 0.4);
        double t = 0, before = 0;
        for (int n = 0; n < 20; ++n) {
            scenes::two_pass_step(fluid, t, 2e-4, before);
            before = 2e-4;
            for (const double p : fluid.particles.p) REQUIRE(p > 0);
        }
        return fluid.particles;
    };
    const Particles with = run(TensionControl::switched), without = run(TensionControl::none);
    CHECK(with.vz == without.vz);
    CHECK(with.drho == without.drho);
}
