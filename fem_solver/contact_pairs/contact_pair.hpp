#pragma once
// Contact inside the mesh: the nodes of one facet set (soil) against another (a skirt).
//
// Per node:
//   f_n = max(0, k (g - phi) - c dphi/dt)   [N] phi the distance to the surface, g where it
//                                      touches; c a tenth of critical, no tension
//   t   = t_old - k du_t               [N] elastic stick, du_t the tangential slip of the step
//   |t| <= min(mu f_n, tau_max A)      radial return: what exceeds it slips  [Simo and Hughes 1998,
//                                      ch. 3; Coulomb with elastic stick, no creep below the limit]
// t is remembered and turns with the surface. g starts as the distance in the mesh (about
// fem.contact's gap, so that facets of a round wall do not press unevenly), plus the over-closure
// f_n/k that balances the nodal forces of the start.
//
// Stiffness: k = 10 E A/h of the element behind the node, unless the stability budget allows less
// (springs.hpp). Deformable facets give way by 1/M_i, the largest S/m of a node, S the sum of the
// weights of feet on it and one for what slides there (docs/theory_contact.md, section 3).
//
// On a rigid body the force acts at the node's own place, so that force and moment are equal and
// opposite to round-off. On deformable facets it is split by the weights of the foot: forces are
// equal and opposite, and friction leaves a moment of |t| times the gap between solids.
//
// Shells that deform have both faces, as surface and as nodes (contact_points.hpp). Their nodes turn
// and take moments, so that with a shell on either side moments balance as well. A node remembers
// the facet that it was nearest to and is kept on that side of a thin wall. Both faces of a shell
// hang on one node and share its budget; a force along the wall turns it: 1/m + (t/2 + gap)^2/J in
// the place of 1/m.
//
// A node touches one facet at a time: in a sharp concave corner of the surface only the nearer
// side.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem_solver/contact_pairs/contact_set.hpp"
#include "fem_solver/nodes.hpp"
#include "fem_solver/rigid/rigid_body.hpp"
#include "fem_solver/shells/turning_nodes.hpp"

namespace undertow::fem {

/// What the stability of a pair depends on.
struct ContactBudget {
    double dt = 0;              // [s] largest step that will be taken
    std::vector<double> share;  // of (omega dt)^2, per node of the set
    double surface_share = 0;   // the same of the surface: of its nodes, or of the rigid body
    double body_load = 0;       // [m2/kg] of all contacts on the body together: load_on_body()
};

/// Sums over a pair's nodes, of the last evaluation.
struct ContactTotals {
    double normal_force = 0;  // [N] sum of f_n
    Vec3 force{};             // [N] sum of f_n n + t, on the nodes
    Vec3 friction{};          // [N] sum of t, on the nodes
    int touching = 0;         // nodes with f_n > 0
    int slipping = 0;         // of them, at the limit of friction
};

class ContactPair {
 public:
    /// At rest where `nodes` are. InputError if no node is near the surface, or one lies inside.
    /// `turning`: the nodes of shells that deform, or none.
    ContactPair(ContactSet set, const Nodes& nodes, const ContactBudget& budget, int threads,
                const TurningNodes* turning = nullptr);
    ~ContactPair();
    ContactPair(ContactPair&&) noexcept;

    /// Over-closes each touching node so that its normal force meets the nodal forces `load` [N]
    /// (weight, stress and all) that push it into the surface; nodes pulled away carry nothing.
    void balance(const NodeRows& load);
    /// Adds the forces at n to nodes.f and to the body; dt led from n-1 to n.
    void evaluate(Nodes& nodes, std::vector<RigidBody>& bodies, double dt,
                  TurningNodes* turning = nullptr);
    /// From here on energies count from now.
    void count_from_here();

    void archive(Archive& a);
    const ContactSet& set() const;
    const ContactTotals& totals() const;
    /// [Pa] adds f_n over its area to the nodes of the set, (nodes of the mesh).
    void add_pressure(std::span<double> pressure) const;
    double elastic_energy() const;  // [J] stored in springs, against the start
    double friction_work() const;   // [J] dissipated by slip
    double damping_work() const;    // [J] dissipated along the normals
    double largest_step() const;    // [s] for which the stiffness was made
    int nodes_near() const;         // that touched in the mesh
    /// Smallest of k h/(E A) over the nodes: 10 unless the budget was tighter.
    double softest() const;
    int searches() const;

 private:
    struct State;
    std::unique_ptr<State> s_;
};

}  // namespace undertow::fem
