#pragma once
// Three kinds of trouble, three exit codes. Thrown near the cause, caught once, in main.

#include <stdexcept>
#include <string>

namespace undertow {

enum ExitCode : int { exit_done = 0, exit_input = 2, exit_peer = 3, exit_physics = 4, exit_interrupted = 130 };

/// The user's input is wrong. The text is one sentence: what is wrong, where, what to do.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file or a disk does not take or give what it should; E_IO for the peers, the user's to mend.
struct FileError : InputError {
    using InputError::InputError;
};

/// A peer failed: lost, late, wrong version, malformed. `code` is one of the protocol's E_ codes.
struct PeerError : std::runtime_error {
    PeerError(std::string error_code, const std::string& text)
        : std::runtime_error(text), code(std::move(error_code)) {}
    std::string code;
};

/// The computation is in trouble: NaN, inverted element, collapsed step.
struct PhysicsError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A stable step below time.min_step; E_DT for the peers.
struct StepCollapse : PhysicsError {
    using PhysicsError::PhysicsError;
};

}  // namespace undertow
