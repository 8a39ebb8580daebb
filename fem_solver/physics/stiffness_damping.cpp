#include "fem_solver/physics/stiffness_damping.hpp"

#include <algorithm>

#include "fem_solver/shells/turning_nodes.hpp"

namespace undertow::fem {
namespace {

// [s] The kernels take finite displacements: v times this is far below round-off of the positions,
// so that they are exactly linear in it (physics/largest_frequency.cpp does the same).
constexpr double tiny_time = 1e-20;

}  // namespace

StiffnessDamping::StiffnessDamping(double beta, const Elements& elements, const Nodes& nodes)
    : beta_(beta) {
    if (beta == 0) return;
    const std::size_t n = nodes.size() + elements.inverse_inertia().size();
    u_.resize(n);
    f_.resize(n);
}

void StiffnessDamping::add_forces(Elements& elements, Nodes& nodes) {
    TurningNodes* turning = elements.turning_nodes();
    const std::size_t n = nodes.size();
    for (std::size_t i = 0; i < u_.size(); ++i) {
        as_row(u_[i]) = tiny_time * as_row(i < n ? nodes.v[i] : turning->omega[i - n]);
        as_row(f_[i]) = Row{};
    }
    elements.subtract_tangent_forces(nodes.x, u_, f_);
    const double scale = beta_ / tiny_time;
    for (std::size_t i = 0; i < f_.size(); ++i) {
        as_row(f_[i]) *= Row{scale, scale, scale, scale};
        as_row(i < n ? nodes.f[i] : turning->moment[i - n]) += as_row(f_[i]);
    }
}

void StiffnessDamping::do_work(const Elements& elements, const Nodes& nodes, double half_step) {
    const TurningNodes* turning = elements.turning_nodes();
    const std::size_t n = nodes.size();
    Row sum = {};
    for (std::size_t i = 0; i < f_.size(); ++i)
        sum += as_row(f_[i]) * as_row(i < n ? nodes.v[i] : turning->omega[i - n]);
    dissipated_ -= half_step * (sum[0] + sum[1] + sum[2]);
}

}  // namespace undertow::fem
