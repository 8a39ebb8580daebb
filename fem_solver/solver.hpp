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

    /// Runs to the end; true, or false when the user ended it. PhysicsError and PeerError pass
    /// through, after the last state has been written.
    bool run();

 private:
    bool step_to_the_end();
    void count(const StepOrder& order);
    void show(const StepOrder& order, bool last);
    void close(double start);

    Structure& structure_;
    Link& link_;
    Output& output_;
    ProgressLine& line_;
    double t_end_;      // [s]
    double t_release_;  // [s] until then the structure does not move
    double t_ = 0;  // [s]
    std::int64_t n_ = 0;
    RunFigures figures_;
};

}  // namespace undertow::fem
