#pragma once
// How stiff the springs of a contact may be, and what a rigid body lends to them.
//
// A spring k_i between a node u_i and a point U_i of the surface, with a damper 2 zeta k_i/omega,
// stays within the share of both if
//
//     k_i <= omega^2 / (1/m_i + 1/M_i),   omega dt = sqrt(4 zeta^2 + share) - 2 zeta
//
// for then k (u - U)^2 <= omega^2 (m u^2 + M_i U^2) by Cauchy and Schwarz: beta + 2 eta = share at
// node and surface alike. 1/M_i is S/m of deformable facets (docs/theory_contact.md, 3). Points of
// a rigid body move with its six degrees of freedom q, U_i = G_i q, and the masses it lends must
// not be more than itself:
//
//     sum_i M_i G_i^T G_i <= M        [6 x 6, M of mass and inertia]
//
// A single contact gets M_1 = 1/(1/M + |r x e|^2/I), the effective mass at its point; several share
// it by their areas, M_i = A_i/L with L = the largest eigenvalue of sum A_i G_i^T G_i against M.
// Nodes come and go and slide along the body, so L is bounded for any of them at once: by the
// surface covered everywhere with nodes, and by all nodes at the point that turns the easiest.

#include <vector>

#include "fem_solver/contact_pairs/contact_set.hpp"
#include "fem_solver/nodes.hpp"
#include "fem_solver/rigid/rigid_body.hpp"

namespace undertow::fem {

// Share of critical damping along the normal: enough to quiet the flutter of a sliding elastic body
// and the chatter of its nodes; friction has none, so nothing creeps.
inline constexpr double contact_damping_ratio = 0.1;

// Springs of contact over those of the element behind, k h/(E A): the spring yields a tenth of it.
inline constexpr double contact_stiffness_factor = 10;

struct ContactSpring {
    double k = 0;        // [N/m]
    double damping = 0;  // [N s/m] along the normal
};

/// `yields` [1/kg] is 1/m_i + 1/M_i, `share` of the budget beta + 2 eta, both per node of the set.
std::vector<ContactSpring> make_contact_springs(const ContactSet& set,
                                                const std::vector<double>& yields,
                                                const std::vector<double>& share, double dt);

/// [m2/kg] L of the contact `set` on its body, of the shape at the start; 0 of a body that is held.
double load_on_body(const ContactSet& set, const Nodes& nodes, const RigidBody& body);

}  // namespace undertow::fem
