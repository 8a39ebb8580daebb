#pragma once
// Nodes that move as they are told, and the force that takes.
//
//     v^{n+1/2} = (X(t^{n+1}) - X(t^n))/dt^n        [m/s] in the directions that are told
//     R^n = m (v^{n+1/2} - v^{n-1/2})/s - F^n - W   [N]   s = (dt^{n-1} + dt^n)/2
//
// X is followed to round-off, whatever the steps. R is all that acts on the nodes from outside: it
// holds against internal forces F and weight W, and accelerates the nodes' own mass. A rigid body
// is told in the same way, by its center and its turning.

#include <array>
#include <string>
#include <vector>

#include "fem_solver/boundary/motion_law.hpp"
#include "fem_solver/nodes.hpp"
#include "fem_solver/rigid/rigid_body.hpp"

namespace undertow::fem {

class PrescribedMotion {
 public:
    /// Of nodes of the mesh (each once), or, if `body` >= 0, of that rigid body.
    PrescribedMotion(std::string name, MotionLaw law, std::array<bool, 3> directions,
                     std::vector<std::int32_t> nodes, int body);

    /// Takes the directions out of the hands of the nodal kick: their inverse mass becomes 0.
    void hold(Nodes& nodes) const;

    // One step, t [s] that of n:
    /// Ahead of the nodal kick: its velocities out of the nodes, so that the kick counts nothing.
    void before_kick(Nodes& nodes);
    /// Velocities of the step that begins, force, work, and their part of the report.
    void after_kick(Nodes& nodes, const Kick& step, double t, KickReport& report);
    /// The same of a rigid body: before its kick, and after it.
    void drive(RigidBody& body, double t, double dt);
    void read_force(const RigidBody& body, const Kick& step);
    void drift();
    void reset_work() { work_ = 0; }
    void archive(Archive& a);

    const std::string& name() const { return name_; }
    int body() const { return body_; }
    bool turns() const { return law_.turns(); }
    const MotionLaw& law() const { return law_; }
    const std::array<bool, 3>& directions() const { return directions_; }
    const std::vector<std::int32_t>& nodes() const { return node_; }
    /// At n: how far it has been moved, the force on the structure and its moment, about the center
    /// of the turning, of a rigid body about its center of mass; work [J] up to n.
    const MotionLaw::Place& place() const { return now_; }
    const Wrench& force() const { return force_; }
    double work() const { return work_; }

 private:
    Vec3 step_of(const Vec3& at) const;

    std::string name_;
    MotionLaw law_;
    std::array<bool, 3> directions_;
    std::vector<std::int32_t> node_;
    int body_;

    MotionLaw::Place now_, next_;  // at n and n + 1
    NodeRows v_before_;            // [m/s] v^{n-1/2} of the nodes
    Wrench force_;                 // at n
    double work_ = 0, ahead_ = 0;  // [J] up to n, and of the half step after it
};

}  // namespace undertow::fem
