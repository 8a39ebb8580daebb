// Formulas of x, y, z, t in a case file: their values, and one sentence for each mistake.

#include "case/expression.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "case_text.hpp"

using case_text::mistake;
using case_text::plate;
using case_text::with;
using undertow::Case;
using undertow::Expression;
using undertow::InputError;

namespace {

std::string sentence(const std::string& text, const std::string& variables = "xyz") {
    try {
        Expression(text, variables, "case.toml:3:5: key");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// The box of water with one more line in its [[sph.fill]].
std::string fill_with(const std::string& line) {
    return with(plate, "box = {", line + "\nbox = {");
}

}  // namespace

TEST_CASE("a formula has the value C++ gives it", "[case]") {
    const Expression f("-cos(2*pi*x)*sin(2*pi*z) + y^2 - exp(-t)", "xyzt", "place");
    for (const double x : {0.0, 0.3, -1.7})
        REQUIRE(f(x, 0.5, 2 * x, x) ==
                Approx(-std::cos(2 * M_PI * x) * std::sin(4 * M_PI * x) + 0.25 - std::exp(-x))
                    .epsilon(1e-14));  // round-off
    REQUIRE(Expression("x < 0.5 ? 1 : -1", "x", "")(0.4, 0, 0) == 1);
    REQUIRE(Expression("atan2(z, x) == 0", "xz", "")(1, 0, 0) == 1);
}

TEST_CASE("a copy of a formula stands by itself", "[case]") {
    auto first = std::make_unique<Expression>("x + z", "xz", "place");
    Expression copy = *first, other("1", "", "place");
    other = *first;
    first.reset();
    REQUIRE(copy(1, 0, 2) == 3);
    REQUIRE(other(2, 0, 2) == 4);
}

TEST_CASE("what is no formula is refused with its place and what is allowed", "[case]") {
    REQUIRE(
        sentence("sin(q)") ==
        "case.toml:3:5: key = \"sin(q)\" is no formula: \"q\" is not known; it may use x, y and "
        "z, pi, numbers, + - * / ^ and functions such as sin, exp, sqrt, min.");
    REQUIRE_THAT(sentence("x + t"), Catch::Contains("\"t\" is not known"));
    REQUIRE_THAT(sentence("sin(x"), Catch::Contains("is no formula: "));
    REQUIRE_THAT(sentence(""), Catch::Contains("is no formula: "));
    REQUIRE_THAT(sentence("x, z"), Catch::Contains("it has 2 values, one is expected"));
    REQUIRE_THAT(sentence("x = 3"), Catch::Contains("nothing can be assigned"));
    REQUIRE(sentence("x == 3").empty());
}

TEST_CASE("a formula without a value somewhere says where", "[case]") {
    const Expression f("sqrt(x)", "xz", "case.toml:3:5: key");
    REQUIRE(f(4, 0, 0) == 2);
    REQUIRE_THROWS_WITH(f(-1, 0, 0.5), Catch::StartsWith("case.toml:3:5: key = \"sqrt(x)\" is not "
                                                         "finite at x = -1, z = 0.5"));
}

TEST_CASE("a fill's velocity may be formulas, its pressure too", "[case]") {
    const Case c =
        case_text::read(fill_with("velocity = [\"2*x\", 0, \"-2*z\"]\npressure = \"1000*x\""));
    const undertow::Fill& fill = c.sph.fill[0];
    REQUIRE(fill.velocity_field.size() == 3);
    REQUIRE(fill.velocity_field[0](3, 0, 0) == 6);
    REQUIRE(fill.velocity_field[1](3, 1, 1) == 0);
    REQUIRE((*fill.pressure)(0.5, 0, 0) == 500);
    REQUIRE(case_text::read(fill_with("velocity = [1, 0, 0]")).sph.fill[0].velocity_field.empty());
    REQUIRE((*case_text::read(fill_with("pressure = 7")).sph.fill[0].pressure)(0, 0, 0) == 7);
}

TEST_CASE("mistakes in a fill's formulas are found when the case is read", "[case]") {
    REQUIRE_THAT(
        mistake(fill_with("velocity = [0, \"2*u\", 0]")),
        Catch::StartsWith(
            "case.toml:12:16: sph.fill.0.velocity[1] = \"2*u\" is no formula: \"u\" is not "
            "known"));
    REQUIRE_THAT(mistake(fill_with("velocity = [\"x\", true, 0]")),
                 Catch::Contains("sph.fill.0.velocity[1] = true is a boolean: a finite number or a "
                                 "formula in quotes in m/s is expected."));
    REQUIRE_THAT(mistake(fill_with("pressure = [1, 2]")), Catch::Contains("is an array"));
    REQUIRE_THAT(mistake(fill_with("velocity = [\"x\", 0, 0]\nramp = 1")),
                 Catch::Contains("a block moves as one"));
    REQUIRE_THAT(mistake(fill_with("pressure = 5\nsurface_level = 1")),
                 Catch::Contains("one pressure too many"));
    REQUIRE_THAT(mistake(with(fill_with("velocity = [\"x\", \"y\", 0]"), "name = \"plate\"",
                              "name = \"plate\"\ndimension = 2")),
                 Catch::Contains("y must be 0"));
}
