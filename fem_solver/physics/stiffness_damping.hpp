#pragma once
// Rayleigh damping by stiffness: f = -beta K v^{n-1/2}, K that of the unstressed material in the
// present shape, hourglass and shells' rotations included. A mode omega decays at beta omega^2/2
// (damping ratio beta omega/2); the lag costs the stable step what docs/theory_fem.md, 6, says.

#include "fem_solver/elements/element_groups.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

class StiffnessDamping {
 public:
    StiffnessDamping() = default;  // none
    /// beta [s]
    StiffnessDamping(double beta, const Elements& elements, const Nodes& nodes);

    bool empty() const { return beta_ == 0; }
    double beta() const { return beta_; }
    /// After the elements' forces of the step; implicit parts have a damping of their own.
    void add_forces(Elements& elements, Nodes& nodes);
    /// Half of the trapezoid, as NodalLoad has it.
    void do_work(const Elements& elements, const Nodes& nodes, double half_step);
    double dissipated() const { return dissipated_; }  // [J]
    void reset_work() { dissipated_ = 0; }
    void archive(Archive& a);

 private:
    double beta_ = 0;        // [s]
    double dissipated_ = 0;  // [J]
    NodeRows u_, f_;         // of nodes and, after them, of nodes that turn: [m], [N]; [rad], [N m]
};

}  // namespace undertow::fem
