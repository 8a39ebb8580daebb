// What the program says at once of cases that cannot be meant so.

#include <catch2/catch.hpp>
#include <cmath>

#include "scenes.hpp"
#include "sph_solver/setup/doubts.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

/// A column 1 m high, dx = 50 mm: its pressure at the floor is 9.6 kPa.
Case column() {
    Case c = scenes::water_box(0.05, {0.5, 0.5, 1.0});
    scenes::add_basin(c, {0.5, 0.5, 1.0});
    return c;
}

std::vector<std::string> doubts(const Case& c) {
    return doubts_at_start(c, FluidSystem(c, 0.4));
}

}  // namespace

TEST_CASE("a case that is meant so raises no doubt") {
    CHECK(doubts(column()).empty());
}

TEST_CASE("a sound speed that lets the fluid's weight compress it is doubted, then refused") {
    Case c = column();
    c.sph.fluid[0].sound_speed = 12;  // 6.6 %
    const auto told = doubts(c);
    REQUIRE(told.size() == 1);
    CHECK_THAT(told[0], Catch::Contains("12 m/s") && Catch::Contains("sound_speed = 31 m/s"));
    c.sph.fluid[0].sound_speed = 5;  // 38 %
    CHECK_THROWS_WITH(doubts(c), Catch::Contains("scene: the sound speed of fluid \"water\""));
}

TEST_CASE("units that no liquid has are doubted, where gravity says that units are meant") {
    Case kinematic = column();
    kinematic.sph.fluid[0].viscosity = 1e-6;
    REQUIRE(doubts(kinematic).size() == 1);
    CHECK_THAT(doubts(kinematic)[0], Catch::Contains("give density times that, 0.001"));
    Case grams = column();
    grams.sph.fluid[0].density = 1;
    REQUIRE(doubts(grams).size() == 1);
    CHECK_THAT(doubts(grams)[0], Catch::Contains("water has 1000"));
    for (Case* c : {&kinematic, &grams}) {
        c->info.gravity = {0, 0, -1};
        CHECK(doubts(*c).empty());
    }
}

TEST_CASE("an opening that lets nothing pass is doubted, one of four spacings is not") {
    const auto gate_above = [](double opening) {
        Case c = column();
        Body gate;
        gate.name = "gate";
        gate.shape.box = Box{{0.5, 0, opening}, {0.7, 0.5, 1}};
        c.sph.body = {gate};
        c.sph.plane[2].point[0] = 2;
        return doubts(c);
    };
    REQUIRE(gate_above(0.05).size() == 1);
    CHECK_THAT(gate_above(0.05)[0], Catch::Contains("\"gate\"") && Catch::Contains("\"floor\"") &&
                                        Catch::Contains("1 spacings"));
    CHECK(gate_above(0.2).empty());
    CHECK(gate_above(0).empty());
}

namespace {

/// A cube of 8^3 particles and a lone one `far` spacings from it.
Case wide(double far, Precision precision) {
    Case c = scenes::water_box(0.01, {0.08, 0.08, 0.08});
    c.info.gravity = {0, 0, 0};
    c.sph.max_speed = 3;
    c.sph.precision = precision;
    Fill lone = c.sph.fill[0];
    lone.box = {{0.01 * far, 0, 0}, {0.01 * far + 0.01, 0.01, 0.01}};
    c.sph.fill.push_back(lone);
    return c;
}

}  // namespace

TEST_CASE("a float scene has positions to 2^-31 of its width, and is refused beyond 1e6 spacings") {
    for (const double far : {1e2, 1e4, 1e6 - 100}) {
        FluidSystem fluid(wide(far, Precision::float32), 0.4);
        CHECK(doubts_at_start(wide(far, Precision::float32), fluid).empty());
        fluid.refresh_neighbors(0);
        fluid.pack(0);
        const FixedPoint& fixed = fluid.neighbors().fixed();
        double worst = 0;  // [dx]
        for (std::size_t i = 0; i < fluid.particles.size(); ++i) {
            const double shown = fixed.x0 + fluid.neighbors().records()[i].x * fixed.unit;
            worst = std::max(worst, std::abs(shown - fluid.particles.x[i]) / 0.01);
        }
        CAPTURE(far, worst);
        CHECK(worst < 1.01 * (far + 20) / std::pow(2.0, 31));
        CHECK(worst > 0.1 * far / std::pow(2.0, 31));  // it is no better either
    }
    CHECK_THROWS_WITH(doubts(wide(2e6, Precision::float32)),
                      Catch::Contains("sph.precision = \"double\""));
    CHECK(doubts(wide(2e6, Precision::float64)).empty());
    CHECK_THROWS_WITH(doubts(wide(2e7, Precision::float64)), Catch::Contains("a coarser spacing"));
}
