// Which error ends a program how.

#include "wire/failure.hpp"

#include <catch2/catch.hpp>
#include <new>

using namespace undertow;

TEST_CASE("every kind of error has its exit code and its code on the wire") {
    const auto check = [](const std::exception& error, int exit, const std::string& code,
                          const std::string& text) {
        const Failure failure = failure_of(error);
        CHECK(failure.exit == exit);
        CHECK(failure.code == code);
        CHECK(failure.text == text);
    };
    check(InputError("no such case"), 2, "E_INPUT", "no such case");
    check(PeerError("E_TIMEOUT", "fem is silent"), 3, "E_TIMEOUT", "E_TIMEOUT: fem is silent");
    check(PhysicsError("NaN"), 4, "E_PHYSICS", "NaN");
    check(std::logic_error("a row too short"), 4, "E_STATE", "internal error: a row too short");
    check(std::bad_alloc(), 2, "E_IO",
          "there is not enough memory (std::bad_alloc): take a coarser spacing or mesh, or a machine with "
          "more; `undertow check CASE` estimates what a case needs.");
    CHECK(failure_of(PeerError("E_STOP", "the user")).exit == exit_interrupted);
}
