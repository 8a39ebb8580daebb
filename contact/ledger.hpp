#pragma once
// Work and energy at the interface, in the measure in which leapfrog keeps kinetic energy:
// the kick of step n is F^n (dt^{n-1} + dt^n)/2 and does the work
//     W^n = F^n . (v^{n-1/2} + v^{n+1/2})/2 * (dt^{n-1} + dt^n)/2   [J]
// on each side, exactly the change of that side's kinetic energy by contact. v^{n+1/2} arrives with
// the next STATE, so a step is booked one step later. What the two sides do not return to each
// other must be found in the springs, be lost in damping, friction and falling stiffness, or be
// what leapfrog makes of springs that do not simply stay closed:
//     residual = W_particles + W_surface + penalty + damping + friction + relaxation
//                + impact + uneven + turning   [J]
// Of one spring, with closing speeds w- and w+ around step n and the depths d- = d - dt^{n-1} w-
// and d+ = d + dt^n w+ that follow from them, the elastic force k d does the work
//     - k d (w- + w+)/2 kick = k d d-/2 - k d d+/2  - k d (dt^{n-1} - dt^n)(w+ - w-)/4
// an identity. k d d+/2 of a step and k d d-/2 of the next are the same energy if the spring stays
// closed, k stays what it is and the depth changes as the velocities say; where they differ:
//     impact      it closes: - k d d-/2, opens: k d d+/2
//     relaxation  k falls: (k' - k) d d'/2
//     turning     the depth is not what the velocities say: the normal turned, the contact went to
//                 another facet, a solver moved a point otherwise than by its velocity
//     uneven      dt changes: the last term above
// Sums run in eight lanes, contact c in lane c mod 8, and the lanes are added up at the end: the
// result does not depend on who computes it.
//
// Works come from forces and velocities of particles and nodes, everything else from the contacts:
// what is left over is round-off, or a force that was not what its contact says.

#include <cstdint>
#include <span>
#include <vector>

#include "contact/detection.hpp"

namespace undertow {
class Archive;
}

namespace undertow::contact {

struct InterfaceEnergy {
    double work_particles = 0;  // [J] done by contact on the particles since the start
    double work_surface = 0;    // [J] ... on the surface
    double penalty = 0;         // [J] stored now, sum of k d^2/2
    double damping = 0;         // [J] lost in normal damping so far
    double friction = 0;        // [J] lost in friction so far
    double relaxation = 0;      // [J] lost by stiffness that fell within a contact so far
    double impact = 0;          // [J] lost by springs that closed or opened; may be negative
    double uneven = 0;          // [J] lost by a changing dt; may be negative
    double turning = 0;         // [J] lost by depths that velocities do not explain; the same
    double turnover = 0;        // [J] sum of abs(W) of both sides: the scale of the residual
    double residual() const {
        return work_particles + work_surface + penalty + damping + friction + relaxation + impact +
               uneven + turning;
    }
    /// abs(residual) over half the turnover: the energy that passed the interface.
    double relative_residual() const;
    /// [J] what no physics accounts for: positive if the time integration lost energy.
    double numerical_loss() const { return impact + uneven + turning; }
    double relative_numerical_loss() const;  // over half the turnover
};

struct StepFigures {
    double dt_before = 0;  // [s] dt^{n-1}, 0 at the first step
    double dt = 0;         // [s] dt^n
    double kick() const { return 0.5 * (dt_before + dt); }
};

/// Where the active particles of the step before are now.
struct RowChanges {
    std::span<const std::int64_t> now;  // rows in v_particles, -1 = gone; empty: unchanged
    std::span<const std::int64_t> was;  // of each active particle its former row, -1 = none
    bool none() const { return now.empty() && was.empty(); }
};

class Ledger {
 public:
    /// Keeps what booking needs: call once per step after the forces. The contacts are not copied:
    /// book() is given them again.
    void keep(const Points& active, const Surface& surface, std::span<const double> on_particles,
              std::span<const double> on_nodes, std::span<const std::int32_t> touched_nodes,
              const StepFigures& step);

    /// Books the kept step with its contacts, and what became of them in the present step, whose
    /// forces are known. v_particles [m/s] (A', 3) at n+1/2.
    void book(const ContactList& contacts, std::span<const double> v_particles,
              const RowChanges& rows, const Surface& surface, const ContactList& present);

    const InterfaceEnergy& energy() const { return energy_; }
    void archive(Archive& a);

 private:
    void book_work(std::span<const double> v_particles, const RowChanges& rows,
                   const Surface& surface);
    void book_contacts(const ContactList& contacts, std::span<const double> v_particles,
                       const RowChanges& rows, const Surface& surface);
    void book_changes(const ContactList& contacts, const RowChanges& rows,
                      const ContactList& present);

    /// Eight touched nodes; lanes beyond the last have no force.
    struct alignas(64) KeptNodes {
        LaneRows node{}, none{};  // the second fills the line: every byte goes into checkpoints
        Three<Lanes> force;  // [N]
        Three<Lanes> v;      // [m/s] at n - 1/2
    };
    Three<Lanes> velocity_after(const ContactPack& pack, std::span<const double> v_particles,
                                const RowChanges& rows) const;
    bool follow_pack(const ContactList& contacts, const RowChanges& rows,
                     const ContactList& present, std::size_t p, Lanes& penalty, Lanes& turning,
                     Lanes& relaxation);
    void follow_one(const ContactList& contacts, const RowChanges& rows,
                    const ContactList& present, std::size_t p, int lane, Lanes& penalty,
                    Lanes& impact, Lanes& turning, Lanes& relaxation);

    InterfaceEnergy energy_;
    std::vector<double> force_, v_;  // [N], [m/s] of the active particles, (A, 3)
    std::vector<KeptNodes> nodes_;
    std::vector<double> ahead_;         // [m] d+ of each contact of the kept step
    std::vector<std::int32_t> follow_;  // of each, the present contact that carries it on, or -1
    std::vector<std::int32_t> first_;   // of each kept active row, its first contact, or -1
    StepFigures step_;
};

}  // namespace undertow::contact
