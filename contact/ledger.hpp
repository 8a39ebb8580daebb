#pragma once
// Work and energy at the interface, in the measure in which leapfrog keeps kinetic energy:
// the kick of step n is F^n (dt^{n-1} + dt^n)/2 and does the work
//     W^n = F^n . (v^{n-1/2} + v^{n+1/2})/2 * (dt^{n-1} + dt^n)/2   [J]
// on each side, exactly the change of that side's kinetic energy by contact. v^{n+1/2} arrives with
// the next STATE, so a step is booked one step later. What the two sides do not return to each
// other must be found in the springs or be lost in damping, friction and falling stiffness:
//     residual = W_particles + W_surface + penalty + damping + friction + relaxation   [J]
// It is not zero by construction: it shows springs that open or close within a step, turning
// normals and any force that arrived wrong.

#include <cstdint>
#include <span>
#include <vector>

#include "contact/detection.hpp"

namespace undertow::contact {

struct InterfaceEnergy {
    double work_particles = 0;  // [J] done by contact on the particles since the start
    double work_surface = 0;    // [J] ... on the surface
    double penalty = 0;         // [J] stored now, sum of k d^2/2
    double damping = 0;         // [J] lost in normal damping so far
    double friction = 0;        // [J] lost in friction so far
    double relaxation = 0;      // [J] lost by stiffness that fell within a contact so far
    double turnover = 0;        // [J] sum of abs(W) of both sides: the scale of the residual
    double residual() const {
        return work_particles + work_surface + penalty + damping + friction + relaxation;
    }
    /// abs(residual) over half the turnover: the energy that passed the interface.
    double relative_residual() const;
};

struct StepFigures {
    double dt = 0;          // [s] dt^n
    double kick = 0;        // [s] (dt^{n-1} + dt^n)/2
    double relaxation = 0;  // [J] lost by falling stiffness at this step
};

class Ledger {
 public:
    /// Keeps what booking needs: call once per step after the forces. The contacts are not copied:
    /// book() is given them again.
    void keep(const Points& active, const Surface& surface, std::span<const double> on_particles,
              std::span<const double> on_nodes, std::span<const std::int32_t> touched_nodes,
              const StepFigures& step);

    /// Books the kept step with its contacts. v_particles [m/s] (A', 3) at n+1/2 with row_now[i]
    /// the row in it of kept active row i, or -1 if it is gone (empty: rows are unchanged).
    void book(const std::vector<Contact>& contacts, std::span<const double> v_particles,
              std::span<const std::int64_t> row_now, const Surface& surface);

    const InterfaceEnergy& energy() const { return energy_; }

 private:
    struct KeptNode {
        std::uint32_t node;
        Vec force;  // [N]
        Vec v;      // [m/s] at n - 1/2
    };

    InterfaceEnergy energy_;
    std::vector<double> force_, v_;  // [N], [m/s] of the active particles, (A, 3)
    std::vector<KeptNode> nodes_;
    StepFigures step_;
};

}  // namespace undertow::contact
