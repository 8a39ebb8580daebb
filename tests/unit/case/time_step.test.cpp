#include "case/time_step.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "wire/errors.hpp"

using namespace undertow;

namespace {

TimeSettings until(double end) {
    TimeSettings time;
    time.end = end;
    return time;
}

struct Run {
    std::vector<double> outputs;
    std::vector<AgreedStep> steps;
};

/// Steps with a constant offer until the end.
Run run(const TimeSettings& time, double fields_every, double offer) {
    StepAgreement agreement(time, fields_every);
    Run result;
    for (double t = 0;;) {
        const AgreedStep step = agreement.agree(t, {{offer, "sph: sound"}});
        REQUIRE(step.t1 > t);
        REQUIRE(step.dt <= offer * (1 + 1e-9));
        t = step.t1;
        result.steps.push_back(step);
        if (step.output) result.outputs.push_back(t);
        if (step.last) return result;
        REQUIRE(result.steps.size() < 100000);
    }
}

}  // namespace

TEST_CASE("steps land exactly on the multiples of the output interval and on the end") {
    // 0.1 is no binary number: an accumulated sum would miss 0.3, 0.7, ...
    for (const double offer : {0.0013, 0.01, 0.033, 0.1, 0.25}) {
        INFO("offer " << offer);
        const Run result = run(until(1.05), 0.1, offer);
        REQUIRE(result.outputs.size() == 11);
        for (int i = 1; i <= 10; ++i)
            CHECK(result.outputs[static_cast<std::size_t>(i - 1)] == i * 0.1);
        CHECK(result.outputs.back() == 1.05);
    }
}

TEST_CASE("an end that is a multiple of the output interval is one output, not two") {
    const Run result = run(until(0.9), 0.01, 8.6e-4);
    CHECK(result.outputs.size() == 90);
    CHECK(result.outputs.back() == 0.9);
}

TEST_CASE("no sliver step: the rest of an interval is divided evenly") {
    for (const double offer : {0.0099, 0.0101, 0.0333, 0.07, 0.0999}) {
        INFO("offer " << offer);
        for (const AgreedStep& step : run(until(1), 0.1, offer).steps)
            CHECK(step.dt >
                  0.5 * offer * (1 - 1e-9));  // the worst case: one step becomes two halves
    }
}

TEST_CASE("the number of steps is the least that the offer allows") {
    // 0.1/0.0333 = 3.003: four steps in each of ten intervals.
    CHECK(run(until(1), 0.1, 0.0333).steps.size() == 40);
    CHECK(run(until(1), 0.1, 0.01).steps.size() == 100);
}

TEST_CASE("two peers with different dt advance by the smaller, whose name is told") {
    StepAgreement agreement(until(10), 10);
    const AgreedStep step = agreement.agree(0, {{0.02, "sph: sound"}, {0.01, "fem: hexahedron 3"}});
    CHECK(step.dt == 0.01);
    CHECK(step.limiter == "fem: hexahedron 3");
}

TEST_CASE("time.max_step limits as an offer does") {
    TimeSettings time = until(10);
    time.max_step = 0.005;
    const AgreedStep step = StepAgreement(time, 10).agree(0, {{0.02, "sph: sound"}});
    CHECK(step.dt == 0.005);
    CHECK(step.limiter == "time.max_step");
}

TEST_CASE("a step grows by at most time.growth and shrinks at once") {
    StepAgreement agreement(until(100), 100);
    CHECK(agreement.agree(0, {{0.01, "a"}}).dt == 0.01);
    const AgreedStep grown = agreement.agree(0.01, {{1.0, "a"}});
    CHECK(grown.dt == Approx(0.0105));
    CHECK(grown.limiter == "growth");
    CHECK(agreement.agree(0.0205, {{0.001, "a"}}).dt == 0.001);
}

TEST_CASE("a step cut short for an output does not slow the following ones") {
    StepAgreement agreement(until(1), 0.1);
    CHECK(agreement.agree(0, {{0.06, "a"}}).dt == Approx(0.05));  // two even halves
    CHECK(agreement.agree(0.05, {{0.06, "a"}}).limiter == "output");
    // The free step was 0.06 all along: 0.1/0.06 -> two steps, not held back by 1.05 * 0.05.
    TimeSettings time = until(100);
    StepAgreement other(time, 10);
    CHECK(other.agree(9.99, {{0.5, "a"}}).dt == Approx(0.01));
    CHECK(other.agree(10, {{0.5, "a"}}).dt == 0.5);
}

TEST_CASE("a step below time.min_step stops the run and names the limiter") {
    TimeSettings time = until(1);
    time.min_step = 1e-6;
    StepAgreement agreement(time, 0.1);
    try {
        agreement.agree(0.25, {{1e-3, "sph: sound"}, {1e-7, "fem: hexahedron 17"}});
        FAIL("no error");
    } catch (const PhysicsError& error) {
        CHECK_THAT(error.what(), Catch::Matchers::Contains("t = 0.25 s") &&
                                     Catch::Matchers::Contains("fem: hexahedron 17"));
    }
    CHECK_THROWS_AS(agreement.agree(0.25, {{std::nan(""), "sph: sound"}}), PhysicsError);
    // Landing on an output time may need less than min_step; that is no collapse.
    CHECK(agreement.agree(0.1 - 1e-9, {{1e-3, "sph: sound"}}).t1 == 0.1);
}

TEST_CASE("a run that goes on in the middle keeps the output times") {
    StepAgreement agreement(until(1), 0.1);
    CHECK(agreement.agree(0.55, {{0.2, "a"}}).t1 == 6 * 0.1);
}

TEST_CASE("without field output only the end is an output time") {
    const Run result = run(until(1), 0, 0.3);
    CHECK(result.outputs == std::vector<double>{1});
}
