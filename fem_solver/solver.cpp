#include "fem_solver/solver.hpp"

#include "results/stop_signal.hpp"
#include "results/wall_clock.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {

Solver::Solver(const Case& c, Structure& structure, Link& link, Output& output, ProgressLine& line)
    : structure_(structure), link_(link), output_(output), line_(line), t_end_(c.time.end),
      t_release_(c.start.settle) {}

bool Solver::step_to_the_end() {
    structure_.release_far_field();
    n_ = link_.announce(structure_);
    bool output_due = true;
    for (;; ++n_) {
        link_.send_state(n_, t_, structure_, structure_.stable_step(), stop_requested());
        structure_.internal_forces();  // while the coupler computes contact
        structure_.pressure_forces(t_);
        structure_.check_health(n_, t_);
        if (output_due) output_.fields(t_, structure_);

        const StepOrder& order = link_.wait_order();
        if (order.finish) return !order.interrupted;
        structure_.contact_forces(order.f);
        const bool moves = t_ >= t_release_;
        if (moves) structure_.kick(order.dt);  // v^{n-1/2} -> v^{n+1/2}
        output_.history(t_, structure_);
        if (moves)
            structure_.drift(order.dt);  // x^n -> x^{n+1}
        else
            structure_.hold();
        t_ = order.t1;
        output_due = order.output;
        count(order);
        show(order, false);
    }
}

bool Solver::run() {
    const double start = wall_clock();
    try {
        figures_.complete = step_to_the_end();
        structure_.finish();
        output_.fields(t_, structure_);
        output_.last_history(t_, structure_);
        link_.say_goodbye(n_);
    } catch (const PhysicsError&) {
        output_.fields(t_, structure_);  // what went wrong is best seen
        close(start);
        throw;
    } catch (const PeerError&) {
        close(start);
        throw;
    }
    close(start);
    return figures_.complete;
}

void Solver::count(const StepOrder& order) {
    if (figures_.steps++ == 0 || order.dt < figures_.dt_min) figures_.dt_min = order.dt;
    // steps cut short to land on an output say nothing about the run
    if (figures_.limiter != order.limiter && order.limiter != "output")
        figures_.limiter = order.limiter;
    figures_.t = t_;
}

void Solver::show(const StepOrder& order, bool last) {
    if (n_ % 64 != 0 && !last) return;  // far more often than the line is drawn
    ProgressFigures figures;
    figures.t = t_;
    figures.t_end = t_end_;
    figures.n = n_;
    figures.dt = order.dt;
    figures.limiter = order.limiter;
    figures.element_steps = double(structure_.elements().deformable()) * double(figures_.steps);
    if (last)
        line_.finish(figures);
    else
        line_.update(figures);
}

void Solver::close(double start) {
    figures_.wall = wall_clock() - start;
    figures_.wait = link_.waited();
    StepOrder order;
    order.limiter = figures_.limiter;
    order.dt = figures_.dt_min;
    show(order, true);
    output_.summary(figures_, structure_);
}

}  // namespace undertow::fem
