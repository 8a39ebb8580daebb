#pragma once
// The structure in motion: nodes, elements and loads, and what can happen to them in a step.
// solver.cpp calls these in the order of the step; tests do the same without files and wire.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem_solver/boundary/nodal_load.hpp"
#include "fem_solver/contact_pairs/contact_pair.hpp"
#include "fem_solver/elements/element_groups.hpp"
#include "fem_solver/implicit/implicit_parts.hpp"
#include "fem_solver/nodes.hpp"
#include "fem_solver/physics/stiffness_damping.hpp"
#include "fem_solver/rigid/rigid_body.hpp"
#include "fem_solver/setup/model.hpp"
#include "fem_solver/shells/shell_faces.hpp"

namespace undertow::fem {

/// [J] at n, all from the start. What went in is external and contact work; where it is now or was
/// dissipated are the others.
struct Energies {
    double kinetic = 0;         // 1/2 m v^{n-1/2} . v^{n+1/2}
    double internal = 0;        // work of the stresses, without
    double plastic = 0;         // dissipated by plastic flow
    double hourglass = 0;       // work of the hourglass stresses
    double bulk_viscosity = 0;  // dissipated
    double damping = 0;         // dissipated by Rayleigh damping
    double far_field = 0;       // dissipated by the absorbing boundary
    double external = 0;        // done by weight, pressure, motions that are told, static
                                // water, the far field's reaction
    double contact = 0;         // done by the contact forces of the coupler
    double pair_springs = 0;    // stored in contact inside the mesh
    double pair_friction = 0;   // dissipated there by slip
    double pair_damping = 0;    // and along the normals
    double implicit = 0;         // of the inertia kappa K that implicit parts add to M
    double implicit_damping = 0;  // dissipated by the implicit parts' own damping
    double implicit_change = 0;   // came in when that inertia was set anew
    double start = 0;             // kinetic, of [[fem.initial_velocity]]
    /// What does not add up.
    double balance_error() const {
        return kinetic + internal + plastic + hourglass + bulk_viscosity + damping + far_field +
               pair_springs + pair_friction + pair_damping + implicit + implicit_damping -
               implicit_change - start - external - contact;
    }
};

struct StableStep {
    double dt = 0;        // [s] offered: cfl and viscosity included
    std::string limiter;  // "hexahedron 17 of wall"
};

/// How far from equilibrium: forces that would move free nodes and bodies now.
struct Residual {
    double node = 0;                 // [N] largest component at a node
    std::int32_t at = -1;            // that node
    double body = 0;                 // largest share of a body's weight (moments: times its reach)
    double reference = 0;            // [N] mean weight of a free node
};

class Structure {
 public:
    /// At rest in the mesh's shape. `threads` for meshes large enough to gain from them.
    Structure(Model model, int threads);

    /// Whether internal_forces() takes the forces in sections, from now on; it does at first.
    void measure_sections(bool yes) { measure_sections_ = yes; }
    bool sections_are_measured() const { return measure_sections_; }

    // One step, in this order:
    void internal_forces();  // stress, forces and contact inside the mesh in the shape x^n
    void pressure_forces(double t);
    /// [N] (n_surface_nodes, 3), less the static water; nothing when alone (empty).
    void contact_forces(std::span<const double> f);
    void kick(double dt);   // v^{n-1/2} -> v^{n+1/2}
    void drift(double dt);  // x^n -> x^{n+1}
    void advance(double dt);  // kick and drift in one pass over the nodes, the same bits
    void hold();            // instead of kick and drift: all stays at rest where it is

    /// Lets the far field go, which is held until then: what holds it now stays as a constant
    /// force, and dashpots take over. Before the first step, at rest: stresses must belong to the
    /// present shape, pressures are taken as at t = 0. A second call does nothing.
    void release_far_field();

    /// While the structure is held under still water: takes note of the contact forces of a step
    /// (dt [s]), see StaticWater. let_go(): before the first step that moves.
    void observe_still_water(double dt);
    void let_go();

    /// Gives nodes and bodies the velocities they start with: before the first step, after the
    /// equilibrium is found and the far field released. A second call does nothing.
    void launch();

    /// Prescribed motions wait, as at t = 0, until count_from_here(): while equilibrium is found.
    void rest_motions();

    /// For finding equilibrium. stop(): ends all motion at n, between internal_forces and kick;
    /// the next kick starts from rest. count_from_here(): displacements, energies and the motion
    /// and contact forces of rigid bodies count from this state.
    void stop();
    void count_from_here();
    /// After all forces of the step are in.
    Residual residual() const;

    /// Completes energies and velocities at the last n by a kick like the one before; nothing
    /// moves.
    void finish();

    /// PhysicsError that names the element or node when a value is not finite, an element inverts
    /// or (looked for now and then) folds, or a node outruns sound.
    void check_health(std::int64_t n, double t) const;
    /// dt = (2/omega) (sqrt(cfl^2 + xi^2) - xi), xi = b1 + b2^2 Ma the bulk viscosity's damping
    /// ratio at the closing Mach number Ma, plus beta omega/2 of Rayleigh damping by stiffness: stiffness and lagged viscosity together take cfl^2 of
    /// the stability limit, and leave 1 - cfl^2 of it to contact.  [Eq. 13 with c from (1-2 nu);
    /// omega from the elements' bound, tightened by the largest eigenfrequency of the whole mesh]
    const StableStep& stable_step();

    /// What stable_step() returned last.
    const StableStep& offered() const { return stable_; }
    /// All that steps change. InputError when it belongs to another mesh.
    void archive(Archive& a);

    Energies energies() const;  // complete after kick
    /// [m/s] v^n of a node, from both half steps.
    Vec3 velocity(std::int32_t node) const;
    Vec3 displacement(std::int32_t node) const;  // [m]
    /// Of node i of the coupled surface, which of a shell lies on one of its faces: [m], [m/s] at
    /// n - 1/2, and [kg] that contact meets there.
    Row surface_position(std::size_t i) const;
    Row surface_velocity(std::size_t i) const;
    double surface_mass(std::size_t i) const;
    /// [N] force the support exerts on the structure (after all forces of the step are in).
    Vec3 reaction(const Support& support) const;
    double largest_displacement() const;  // [m]

    const Model& model() const { return model_; }
    const Nodes& nodes() const { return nodes_; }
    Nodes& nodes() { return nodes_; }
    const Elements& elements() const { return elements_; }
    Elements& elements() { return elements_; }
    const ElementsReport& report() const { return report_; }
    std::int64_t yielding_elements() const { return std::int64_t(report_.yielding); }
    const std::vector<RigidBody>& bodies() const { return bodies_; }
    const std::vector<PrescribedMotion>& motions() const { return model_.motions; }
    const std::vector<ContactPair>& pairs() const { return pairs_; }
    /// None when every part is explicit.
    const ImplicitParts* implicit() const { return implicit_.get(); }
    double kinetic_energy() const { return kick_.kinetic; }  // [J] of the last kick
    double omega_bound() const;                          // [1/s] elements' bound at the start
    double omega_start() const { return omega_start_; }  // [1/s] found for the mesh at the start
    int frequency_searches() const { return frequency_searches_; }

 private:
    void check_shape(const std::string& when) const;
    void find_frequency();
    void make_pairs();
    ContactBudget budget_of(const ContactSet& set) const;
    std::vector<int> contacts_at_nodes() const;
    void pair_forces();
    Kick before_kick(double dt);
    void after_kick(const Kick& step);
    void before_drift(double dt);
    void after_drift(double dt);
    void kick_bodies(const Kick& step);
    std::vector<std::int32_t> moved_by_others() const;

    Model model_;
    Elements elements_;
    Nodes nodes_;
    NodalLoad contact_;
    ShellFaces faces_;  // of the coupled surface; empty without shells
    std::unique_ptr<ImplicitParts> implicit_;
    StiffnessDamping stiffness_damping_;
    std::vector<RigidBody> bodies_;
    std::vector<std::int32_t> moved_by_others_;  // nodes whose velocity is not the nodal kick's alone
    std::vector<ContactPair> pairs_;
    std::vector<std::uint8_t> is_rigid_;  // [n_nodes] moved by a body; empty without bodies
    int threads_;

    double t_ = 0;          // [s] of n, as pressure_forces() was told
    bool motions_rest_ = false, launched_ = false;
    double start_energy_ = 0;  // [J] of launch()
    bool measure_sections_ = true;
    double dt_ = 0;         // [s] of the last step; 0 at the start
    double kick_span_ = 0;  // [s] of the last kick
    ElementsReport report_;
    KickReport kick_;
    double strain_work_ = 0, hourglass_work_ = 0, viscous_work_ = 0;  // [J] up to n
    double plastic_work_ = 0;                                         // [J] part of strain_work_
    double damping_work_ = 0, damping_ahead_ = 0;  // [J] up to n, and of the half step after it

    double tightening_ = 1;  // largest frequency of the mesh over the elements' bound, <= 1
    double omega_start_ = 0;
    int frequency_searches_ = 0;
    StableStep stable_;
    double named_omega2_ = 0;  // bound when the limiter was last named
};

}  // namespace undertow::fem
