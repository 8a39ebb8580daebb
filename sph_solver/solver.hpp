#pragma once
// The SPH program: setup, the loop, the end.

#include <string>

#include "case/case.hpp"

namespace undertow::sph {

struct SolverOptions {
    std::string folder;      // results
    std::string endpoint;    // of the coupler; empty = alone
    int threads = 0;         // 0 = all
    bool quiet = false;
    std::string keys;        // folder of keys for a coupler on another host; empty = none
    std::string resume;      // a set of checkpoints to go on from; empty = from the start
};

/// Runs the case to its end. Returns exit_done or exit_interrupted; throws InputError, PeerError,
/// PhysicsError (after the coupler has been told).
int run(const Case& input, const SolverOptions& options);

}  // namespace undertow::sph
