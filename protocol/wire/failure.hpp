#pragma once
// What an error means to those outside a program.

#include <exception>
#include <string>

#include "wire/errors.hpp"

namespace undertow {

struct Failure {
    ExitCode exit;
    std::string code;  // of an ERROR to the other programs
    std::string text;  // for the log
};

/// PeerError: 3 and its own code (E_STOP: 130, the user ended the run). PhysicsError: 4, E_PHYSICS. InputError: 2, E_INPUT. A
/// std::logic_error is a defect of the program: 4, E_STATE. Anything else is the machine's trouble,
/// such as no memory: 2, E_IO.
Failure failure_of(const std::exception& error);

}  // namespace undertow
