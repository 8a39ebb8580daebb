#include "case/case_file.hpp"

#include <catch2/catch.hpp>

#include "case_text.hpp"

using namespace undertow;
using case_text::plate;
using case_text::read;
using case_text::with;

TEST_CASE("a case reads as written, with defaults for the rest") {
    const Case c = read(plate);
    CHECK(c.info.name == "plate");
    CHECK(c.info.title == "plate");
    CHECK(c.info.dimension == 3);
    CHECK(c.info.gravity == Vec3{0, 0, -9.81});
    CHECK(c.time.growth == 1.05);
    CHECK(std::isinf(c.time.max_step));
    CHECK(c.sph.present);
    CHECK(c.sph.kernel == Kernel::wendland_c2);
    CHECK_FALSE(c.sph.fluid[0].sound_speed);  // "auto"
    CHECK(c.sph.fill[0].box.max == Vec3{1, 1, 1});
    CHECK_FALSE(c.sph.fill[0].surface_level);
    CHECK_FALSE(c.sph.domain);
    CHECK(c.fem.block->divisions == std::array<int, 3>{4, 4, 1});
    CHECK(c.fem.material[0].young_modulus == 210e9);
    CHECK(c.coupling.law == StiffnessLaw::fluid);
    CHECK(c.coupling.transport == "shm");
}

TEST_CASE("directions are normalized and history intervals are filled in") {
    const Case c = read(plate + "[[sph.gauge]]\nname = \"tip\"\nkind = \"front\"\n");
    CHECK(c.sph.plane[0].normal == Vec3{0, 0, 1});  // written as [0, 0, 2]
    CHECK(c.output.history_every == Approx(c.time.end / 2000));
}

TEST_CASE("a 2D case ignores y of its boxes and needs a slab one element thick") {
    std::string text =
        with(plate, "name = \"plate\"", "name = \"plate\"\ndimension = 2\nthickness = 0.5");
    text = with(text, "max = [1, 1, 1]", "max = [1, 0, 1]");
    text = with(text, "box = { min = [0, 0, -0.2], max = [1, 1, 0] }",
                "box = { min = [0, 0, -0.2], max = [1, 0.5, 0] }");
    text = with(text, "divisions = [4, 4, 1]", "divisions = [4, 1, 1]");
    const Case c = read(text);
    CHECK(c.info.dimension == 2);
    CHECK(c.info.thickness == 0.5);
}

TEST_CASE("either solver alone makes a case, and a folder stands for its case.toml") {
    const case_text::File file(plate);
    const Case sph = read_case(file.folder(), {.set = {"fem=false", "coupling=false"}});
    CHECK((sph.sph.present && !sph.fem.present));
    CHECK(sph.folder == file.folder());
    const Case fem = read_case(file.folder(), {.set = {"sph=false", "coupling=false"}});
    CHECK((fem.fem.present && !fem.sph.present));
}

TEST_CASE("free-form tables pass through, and a backend may stand in for the fem table") {
    const std::string text =
        plate + "[backend.spring]\nstiffness = 1e6\nnested = { a = [1, 2] }\n[report]\nx = \"y\"\n";
    const case_text::File file(text);
    const ResolvedCase resolved = resolve_case(file.path());
    REQUIRE(resolved.backend.find("spring"));
    CHECK(resolved.backend.find("spring")->find("stiffness")->number == 1e6);
    CHECK(resolved.report.find("x")->text == "y");
    CHECK(resolved.coupled);
    CHECK(resolve_case(file.path(), {.set = {"fem=false"}}).coupled);
    CHECK_FALSE(resolve_case(file.path(), {.set = {"fem=false", "coupling=false"}}).coupled);
}

TEST_CASE("the cases of this repository are valid at every level and in every variant") {
    for (const auto& entry : std::filesystem::directory_iterator(UNDERTOW_CASES)) {
        if (!std::filesystem::exists(entry.path() / "case.toml")) continue;
        INFO(entry.path().string());
        ResolvedCase base;
        REQUIRE_NOTHROW(base = resolve_case(entry.path().string()));
        for (const std::string& level : base.levels)
            CHECK_NOTHROW(resolve_case(entry.path().string(), {.level = level}));
        for (const std::string& variant : base.variants)
            CHECK_NOTHROW(resolve_case(entry.path().string(), {.variants = {variant}}));
    }
}
