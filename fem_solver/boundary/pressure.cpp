#include "fem_solver/boundary/pressure.hpp"

#include <algorithm>

#include "fem_solver/boundary/facet_nodes.hpp"

namespace undertow::fem {
namespace {

Row cross(const Row& a, const Row& b) {
    const Row a_yzx = __builtin_shufflevector(a, a, 1, 2, 0, 3);
    const Row b_yzx = __builtin_shufflevector(b, b, 1, 2, 0, 3);
    const Row c = a * b_yzx - a_yzx * b;  // in the order z, x, y
    return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

}  // namespace

PressureLoad::PressureLoad(const std::vector<Quad>& facets, double value, double ramp)
    : load(nodes_of(facets)), facets_(facets), value_(value), ramp_(ramp) {
    number_within(load.node, facets_);
}

double PressureLoad::pressure(double t) const {
    if (t >= ramp_) return value_;
    const double s = t / ramp_;
    return value_ * s * s * (3 - 2 * s);  // no jump in the load or in its rate
}

void PressureLoad::evaluate(double t, const NodeRows& x) {
    const double p = pressure(t);
    std::fill(load.force.begin(), load.force.end(), NodeRow{});
    constexpr double xi[4] = {-1, 1, 1, -1}, eta[4] = {-1, -1, 1, 1};
    for (const Quad& q : facets_) {
        const Row a = as_row(x[load.node[q[0]]]), b = as_row(x[load.node[q[1]]]);
        const Row c = as_row(x[load.node[q[2]]]), d = as_row(x[load.node[q[3]]]);
        // x(xi, eta) = mean + xi e1 + eta e2 + xi eta h; f_I = -p int N_I (x,xi cross x,eta)
        const Row e1 = 0.25 * ((b - a) + (c - d)), e2 = 0.25 * ((d - a) + (c - b));
        const Row h = 0.25 * ((a - b) + (c - d));
        const Row n = cross(e1, e2), n_xi = cross(e1, h) / 3.0, n_eta = cross(h, e2) / 3.0;
        for (int k = 0; k < 4; ++k)
            as_row(load.force[q[k]]) -= p * (n + xi[k] * n_xi + eta[k] * n_eta);
    }
}

}  // namespace undertow::fem
