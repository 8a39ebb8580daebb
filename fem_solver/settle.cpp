#include "fem_solver/settle.hpp"

#include <algorithm>
#include <cmath>

#include "results/log.hpp"
#include "results/stop_signal.hpp"
#include "results/wall_clock.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

constexpr double log_every = 10;  // [s] of wall time

/// What is left, against what is allowed.
struct Goal {
    double tolerance = 0;
    double reference = 0;  // [N]

    bool reached(const Residual& r) const {
        return r.node <= tolerance * reference && r.body <= tolerance;
    }
    std::string text(const Residual& r) const {
        std::string words = "largest force left on a node " + number_text(r.node, 3) + " N (goal " +
                            number_text(tolerance * reference, 3) + " N)";
        if (r.body > 0)
            words += ", on a rigid body " + number_text(r.body, 3) + " of its weight (goal " +
                     number_text(tolerance, 3) + ")";
        return words;
    }
};

std::string place_of(const Structure& structure, const Residual& r) {
    if (r.at < 0) return "";
    const double* x = structure.nodes().x[r.at].c;
    return " at " + point_text({x[0], x[1], x[2]});
}

}  // namespace

Settlement settle(Structure& structure, const FemSettle& settings) {
    const double start = wall_clock();
    double last_log = start, kinetic_before = 0;
    Goal goal{settings.tolerance, 0};
    structure.rest_motions();
    Settlement report;
    Residual left;
    for (;; ++report.steps) {
        const double dt = structure.stable_step().dt;
        structure.internal_forces();
        structure.pressure_forces(0);
        structure.check_health(report.steps, 0);
        const bool first = report.steps == 0;
        // Of everything together: peaks of a rigid body's own energy come with its fast swing on
        // the springs of contact, and ending that motion alone makes it creep (16 times the steps).
        const bool peak = structure.kinetic_energy() < kinetic_before;
        if (first || peak) {
            left = structure.residual();
            if (first) goal.reference = left.reference > 0 ? left.reference : left.node;
            structure.stop();
            report.stops += peak;
            if (goal.reached(left)) break;
        }
        if (report.steps == settings.max_steps)
            throw PhysicsError(
                "fem.settle: no equilibrium after " + std::to_string(report.steps) +
                " steps: " + goal.text(left) + place_of(structure, left) +
                ", largest displacement " + number_text(structure.largest_displacement(), 3) +
                " m. Raise fem.settle.max_steps if the force still falls (see the log); if it "
                "does not, the ground may be too weak for what stands on it.");
        if (stop_requested()) return report;
        kinetic_before = peak ? 0 : structure.kinetic_energy();
        structure.advance(dt);
        if (wall_clock() - last_log > log_every) {
            last_log = wall_clock();
            log_info("settling: step " + std::to_string(report.steps) + ", " + goal.text(left));
        }
    }
    report.complete = true;
    report.residual = left.node;
    report.reference = goal.reference;
    report.body_residual = left.body;
    report.largest_displacement = structure.largest_displacement();
    for (const RigidBody& body : structure.bodies())
        report.body_displacement.push_back(body.displacement());
    structure.hold();  // the forces found here are found again in the first step
    structure.count_from_here();
    report.wall = wall_clock() - start;
    return report;
}

}  // namespace undertow::fem
