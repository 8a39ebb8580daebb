#pragma once
// The solver's checkpoints: what the loop itself keeps, and where the file goes.

#include <string>

#include "sph_solver/coupling.hpp"
#include "sph_solver/recorder.hpp"

namespace undertow::sph {

/// Where the loop stands when it waits for its step.
struct LoopState {
    std::int64_t n = 0;
    double t = 0, dt = 0, dt_before = 0;  // [s] of the steps that led here
    bool two_pass = false;                // how step n sums
    double dt_limit = 0;                  // [s] as it was offered
    std::string limiter;

    void archive(Archive& a);
};

class Checkpoints {
 public:
    /// Borrows all of them. folder: of the results.
    Checkpoints(const Case& input, const std::string& folder, LoopState& loop, FluidSystem& fluid,
                Link& link, Recorder& recorder, RunFigures& figures)
        : input_(input),
          folder_(folder),
          loop_(loop),
          fluid_(fluid),
          link_(link),
          recorder_(recorder),
          figures_(figures) {}

    /// wall [s]: of the run so far.
    WrittenFile write(const std::string& id, double wall);
    /// Takes over the state of a set; InputError when it belongs to something else.
    void resume(const std::string& set);

 private:
    void archive(Archive& a);

    const Case& input_;
    std::string folder_;
    LoopState& loop_;
    FluidSystem& fluid_;
    Link& link_;
    Recorder& recorder_;
    RunFigures& figures_;
};

}  // namespace undertow::sph
