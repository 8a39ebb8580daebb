#pragma once
// A rigid body in the leapfrog of the nodes: the forces of its nodes move it, it moves its nodes.
//
//   center    v^{n+1/2} = v^{n-1/2} + F^n/M span          c^{n+1} = c^n + dt v^{n+1/2}
//   rotation  L^{n+1/2} = L^{n-1/2} + M^n span            R^{n+1} = exp(dt w^{n+1/2}) R^n
//             I(R^{n+1/2}) w^{n+1/2} = L^{n+1/2},         R^{n+1/2} = exp(dt w^{n+1/2}/2) R^n
//
// L is the moment of momentum about the center in axes of space: without moments it stays the same
// to the last bit. The inertia tensor of the middle of the step makes the rotation reversible, so
// that the energy of a free top ripples but does not drift. Locked degrees of freedom keep their
// parts of v and L at zero: I w = L is solved among the free axes, and what holds the others takes
// up the rest. Nodes are placed by the body's frame in each step, so the shape cannot drift; their
// velocities are those of the chords from x^n to x^{n+1}, as for any other node.
//   [implicit midpoint on the rotation group; Simo and Wong 1991, IJNME 31, 19, explicit in forces]

#include <memory>

#include "fem_solver/nodes.hpp"
#include "fem_solver/rigid/rigid_set.hpp"

namespace undertow::fem {

/// Force and moment about a point.
struct Wrench {
    Vec3 force{};   // [N]
    Vec3 moment{};  // [N m]
};

class RigidBody {
 public:
    /// At rest where `nodes` are. Takes the nodes out of the hands of the nodal kick: their inverse
    /// mass becomes 0.
    RigidBody(RigidSet set, Nodes& nodes);
    ~RigidBody();
    RigidBody(RigidBody&&) noexcept;

    /// A force of contact inside the mesh [N] that acts on the body at the point x [m]. Not among
    /// the forces of the nodes.
    void add_contact(const Vec3& x, const Vec3& force);
    void clear_contact();

    /// Takes velocities out of the nodes, so that the nodal kick finds nothing to count.
    void rest_nodes(Nodes& nodes) const;
    /// Forces of the nodes, contact and weight; sets the nodes' velocities. Returns its part of the
    /// report.
    KickReport kick(Nodes& nodes, const Kick& step);
    /// Places the nodes; after the nodal drift, which moved them by dt v.
    void drift(Nodes& nodes, double dt);
    /// Motion that is told, in the directions that the set names as driven: velocity of the center
    /// [m/s] and angular velocity [rad/s] of the step that begins; before its kick.
    void drive(const Vec3& v, const Vec3& w);
    /// What drives it, found in the last kick.
    struct Driven {
        Wrench force;                              // about the center
        double power_before = 0, power_after = 0;  // [W] with the velocities before and after n
        // [J] kinetic energy of what is told: in the first step, half a kick from rest, its inertia
        // takes as much less work than force times path of the whole step
        double blow = 0;
    };
    const Driven& driven() const;
    /// Velocity of the center [m/s] and angular velocity [rad/s] to start with, where it is free and
    /// not driven; its nodes move along. Returns its kinetic energy [J].
    double launch(Nodes& nodes, const Vec3& v, const Vec3& w);
    /// Ends all motion.
    void stop(Nodes& nodes);
    /// From here on displacement, rotation, work of the weight and contact() count from now.
    void count_from_here();

    void archive(Archive& a);
    const RigidSet& set() const;
    double mass() const;                    // [kg] with what was added
    Vec3 center() const;                    // [m] of mass, now
    Vec3 center_at_start() const;           // [m] from where displacements count
    Vec3 displacement() const;              // [m] of the center
    Vec3 rotation() const;                  // [rad] rotation vector
    Vec3 velocity() const;                  // [m/s] of the center, v^{n-1/2} or v^{n+1/2}
    Vec3 angular_velocity() const;          // [rad/s]
    Vec3 moment_of_momentum() const;        // [kg m2/s] about the center
    Wrench contact() const;                 // from contact inside the mesh, about the center
    Wrench load(const Nodes& nodes) const;  // from the forces of its nodes, about the center
    double weight_work(const Vec3& gravity) const;  // [J]
    /// [N], [N m] forces and moments that would move it now, 0 in locked directions.
    Wrench unbalanced(const Nodes& nodes, const Vec3& gravity) const;
    double reach() const;  // [m] from the center to the farthest node
    /// [k/kg] largest squared frequency of the free body on springs k [N/m, or any weight] that hold
    /// the points x [m] in all three directions; of one with k = 1: 1 over the mass it meets there.
    double yield_to(const std::vector<Vec3>& x, const std::vector<double>& k) const;

 private:
    Wrench pull(const Nodes& nodes, const Vec3& gravity) const;

    struct State;
    std::unique_ptr<State> s_;
};

}  // namespace undertow::fem
