#include "case/layers.hpp"

#include <catch2/catch.hpp>

#include "case_text.hpp"

using namespace undertow;
using case_text::mistake;
using case_text::plate;
using case_text::read;

TEST_CASE("layers apply in order: base, level, variants, overrides") {
    const std::string text = plate + R"(
[level.quick]
sph.spacing = 0.2
time.end = 0.5
[variant.short]
time.end = 0.25
[variant.shorter]
time.end = 0.125
)";
    CHECK(read(text).time.end == 1.0);
    const Case quick = read(text, {.level = "quick"});
    CHECK(quick.sph.spacing == 0.2);
    CHECK(quick.time.end == 0.5);
    CHECK(read(text, {.level = "quick", .variants = {"short"}}).time.end == 0.25);
    CHECK(read(text, {.variants = {"short", "shorter"}}).time.end == 0.125);
    CHECK(read(text, {.variants = {"shorter", "short"}}).time.end == 0.25);
    CHECK(read(text, {.variants = {"short"}, .set = {"time.end=2"}}).time.end == 2);
}

TEST_CASE("tables merge key by key, arrays of tables replace, append adds") {
    const std::string text = plate + R"(
[variant.oil]
sph.kernel = "cubic_spline"
[[variant.oil.sph.fluid]]
name = "oil"
density = 900
[variant.oil.append]
sph.fill = [{ fluid = "oil", box = { min = [0, 0, 1], max = [1, 1, 2] } }]
[[variant.wall.append.sph.plane]]
name = "wall"
point = [1, 0, 0]
normal = [-1, 0, 0]
[[variant.gate.append.sph.body]]
name = "gate"
box = { min = [0, 0, 0], max = [0.1, 1, 1] }
)";
    const Case walled = read(text, {.variants = {"wall", "gate"}});
    REQUIRE(walled.sph.plane.size() == 2);
    CHECK(walled.sph.plane[0].name == "floor");
    CHECK(walled.sph.plane[1].name == "wall");
    CHECK(walled.sph.body.size() == 1);  // append to an array the base does not have
    CHECK(walled.sph.spacing == 0.1);     // the rest of [sph] stays

    // The water is gone, so the base's fill of water is now a mistake, told at its place.
    CHECK_THAT(
        mistake(text, {.variants = {"oil"}}),
        Catch::Matchers::StartsWith("case.toml:11:9: sph.fill.0.fluid = \"water\" is not known"));
}

TEST_CASE("false removes a table, and true does not") {
    const std::string text = plate + "[variant.rigid]\nfem = false\ncoupling = false\n";
    const Case rigid = read(text, {.variants = {"rigid"}});
    CHECK(rigid.sph.present);
    CHECK_FALSE(rigid.fem.present);
    CHECK(read(text).fem.present);
    CHECK_FALSE(read(text, {.set = {"fem=false", "coupling=false"}}).fem.present);
    CHECK_THAT(mistake(text, {.set = {"fem=true"}}),
               Catch::Matchers::StartsWith("--set fem=true: fem = true is a boolean: a table"));
    CHECK_THAT(mistake(text, {.set = {"fem=false"}}),
               Catch::Matchers::StartsWith("case.toml:31:1: coupling = {...} couples nothing"));
    CHECK_THAT(mistake(text, {.set = {"fem=false", "coupling=false", "sph=false"}}),
               Catch::Matchers::Contains("a case needs [sph], [fem] or both"));
}

TEST_CASE("an override takes TOML values and bare words, and finds entries by name or number") {
    const Case c = read(
        plate, {.set = {"sph.kernel=cubic_spline", "sph.fluid.water.density=997",
                        "fem.material.0.poisson_ratio=0.25", "sph.fill.0.velocity=[0, 0, -2.5]",
                        "sph.surface_images=false", "case.title=a = b"}});
    CHECK(c.sph.kernel == Kernel::cubic_spline);
    CHECK(c.sph.fluid[0].density == 997);
    CHECK(c.fem.material[0].poisson_ratio == 0.25);
    CHECK(c.sph.fill[0].velocity == Vec3{0, 0, -2.5});
    CHECK_FALSE(c.sph.surface_images);
    CHECK(c.info.title == "a = b");
}

TEST_CASE("append takes arrays only") {
    CHECK_THAT(
        mistake(plate + "[variant.a.append]\nsph.spacing = 1\n", {.variants = {"a"}}),
        Catch::Matchers::StartsWith("case.toml:34:15: append.sph.spacing = 1 is an integer"));
}
