#pragma once
// The FEM solver: a structure, a link that grants steps, and what it writes.

#include <string>

#include "fem_solver/coupling.hpp"
#include "fem_solver/output.hpp"
#include "fem_solver/structure.hpp"
#include "results/progress.hpp"

namespace undertow::fem {

class Solver {
 public:
    /// Borrows structure and link. `line` shows the run's progress (quiet in a coupled run, where
    /// the coupler shows it).
    Solver(const Case& c, Structure& structure, Link& link, Output& output, ProgressLine& line);

    /// Takes over the state of a checkpoint; InputError when it belongs to something else.
    void resume(const std::string& set);

    /// Runs to the end; true, or false when the user ended it. PhysicsError and PeerError pass
    /// through, after the last state has been written.
    bool run();

 private:
    bool step_to_the_end();
    const StepOrder& wait_order();
    WrittenFile write_checkpoint(const std::string& id);
    void archive(Archive& a);
    void count(const StepOrder& order);
    ProgressFigures live(const StepOrder& order, std::string doing = {}) const;
    void show(const StepOrder& order, bool last);
    void close(double start);

    const Case& case_;
    Structure& structure_;
    Link& link_;
    Output& output_;
    ProgressLine& line_;
    double t_end_;      // [s]
    double t_release_;  // [s] until then the structure does not move
    double t_ = 0;  // [s]
    std::int64_t n_ = 0;
    bool resumed_ = false;  // forces at n are those of the checkpoint
    double start_ = 0;      // [s] wall clock, less what a run before took
    RunFigures figures_;
};

}  // namespace undertow::fem
