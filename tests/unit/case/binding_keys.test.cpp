// What makes a case the same case: the keys that a checkpoint and the programs of a run must agree
// on.

#include <algorithm>
#include <catch2/catch.hpp>

#include "case/binding_keys.hpp"
#include "case_text.hpp"

using namespace undertow;
using case_text::plate;
using case_text::read;
using case_text::with;

namespace {

using Lines = std::vector<std::string>;

Lines keys_of(const std::string& text, const CaseOptions& options = {}) {
    return binding_keys(read(text, options));
}

bool holds(const Lines& lines, const std::string& line) {
    return std::find(lines.begin(), lines.end(), line) != lines.end();
}

}  // namespace

TEST_CASE("keys stand there as written, with what is laid over them") {
    const Lines lines = keys_of(plate + "[level.fine]\nsph.spacing = 0.05\n",
                                {.level = "fine", .set = {"fem.material.steel.density=8000"}});
    CHECK(holds(lines, "sph.spacing = 0.05"));
    CHECK(holds(lines, "fem.material.steel.density = 8000"));
    CHECK(holds(lines, "case.name = \"plate\""));
    CHECK(holds(lines, "sph.fill.0.box.max = [1, 1, 1]"));
}

TEST_CASE("what decides no result is left out") {
    const Lines lines = keys_of(with(plate, "[coupling]",
                                     "[output]\nfields_every = 0.1\n[checkpoint]\nevery = 0.5\n"
                                     "[report]\nsnapshots = [1]\n[coupling]\ndeadline = 5\n"
                                     "join_timeout = 5\ntransport = \"tcp\""));
    for (const std::string& line : lines) {
        CAPTURE(line);
        for (const char* free :
             {"time.end", "output.", "checkpoint.", "report.", "coupling.deadline",
              "coupling.join_timeout", "coupling.transport"})
            CHECK_FALSE(line.starts_with(free));
    }
    CHECK(holds(lines, "coupling.damping = 0.1"));
    CHECK_FALSE(is_binding("time.end = 3"));
    CHECK(is_binding("time.end_of_days = 3"));
    CHECK(is_binding("time.max_step = 1e-3"));
    CHECK(is_binding("case.name = \"a\""));
}

TEST_CASE("the same case in another order, with comments and longer numbers, is the same") {
    const std::string again = with(with(plate, "spacing = 0.1", "spacing = 0.100 # m"),
                                   "density = 7850\nyoung_modulus = 210e9",
                                   "young_modulus = 210000000000\ndensity = 7850.0");
    CHECK_FALSE(first_difference(keys_of(plate), keys_of(again)));
}

TEST_CASE("the first key that differs is named with both values, and how many do") {
    const Lines ours = keys_of(plate);
    const auto one = first_difference(ours, keys_of(with(plate, "spacing = 0.1", "spacing = 0.2")));
    REQUIRE(one);
    CHECK(one->key == "sph.spacing");
    CHECK(one->ours == "0.1");
    CHECK(one->theirs == "0.2");
    CHECK(one->count == 1);

    const auto missing = first_difference(ours, keys_of(with(plate, "damping = 0.1\n", "")));
    REQUIRE(missing);
    CHECK(missing->key == "coupling.damping");
    CHECK(missing->ours == "0.1");
    CHECK_FALSE(missing->theirs);

    const auto more =
        first_difference(ours, keys_of(with(with(plate, "spacing = 0.1", "spacing = 0.2"),
                                            "end = 1.0", "end = 1.0\ngrowth = 1.05")));
    REQUIRE(more);
    CHECK(more->key == "sph.spacing");  // what the coupler has comes first
    CHECK(more->count == 2);
}

TEST_CASE("long values are compared by their sum") {
    const auto table = [](const std::string& last) {
        std::string rows = "[[0, 1e6]";
        for (int i = 1; i < 14; ++i) rows += ", [0." + std::to_string(10 + i) + ", 2e6]";
        return with(plate, "poisson_ratio = 0.3",
                    "poisson_ratio = 0.3\nkind = \"j2\"\nhardening_table = " + rows + ", [9, " +
                        last + "]]");
    };
    const Lines ours = keys_of(table("3e6"));
    const auto line = std::find_if(ours.begin(), ours.end(), [](const std::string& l) {
        return l.starts_with("fem.material.steel.hardening_table = ");
    });
    REQUIRE(line != ours.end());
    CHECK(line->size() < 70);
    CHECK_FALSE(first_difference(ours, keys_of(table("3e6"))));
    const auto difference = first_difference(ours, keys_of(table("4e6")));
    REQUIRE(difference);
    CHECK(difference->key == "fem.material.steel.hardening_table");
    CHECK(difference->ours->starts_with("#"));
}

TEST_CASE("a case of thousands of keys is compared table by table, also with a smaller one") {
    const auto many = [](int last) {
        std::string text = plate;
        for (int i = 0; i <= last; ++i)
            text += "[[fem.probe]]\nname = \"p" + std::to_string(i) + "\"\npoint = [0, 0, 0]\n";
        return text;
    };
    const Lines ours = keys_of(many(800));
    REQUIRE(ours.size() == 4);  // case, sph, fem, coupling: time has no more than its end
    CHECK_FALSE(first_difference(ours, keys_of(many(800))));
    for (const int others : {799, 3}) {
        CAPTURE(others);
        const auto difference = first_difference(ours, keys_of(many(others)));
        REQUIRE(difference);
        CHECK(difference->key == "fem");
        CHECK(difference->count == 1);
    }
}
