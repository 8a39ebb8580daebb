#include "fem_solver/solver.hpp"

#include <utility>

#include "checkpoint/checkpoint_set.hpp"
#include "results/stop_signal.hpp"
#include "results/wall_clock.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {

namespace {
// Of the time that the structure is held: from here on the water counts as still.
constexpr double quiet_from = 0.6;
}  // namespace

Solver::Solver(const Case& c, Structure& structure, Link& link, Output& output, ProgressLine& line)
    : case_(c),
      structure_(structure),
      link_(link),
      output_(output),
      line_(line),
      t_end_(c.time.end),
      t_release_(c.start.settle) {}

bool Solver::step_to_the_end() {
    structure_.release_far_field();
    structure_.launch();
    const std::int64_t first = link_.announce(structure_, n_);
    if (resumed_ && first != n_)
        throw InputError("the coupler goes on at step " + std::to_string(first) +
                         ", this program's checkpoint is of step " + std::to_string(n_) +
                         ": the files are of different sets.");
    n_ = first;
    bool output_due = true;
    for (;; ++n_) {
        link_.send_state(n_, t_, structure_,
                         resumed_ ? structure_.offered() : structure_.stable_step(),
                         stop_requested());
        if (!resumed_) {
            structure_.measure_sections(output_.section_due(t_) || t_ >= t_end_ * (1 - 1e-12));
            structure_.internal_forces();  // while the coupler computes contact
            structure_.pressure_forces(t_);
            structure_.check_health(n_, t_);
            if (output_due) output_.fields(t_, structure_);
        }
        resumed_ = false;

        const StepOrder& order = wait_order();
        if (order.finish) return !order.interrupted;
        const bool moves = t_ >= t_release_;
        if (moves) structure_.let_go();
        structure_.contact_forces(order.f);
        if (!moves && t_ >= quiet_from * t_release_) structure_.observe_still_water(order.dt);
        if (output_.row_due(t_)) {
            if (moves) structure_.kick(order.dt);  // v^{n-1/2} -> v^{n+1/2}
            output_.history(t_, structure_);
            if (moves) structure_.drift(order.dt);  // x^n -> x^{n+1}
        } else if (moves) {
            structure_.advance(order.dt);  // both at once: nobody looks in between
        }
        if (!moves) structure_.hold();
        t_ = order.t1;
        output_due = order.output;
        count(order);
        show(order, false);
    }
}

/// The next step or the end; writes the checkpoints that are asked for in between.
const StepOrder& Solver::wait_order() {
    const StepOrder* order = &link_.wait_order();
    while (!order->checkpoint.empty()) {
        line_.update_now(live(*order, "writing " + order->checkpoint));
        link_.confirm(write_checkpoint(order->checkpoint));
        line_.kept("checkpoints/" + checkpoint_id(n_), t_);
        order = &link_.wait_order();
    }
    return *order;
}

bool Solver::run() {
    const double start = start_ = wall_clock() - figures_.wall;
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

ProgressFigures Solver::live(const StepOrder& order, std::string doing) const {
    ProgressFigures figures;
    figures.t = t_;
    figures.t_end = t_end_;
    figures.n = n_;
    figures.dt = order.dt;
    figures.limiter = order.limiter;
    figures.element_steps = double(structure_.elements().deformable()) * double(figures_.steps);
    figures.doing = std::move(doing);
    return figures;
}

void Solver::show(const StepOrder& order, bool last) {
    if (last)
        line_.finish(live(order));
    else if (n_ % 64 == 0 && line_.due())  // far more often than the line is drawn
        line_.update(live(order));
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
