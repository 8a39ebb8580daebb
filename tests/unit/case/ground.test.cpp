// Keys of a scene with a slide, water, soil and a body in it.

#include <catch2/catch.hpp>

#include "case_text.hpp"

using namespace undertow;
using case_text::mistake;
using case_text::plate;
using case_text::read;

TEST_CASE("a slide is a prism of a viscoplastic fluid that a ramp sets in motion") {
    const Case c = read(plate + R"(
[start]
settle = 0.25
[variant.slide.append]
sph.fluid = [{ name = "slide", density = 1681, yield_stress = 7.3, consistency = 3, flow_index = 0.35 }]
sph.fill = [{ fluid = "slide", box = { min = [0, 0, 0], max = [1, 1, 1] }, profile = [[0, 0], [1, 0], [0, 1]], velocity = [5, 0, 0], ramp = 0.2 }]
sph.obstacle = [{ name = "pile", from = [0.5, 0.5, 0], to = [0.5, 0.5, 1], radius = 0.2 }]
)", {.variants = {"slide"}});
    CHECK(c.start.settle == 0.25);
    REQUIRE(c.sph.fluid.size() == 2);
    CHECK(c.sph.fluid[1].yield_stress == 7.3);
    CHECK(c.sph.fluid[1].flow_index == 0.35);
    CHECK(c.sph.fill[1].profile.size() == 3);
    CHECK(c.sph.fill[1].profile[1][0] == 1);
    CHECK(c.sph.fill[1].ramp == 0.2);
    CHECK(c.sph.obstacle[0].shape.radius == 0.2);
}

TEST_CASE("soil, static water, a rigid body and the contact between them are read") {
    const Case c = read(plate + R"(
[fem.water]
level = 2.5
[fem.geostatic]
set = "block"
surface = 0
[fem.settle]
[[fem.absorbing]]
set = "xmin"
[[fem.absorbing]]
set = "xmax"
center = [1, 0, -2]
[[fem.rigid]]
name = "bucket"
set = "block"
free = ["x", "z", "ry"]
added_mass = 785
[[fem.contact]]
name = "skirt"
nodes = "xmax"
surface = "ymax"
friction = 0.328
gap = 0.005
)");
    REQUIRE(c.fem.water);
    CHECK(c.fem.water->level == 2.5);
    CHECK(c.fem.water->density == 1000);
    REQUIRE(c.fem.geostatic);
    CHECK(c.fem.geostatic->earth_pressure == 1);
    REQUIRE(c.fem.settle);
    CHECK(c.fem.absorbing[0].set == "xmin");
    CHECK_FALSE(c.fem.absorbing[0].center);
    REQUIRE(c.fem.absorbing[1].center);
    CHECK(c.fem.absorbing[1].center->at(2) == -2);
    CHECK(c.fem.rigid[0].free == std::vector<std::string>{"x", "z", "ry"});
    CHECK(c.fem.contact[0].friction == 0.328);
}

TEST_CASE("shells, their supports and their yielding are read, and mistakes told") {
    const std::string part = "material = \"steel\"\n";
    CHECK_THAT(mistake(case_text::with(plate, part, part + "element = \"shell\"\n")),
               Catch::Contains("does not fit") && Catch::Contains("[fem.block]"));
    CHECK_THAT(mistake(case_text::with(plate, part, part + "thickness = 0.1\n")),
               Catch::Contains("no effect") && Catch::Contains("shell"));
    CHECK_THAT(mistake(case_text::with(plate, "poisson_ratio = 0.3\n",
                                       "poisson_ratio = 0.3\nyield_stress = 2e8\n")),
               Catch::Contains("no effect") && Catch::Contains("j2"));
    CHECK_THAT(mistake(case_text::with(plate, "poisson_ratio = 0.3\n",
                                       "poisson_ratio = 0.3\nkind = \"j2\"\n")),
               Catch::Contains("yield_stress"));
    CHECK_THAT(mistake(plate + "[[fem.support]]\nset = \"xmin\"\nfix = [\"rot\"]\n"),
               Catch::Contains("clamp"));
}

TEST_CASE("mistakes in a scene on soil are named with their place") {
    const std::string soil = case_text::with(plate, "poisson_ratio = 0.3\n",
                                             "poisson_ratio = 0.3\nkind = \"tresca\"\n");
    CHECK_THAT(mistake(soil), Catch::Contains("shear_strength") && Catch::Contains("s_u"));
    CHECK_THAT(mistake(case_text::with(plate, "poisson_ratio = 0.3\n",
                                       "poisson_ratio = 0.3\nshear_strength = 9e3\n")),
               Catch::Contains("no effect"));
    CHECK_THAT(mistake(case_text::with(plate, "[[sph.plane]]",
                                       "profile = [[0, 0], [1, 0]]\n[[sph.plane]]")),
               Catch::Contains("three corners"));
    CHECK_THAT(mistake(plate + "[[sph.obstacle]]\nname = \"pile\"\nradius = 1\n"),
               Catch::Contains("from"));
}

TEST_CASE("mistakes in bodies and gauges are told") {
    const std::string body = plate + "[[sph.body]]\nname = \"b\"\n";
    CHECK_THAT(mistake(body), Catch::Contains("has no box") && Catch::Contains("an stl file"));
    CHECK_THAT(mistake(body + "stl = \"a.stl\"\nradius = 1\nfrom = [0,0,0]\nto = [1,0,0]\n"),
               Catch::Contains("one shape too many"));
    const std::string box = body + "box = { min = [0,0,0], max = [1,1,1] }\n";
    CHECK(mistake(box).empty());
    CHECK_THAT(mistake(box + "slip = \"friction\"\n"), Catch::Contains("needs friction"));
    CHECK_THAT(mistake(box + "velocity = [1,0,0]\nmotion = \"a.csv\"\n"),
               Catch::Contains("one law too many"));
    CHECK_THAT(mistake(box + "displacement = [1, 0, 0]\n"), Catch::Contains("does not move"));
    CHECK_THAT(mistake(box + "axis = [0, 1, 0]\n"), Catch::Contains("give angle"));
    CHECK_THAT(mistake(plate + "[[sph.plate]]\nname = \"b\"\n"), Catch::Contains("[[sph.body]]"));
    const std::string gauge = plate + "[[sph.gauge]]\nname = \"q\"\n";
    CHECK_THAT(mistake(gauge + "kind = \"force\"\nwall = \"flor\"\n"),
               Catch::Contains("did you mean \"floor\""));
    CHECK_THAT(mistake(gauge + "kind = \"flux\"\nbox = { min = [0,0,0], max = [1,1,1] }\n"),
               Catch::Contains("is not a rectangle"));
    CHECK_THAT(mistake(gauge + "kind = \"flux\"\nbox = { min = [0,0,0], max = [0,1,1] }\n"
                               "direction = [0, 1, 0]\n"),
               Catch::Contains("does not fit"));
}
