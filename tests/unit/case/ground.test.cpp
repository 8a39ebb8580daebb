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
    CHECK(c.fem.contact[0].near == 0);  // two gaps
}

TEST_CASE("near of a contact inside the mesh is read, and less than two gaps is refused") {
    const std::string contact =
        "[[fem.contact]]\nname = \"joint\"\nnodes = \"xmax\"\nsurface = \"ymax\"\ngap = 0.005\n";
    CHECK(read(plate + contact + "near = 0.02\n").fem.contact[0].near == 0.02);
    CHECK_THAT(mistake(plate + contact + "near = 0.009\n"),
               Catch::Contains("near") && Catch::Contains("two gaps or more") &&
                   Catch::Contains("0.005"));
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

TEST_CASE("a hardening table is read, and one that cannot be is refused") {
    const auto metal = [](const std::string& lines) {
        return case_text::with(plate, "poisson_ratio = 0.3\n",
                               "poisson_ratio = 0.3\nkind = \"j2\"\n" + lines);
    };
    const std::string table = "hardening_table = [[0, 2e8], [0.01, 3e8], [0.2, 3e8]]\n";
    const FemMaterial steel = read(metal(table)).fem.material[0];
    REQUIRE(steel.hardening_table.size() == 3);
    CHECK(steel.hardening_table[1] == std::array<double, 2>{0.01, 3e8});
    CHECK(steel.yield_stress == 2e8);
    CHECK_THAT(mistake(metal(table + "yield_stress = 2e8\n")), Catch::Contains("one law too many"));
    CHECK_THAT(mistake(metal(table + "hardening = 1e9\n")), Catch::Contains("one law too many"));
    CHECK_THAT(mistake(metal("hardening_table = [[0.1, 2e8], [0.2, 3e8]]\n")),
               Catch::Contains("begin at 0"));
    CHECK_THAT(mistake(metal("hardening_table = [[0, 2e8], [0, 3e8]]\n")),
               Catch::Contains("increase"));
    CHECK_THAT(mistake(metal("hardening_table = [[0, 2e8], [0.1, 1e8]]\n")),
               Catch::Contains("never fall"));
    CHECK_THAT(mistake(metal("hardening_table = [[0, 0], [0.1, 1e8]]\n")), Catch::Contains("> 0"));
    CHECK_THAT(mistake(metal("hardening_table = [[0, 2e8]]\n")), Catch::Contains("hardening_table"));
    CHECK_THAT(mistake(metal("hardening_table = [[0, 2e8, 1], [1, 2e8, 1]]\n")),
               Catch::Contains("hardening_table"));
    std::string long_table = "hardening_table = [[0, 1e8]";
    for (int k = 1; k < 17; ++k) long_table += ", [" + std::to_string(k) + ", 1e8]";
    CHECK_THAT(mistake(metal(long_table + "]\n")), Catch::Contains("hardening_table"));
    CHECK_THAT(mistake(case_text::with(plate, "poisson_ratio = 0.3\n",
                                       "poisson_ratio = 0.3\n" + table)),
               Catch::Contains("no effect") && Catch::Contains("j2"));
}

TEST_CASE("a Mohr-Coulomb material is read, and one that cannot be is refused") {
    const auto sand = [](const std::string& lines) {
        return case_text::with(plate, "poisson_ratio = 0.3\n",
                               "poisson_ratio = 0.3\nkind = \"mohr_coulomb\"\n" + lines);
    };
    const std::string usual = "cohesion = 1e4\nfriction_angle = 30\n";
    const FemMaterial m = read(sand(usual + "dilation_angle = 5\ntension_cutoff = 0\n"))
                              .fem.material[0];
    CHECK(m.kind == MaterialKind::mohr_coulomb);
    CHECK(m.cohesion == 1e4);
    CHECK(m.friction_angle == 30);
    CHECK(m.dilation_angle == 5);
    REQUIRE(m.tension_cutoff);
    CHECK(*m.tension_cutoff == 0);
    CHECK_FALSE(read(sand(usual)).fem.material[0].tension_cutoff);
    CHECK_THAT(mistake(sand("")), Catch::Contains("cohesion"));
    CHECK_THAT(mistake(sand("cohesion = 1e4\n")), Catch::Contains("friction_angle"));
    CHECK_THAT(mistake(sand("cohesion = 0\nfriction_angle = 0\n")),
               Catch::Contains("no strength at all"));
    CHECK_THAT(mistake(sand(usual + "dilation_angle = 31\n")), Catch::Contains("gain energy"));
    CHECK_THAT(mistake(sand(usual + "tension_cutoff = 2e4\n")),
               Catch::Contains("cohesion/tan(friction_angle)"));
    CHECK(mistake(sand(usual + "tension_cutoff = 1.7e4\n")).empty());
    CHECK(mistake(sand("cohesion = 1e4\nfriction_angle = 0\ntension_cutoff = 1e5\n")).empty());
    CHECK_THAT(mistake(sand("cohesion = 1e4\nfriction_angle = 85\n")),
               Catch::Contains("friction_angle") && Catch::Contains("80"));
    CHECK_THAT(mistake(sand(usual + "shear_strength = 1e4\n")), Catch::Contains("no effect"));
    CHECK_THAT(mistake(case_text::with(plate, "poisson_ratio = 0.3\n",
                                       "poisson_ratio = 0.3\n" + usual)),
               Catch::Contains("no effect") && Catch::Contains("mohr_coulomb"));
}

TEST_CASE("a strength that grows with depth is read, and one that cannot be is refused") {
    const auto soil = [](const std::string& lines, const std::string& stiffness) {
        std::string text = case_text::with(plate, "poisson_ratio = 0.3\n",
                                           "poisson_ratio = 0.3\n" + lines);
        const std::size_t at = text.find("young_modulus");
        return text.replace(at, text.find('\n', at) - at, stiffness);
    };
    const std::string E = "young_modulus = 5e6", tresca = "kind = \"tresca\"\n";
    const std::string clay = tresca + "shear_strength = 5e3\n";
    const std::string depth = "strength_gradient = 1.2e3\nstrength_level = -20\n";
    const FemMaterial m = read(soil(clay + depth, "modulus_ratio = 500")).fem.material[0];
    REQUIRE(m.strength_gradient);
    CHECK(*m.strength_gradient == 1.2e3);
    CHECK(m.strength_level == -20);
    CHECK(m.modulus_ratio == 500);
    CHECK(m.young_modulus == 2.5e6);  // of the strength at the level
    CHECK(read(soil(clay, "modulus_ratio = 300")).fem.material[0].young_modulus == 1.5e6);
    CHECK(mistake(soil(tresca + "shear_strength = 0\n" + depth, E)).empty());
    CHECK(mistake(soil("kind = \"mohr_coulomb\"\ncohesion = 0\nfriction_angle = 0\n" + depth, E))
              .empty());
    CHECK_THAT(mistake(soil(tresca + "shear_strength = 0\n", E)), Catch::Contains("> 0 Pa"));
    CHECK_THAT(mistake(soil(clay + "strength_gradient = 1e3\n", E)),
               Catch::Contains("strength_level"));
    CHECK_THAT(mistake(soil(clay + "strength_level = 0\n", E)),
               Catch::Contains("no effect without strength_gradient"));
    CHECK_THAT(mistake(soil(depth, E)),
               Catch::Contains("no effect") && Catch::Contains("mohr_coulomb"));
    CHECK_THAT(mistake(soil(clay, "poisson_ration = 1")), Catch::Contains("poisson_ration"));
    CHECK_THAT(mistake(soil(clay + "modulus_ratio = 500\n", E)),
               Catch::Contains("one stiffness too many"));
    CHECK_THAT(mistake(soil("modulus_ratio = 500\n", E)),
               Catch::Contains("no effect") && Catch::Contains("tresca"));
    CHECK_THAT(mistake(soil(clay, "")), Catch::Contains("young_modulus") &&
                                            Catch::Contains("or modulus_ratio"));
    const std::string contact = "[[fem.contact]]\nname = \"a\"\nnodes = \"xmin\"\nsurface = "
                                "\"xmax\"\ngap = 0.1\nadhesion_factor = 0.5\n";
    CHECK(read(plate + contact).fem.contact[0].adhesion_factor == 0.5);
    CHECK_THAT(mistake(plate + contact + "max_shear = 1e3\n"),
               Catch::Contains("one limit too many"));
}

TEST_CASE("initial velocities are read, and mistakes told") {
    const std::string start = plate + "[[fem.initial_velocity]]\nset = \"block\"\n";
    const Case c = read(start + "velocity = [0, \"2*x\", 1]\nspin = [0, 0, 3]\ncenter = [1, 0, 0]\n");
    const FemInitialVelocity& given = c.fem.initial_velocity[0];
    REQUIRE(given.formulas.size() == 3);
    CHECK(given.formulas[1](2, 0, 0) == 4);
    CHECK(given.spin[2] == 3);
    CHECK(given.has_center);
    CHECK_THAT(mistake(start), Catch::Contains("give velocity") && Catch::Contains("or spin"));
    CHECK_THAT(mistake(start + "spin = [0, 0, 3]\n"), Catch::Contains("center"));
    CHECK_THAT(mistake(start + "velocity = [1, 0, 0]\ncenter = [0, 0, 0]\n"),
               Catch::Contains("no effect without spin"));
    CHECK_THAT(mistake(start + "velocity = [1, 0, 0]\nrigid = \"b\"\n"),
               Catch::Contains("[[fem.rigid]]"));
    CHECK_THAT(mistake(start + "velocity = [\"2*w\", 0, 0]\n"), Catch::Contains("velocity"));
    const std::string body = plate + "[[fem.rigid]]\nname = \"b\"\nset = \"block\"\n"
                                     "[[fem.initial_velocity]]\nrigid = \"b\"\n";
    CHECK(mistake(body + "velocity = [1, 0, 0]\nspin = [0, 1, 0]\n").empty());
    CHECK_THAT(mistake(body + "velocity = [\"x\", 0, 0]\n"), Catch::Contains("moves as one"));
    CHECK_THAT(mistake(body + "velocity = [1, 0, 0]\nset = \"block\"\n"),
               Catch::Contains("one thing too many"));
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
