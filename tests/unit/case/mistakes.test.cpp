// Every mistake in a case file is one sentence that says where, what, and what is allowed.

#include <catch2/catch.hpp>

#include "case_text.hpp"

using case_text::mistake;
using case_text::plate;
using case_text::with;

namespace {

struct Mistake {
    const char* from;
    const char* to;
    const char* sentence;  // all of it, or its beginning
};

// The numbers are lines and columns of case_text::plate.
const Mistake mistakes[] = {
    {"spacing = 0.1", "spacing = 0.0",
     "case.toml:6:11: sph.spacing = 0 is not allowed: it must be > 0 m."},
    {"spacing = 0.1", "spacing = -1", "case.toml:6:11: sph.spacing = -1 is not allowed"},
    {"spacing = 0.1", "spacing = nan", "case.toml:6:11: sph.spacing = nan is not allowed"},
    {"spacing = 0.1", "spacing = inf", "case.toml:6:11: sph.spacing = inf is not allowed"},
    {"spacing = 0.1", "spacing = \"0.1\"",
     "case.toml:6:11: sph.spacing = \"0.1\" is a string: a number is expected."},
    {"spacing = 0.1", "spacng = 0.1",
     "case.toml:6:1: sph.spacng = 0.1 is not a key of [sph]: allowed are spacing, "},
    {"spacing = 0.1", "", "case.toml:5:1: [sph] has no spacing: give the particle spacing in m"},
    {"spacing = 0.1", "spacing = 2",
     "case.toml:12:7: sph.fill.0.box = {...} is 1 m thin in x: it must be at least one spacing"},
    {"spacing = 0.1", "spacing = 0.3",
     "case.toml:12:7: sph.fill.0.box = {...} is 1 m along x, 3.333 spacings of 0.3 m; it must be a "
     "whole number: 0.9 or 1.2 m."},
    {"[sph]", "[start]\nsettle = 2\n[sph]",
     "case.toml:5:1: start = {...} leaves no time for the run: time.end = 1 s includes its settle "
     "= 2 "
     "s; give a later end."},
    {"spacing = 0.1", "spacing = 0.1\nkernel = \"wendland_c3\"",
     "case.toml:7:10: sph.kernel = \"wendland_c3\" is not known: allowed are cubic_spline, "
     "wendland_c2, wendland_c4; did you mean \"wendland_c2\"?"},
    {"[sph]", "[output]\ncontact_fields = false\ncontact_every = 0.1\n[sph]",
     "case.toml:7:17: output.contact_every = 0.1 has nothing to write: set output.contact_fields = "
     "true"},
    {"[[fem.material]]\nname = \"steel\"\ndensity = 7850\nyoung_modulus = 210e9\npoisson_ratio = "
     "0.3\n",
     "",
     "case.toml:22:12: fem.part.0.material = \"steel\" is not known: the case has none to name."},
    {"spacing = 0.1", "spacing = 0.1\nsurface_images = 1",
     "case.toml:7:18: sph.surface_images = 1 is an integer: true or false is expected."},
    {"spacing = 0.1", "spacing = 0.1\ncfl = -0.1", "case.toml:7:7: sph.cfl = -0.1 is not allowed"},
    {"spacing = 0.1", "spacing = 0.1\ncfl = 2.1", "case.toml:7:7: sph.cfl = 2.1 is not allowed"},
    {"spacing = 0.1", "spacing = 0.1\nartificial_viscosity = 3",
     "case.toml:7:24: sph.artificial_viscosity = 3 is not allowed"},
    {"spacing = 0.1", "spacing = 0.1\nshifting = 50",
     "case.toml:7:12: sph.shifting = 50 is not allowed"},
    {"spacing = 0.1", "spacing = 0.1\nprecision = \"single\"",
     "case.toml:7:13: sph.precision = \"single\" is not known: allowed are float, double"},
    {"spacing = 0.1", "spacing = 0.1\nviscosity_tolerance = 1e-7",
     "case.toml:7:23: sph.viscosity_tolerance = 1e-07 is less than float32 can solve for: at least "
     "1e-6, or sph.precision = \"double\"."},
    {"spacing = 0.1", "spacing = 0.1\ntension_control = \"cut\"",
     "case.toml:7:19: sph.tension_control = \"cut\" is not known: allowed are none, spray, "
     "switched"},
    {"spacing = 0.1", "spacing = 0.1\ndomain = { min = [0, 0, 0], max = [1, 1, 0.5] }",
     "case.toml:13:7: sph.fill.0.box = {...} reaches out of sph.domain in z"},
    {"fluid = \"water\"", "fluid = \"watr\"",
     "case.toml:11:9: sph.fill.0.fluid = \"watr\" is not known: allowed are water; did you mean "
     "\"water\"?"},
    {"spacing = 0.1", "spacing = 0.1\nperiodic = [\"x\"]",
     "case.toml:7:12: sph.periodic = [\"x\"] needs sph.domain, whose extent is the period."},
    {"[[sph.plane]]",
     "[[sph.inflow]]\nname = \"in\"\nfluid = \"water\"\nvelocity = 1\nnormal = [1, 0, 0]\n"
     "box = { min = [0, 0, 0], max = [0.1, 1, 1] }\n[[sph.plane]]",
     "case.toml:18:7: sph.inflow.in.box = {...} must be flat along its normal"},
    {"[[sph.plane]]",
     "[[sph.outflow]]\nname = \"out\"\nnormal = [1, 0, 1]\n"
     "box = { min = [0, 0, 0], max = [0, 1, 1] }\n[[sph.plane]]",
     "case.toml:15:10: sph.outflow.out.normal = [1, 0, 1] is slanted: it must lie along one axis"},
    {"[[sph.plane]]",
     "[[sph.absorbing]]\nname = \"end\"\ndirection = [1, 0, 0]\nstrength = -1\n"
     "box = { min = [0, 0, 0], max = [1, 1, 1] }\n[[sph.plane]]",
     "case.toml:16:12: sph.absorbing.end.strength = -1 is not allowed"},
    {"density = 1000", "density = 0",
     "case.toml:9:11: sph.fluid.water.density = 0 is not allowed: it must be > 0 kg/m3."},
    {"density = 1000", "density = 1000\nsound_speed = \"fast\"",
     "case.toml:10:15: sph.fluid.water.sound_speed = \"fast\" is not known: allowed are \"auto\""},
    {"max = [1, 1, 1]", "max = [1, 1, 0]",
     "case.toml:12:32: sph.fill.0.box.max = [1, 1, 0] is not "
     "allowed: its z must be > 0 m, the z of min."},
    {"max = [1, 1, 1]", "max = [1, 1]",
     "case.toml:12:32: sph.fill.0.box.max = [1, 1] is not a vector: three finite numbers"},
    {"normal = [0, 0, 2]", "normal = [0, 0, 0]",
     "case.toml:16:10: sph.plane.floor.normal = [0, 0, 0] has no direction"},
    {"[[sph.plane]]", "[sph.plane]",
     "case.toml:13:1: sph.plane = {...} is a table: an array of tables is expected"},
    {"poisson_ratio = 0.3", "poisson_ratio = 0.5",
     "case.toml:24:17: fem.material.steel.poisson_ratio = 0.5 is not allowed: it must be between "
     "-1 "
     "and 0.5, both excluded."},
    {"poisson_ratio = 0.3", "poisson_ratio = -1",
     "case.toml:24:17: fem.material.steel.poisson_ratio"},
    {"young_modulus = 210e9", "young_modulus = 0",
     "case.toml:23:17: fem.material.steel.young_modulus = 0 is not allowed: it must be > 0 Pa."},
    {"material = \"steel\"", "material = \"stel\"",
     "case.toml:27:12: fem.part.0.material = \"stel\" is not known: allowed are steel; did you "
     "mean "
     "\"steel\"?"},
    {"material = \"steel\"", "material = \"steel\"\nelement = \"bbar\"",
     "case.toml:28:11: fem.part.0.element = \"bbar\" is not known: allowed are one_point, b_bar, "
     "averaged_pressure, shell; did you mean \"b_bar\"?"},
    {"divisions = [4, 4, 1]", "divisions = [4, 4, 1]\ncells = \"tets\"",
     "case.toml:20:9: fem.block.cells = \"tets\" is not known: allowed are hexahedra, tetrahedra"},
    {"divisions = [4, 4, 1]", "divisions = [4, 4, 1]\ncorners = [[0, 0, 0]]",
     "case.toml:20:11: fem.block.corners = [[0, 0, 0]] is one shape too many"},
    {"box = { min = [0, 0, -0.2], max = [1, 1, 0] }", "corners = [[0, 0, 0], [1, 0, 0]]",
     "case.toml:18:11: fem.block.corners = [[0, 0, 0], [1, 0, 0]] is not allowed: 8 points"},
    {"[[fem.surface]]", "[[fem.traction]]\nset = \"xmax\"\nvalue = 5\n[[fem.surface]]",
     "case.toml:30:9: fem.traction.0.value = 5 is not a vector: three finite numbers"},
    {"[[fem.surface]]",
     "[[fem.history]]\nname = \"a b\"\nkind = \"point\"\npoint = [0, 0, 0]\n[[fem.surface]]",
     "case.toml:29:8: fem.history.a b.name = \"a b\" is not allowed: it becomes part of a file's"},
    {"[[fem.surface]]",
     "[[fem.history]]\nname = \"a\"\nkind = \"section\"\npoint = [0, 0, 0]\n[[fem.surface]]",
     "case.toml:28:1: [fem.history.a] has no set: give the name of a set of the mesh"},
    {"[[fem.surface]]",
     "[[fem.history]]\nname = \"a\"\nkind = \"point\"\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\n"
     "[[fem.surface]]",
     "case.toml:32:10: fem.history.a.normal = [1, 0, 0] has no effect but on kind = \"section\"."},
    {"[[fem.surface]]", "[[fem.motion]]\nname = \"push\"\nset = \"xmax\"\n[[fem.surface]]",
     "case.toml:28:1: fem.motion.push.velocity is missing: give velocity, displacement"},
    {"[[fem.surface]]",
     "[[fem.motion]]\nname = \"push\"\nset = \"xmax\"\nvelocity = [1, 0, 0]\n"
     "displacement = [\"t\", 0, 0]\n[[fem.surface]]",
     "case.toml:32:16: fem.motion.push.displacement = [\"t\", 0, 0] is one law too many"},
    {"[[fem.surface]]",
     "[[fem.motion]]\nname = \"push\"\nset = \"xmax\"\ndisplacement = [0.1, 0, 0]\n[[fem.surface]]",
     "case.toml:31:16: fem.motion.push.displacement = [0.1, 0, 0] is 0.1 m at t = 0"},
    {"[[fem.surface]]",
     "[[fem.motion]]\nname = \"push\"\nrigid = \"plug\"\nvelocity = [1, 0, 0]\n[[fem.surface]]",
     "case.toml:30:9: fem.motion.push.rigid = \"plug\" names a rigid body, but the case has no"},
    {"[[fem.surface]]",
     "[[fem.motion]]\nname = \"push\"\nset = \"xmax\"\nvelocity = [1, 0, 0]\nramp = 2\nstop = 1\n"
     "[[fem.surface]]",
     "case.toml:33:8: fem.motion.push.stop = 1 is not allowed: it must be >= start + ramp, 2 s"},
    {"set = \"zmax\"", "set = \"top\"",
     "case.toml:30:7: fem.surface.top.set = \"top\" is not known: allowed are xmin, xmax"},
    {"divisions = [4, 4, 1]", "divisions = [4, 4, 0]",
     "case.toml:19:13: fem.block.divisions = [4, 4, 0] is not allowed"},
    {"material = \"steel\"", "material = \"steel\"\nimplicit = 1",
     "case.toml:28:12: fem.part.0.implicit = 1 is an integer: true or false is expected."},
    {"material = \"steel\"", "material = \"steel\"\nimplicit = true\nelement = \"b_bar\"",
     "case.toml:28:12: fem.part.0.implicit = true is for hexahedra of element = \"one_point\""},
    {"material = \"steel\"", "material = \"steel\"\nmass_factor = 0.5",
     "case.toml:28:15: fem.part.0.mass_factor = 0.5 is not allowed: it must be >= 1"},
    {"[fem.block]", "[fem]\nmass_scaling = 0\n[fem.block]",
     "case.toml:18:16: fem.mass_scaling = 0 is not allowed: it must be > 0 s"},
    {"[[fem.surface]]", "[[fem.mass]]\nset = \"xmax\"\n[[fem.surface]]",
     "case.toml:28:1: [fem.mass.0] has no mass: give the mass in kg"},
    {"[[fem.surface]]",
     "[[fem.mass]]\nset = \"xmax\"\npoint = [0, 0, 0]\nmass = 1\n[[fem.surface]]",
     "case.toml:29:7: fem.mass.0.set = \"xmax\" is one place too many"},
    {"[fem.block]", "[fem]\nmesh = \"a.msh\"\n[fem.block]",
     "case.toml:18:8: fem.mesh = \"a.msh\" is one mesh too many"},
    {"[[fem.surface]]\nname = \"top\"\nset = \"zmax\"", "",
     "case.toml:17:1: fem = {...} needs a [[fem.surface]]"},
    {"damping = 0.1", "damping = 0.2",
     "case.toml:32:11: coupling.damping = 0.2 is not allowed: it must be between 0 and 0.1."},
    {"damping = 0.1", "skin = 0", "case.toml:32:8: coupling.skin = 0 is not allowed"},
    {"damping = 0.1", "skin = 2.5", "case.toml:32:8: coupling.skin = 2.5 is not allowed"},
    {"damping = 0.1", "friction = -0.1",
     "case.toml:32:12: coupling.friction = -0.1 is not allowed"},
    {"damping = 0.1", "beta = 3", "case.toml:31:1: coupling = {...} leaves too little stability"},
    {"damping = 0.1", "friction_law = \"viscous\"",
     "case.toml:32:16: coupling.friction_law = \"viscous\" needs coupling.viscous_coefficient"},
    {"end = 1.0", "end = 0", "case.toml:4:7: time.end = 0 is not allowed: it must be > 0 s."},
    {"end = 1.0", "end = 1.0\ngrowth = 1", "case.toml:5:10: time.growth = 1 is not allowed"},
    {"end = 1.0", "end = 2026-01-01", "case.toml:4:7: dates and times have no meaning"},
    {"name = \"plate\"", "name = \"../plate\"",
     "case.toml:2:8: case.name = \"../plate\" is not allowed: it names a folder"},
    {"name = \"plate\"", "name = \"plate\"\nthickness = 2",
     "case.toml:3:13: case.thickness = 2 belongs to 2D cases"},
    {"name = \"plate\"", "name = \"plate\"\ndimension = 2\ngravity = [0, 1, -9.81]",
     "case.toml:4:11: case.gravity = [0, 1, -9.81] is not allowed: a 2D case lies in the x-z "
     "plane"},
    {"name = \"plate\"", "name = \"plate\"\ndimension = 2",
     "case.toml:20:13: fem.block.divisions = [4, 4, 1] is not allowed: a 2D case has one element"},
    {"[coupling]", "[couplin]",
     "case.toml:31:2: couplin = {...} is not a key of a case: allowed are case, time, start, "
     "output, checkpoint, sph, "
     "fem, coupling, backend, report; did you mean \"coupling\"?"},
    {"[case]", "[case", "case.toml:1:"},
};

}  // namespace

TEST_CASE("each mistake is told in one sentence with its place") {
    REQUIRE(mistake(plate).empty());
    for (const Mistake& m : mistakes) {
        INFO(m.from << " -> " << m.to);
        const std::string sentence = mistake(with(plate, m.from, m.to));
        CHECK_THAT(sentence, Catch::Matchers::StartsWith(m.sentence));
        CHECK(sentence.find('\n') == std::string::npos);
        CHECK(sentence.find_last_of(".?") == sentence.size() - 1);
    }
}

TEST_CASE("a name may be given once only") {
    const std::string twice =
        plate + "[[sph.plane]]\nname = \"floor\"\npoint = [0,0,0]\nnormal = [1,0,0]\n";
    CHECK(mistake(twice) ==
          "case.toml:34:8: sph.plane.floor.name = \"floor\" is taken: every [[sph.plane]] needs a "
          "name of its own.");
}

TEST_CASE("an implicit part has a material that stays elastic") {
    const std::string text = with(plate, "material = \"steel\"", "material = \"steel\"\nimplicit = true");
    CHECK(mistake(text).empty());
    CHECK(mistake(with(text, "poisson_ratio = 0.3",
                       "poisson_ratio = 0.3\nkind = \"tresca\"\nshear_strength = 1e4")) ==
          "case.toml:30:12: fem.part.0.implicit = true needs a material that stays elastic: kind = "
          "\"linear_elastic\".");
}

TEST_CASE("a mesh file must exist beside the case") {
    std::string text = plate;
    text.replace(text.find("[fem.block]"), text.find("[[fem.material]]") - text.find("[fem.block]"),
                 "[fem]\nmesh = \"wall.msh\"\n");
    CHECK_THAT(mistake(text), Catch::Matchers::StartsWith(
                                  "case.toml:18:8: fem.mesh = \"wall.msh\" does not exist"));
    const case_text::File file(text);
    std::ofstream(file.folder() + "/wall.msh") << "$MeshFormat\n";
    CHECK(undertow::read_case(file.path()).fem.mesh == "wall.msh");
}

TEST_CASE("a missing case file is named") {
    CHECK_THROWS_WITH(
        undertow::read_case("/nonexistent/case.toml"),
        Catch::Matchers::StartsWith("/nonexistent/case.toml: the case file could not be "
                                    "read: No such file or directory"));
}

TEST_CASE("a mistake on the command line is placed there") {
    CHECK(mistake(plate, {.set = {"sph.spacing=0"}}) ==
          "--set sph.spacing=0: sph.spacing = 0 is not allowed: it must be > 0 m.");
    CHECK_THAT(mistake(plate, {.set = {"sph.spacng=1"}}),
               Catch::Matchers::EndsWith("did you mean \"spacing\"?"));
    CHECK_THAT(mistake(plate, {.set = {"sph.spacing"}}),
               Catch::Matchers::StartsWith("--set sph.spacing: an override reads key=value"));
    CHECK_THAT(
        mistake(plate, {.set = {"sph.fluid.oil.density=1"}}),
        Catch::Matchers::StartsWith("--set sph.fluid.oil.density=1: sph.fluid has no entry"));
    CHECK_THAT(mistake(plate, {.set = {"sph.spacing.fine=1"}}),
               Catch::Matchers::StartsWith("--set sph.spacing.fine=1: sph.spacing is a number"));
    CHECK_THAT(mistake(plate, {.set = {"sph.fluid.density=1"}}),
               Catch::Matchers::StartsWith("--set sph.fluid.density=1: sph.fluid is an array"));
}

TEST_CASE("an unknown level or variant lists the known ones") {
    CHECK(mistake(plate, {.level = "quick"}) ==
          "case.toml: the case has no level \"quick\": it has no [level.NAME] tables at all.");
    const std::string text = plate + "[level.quick]\n[level.fine]\n[variant.gate]\n";
    CHECK(mistake(text, {.level = "quik"}) ==
          "case.toml: the case has no level \"quik\": known are quick, fine; did you mean "
          "\"quick\"?");
    CHECK(mistake(text, {.variants = {"rigid"}}) ==
          "case.toml: the case has no variant \"rigid\": known are gate.");
}
