#pragma once
// Forces on a few nodes, and the work they do.

#include <cstdint>
#include <vector>

#include "fem_solver/nodes.hpp"

namespace undertow::fem {

struct NodalLoad {
    std::vector<std::int32_t> node;  // of the mesh, each once
    NodeRows force;                  // [N] at n
    double work = 0;                 // [J] done so far, trapezoidal rule in the displacement

    explicit NodalLoad(std::vector<std::int32_t> nodes = {})
        : node(std::move(nodes)), force(node.size()) {}

    void archive(Archive& a);

    void add_to(NodeRows& f) const {
        for (std::size_t i = 0; i < node.size(); ++i) as_row(f[node[i]]) += as_row(force[i]);
    }
    /// Half of the trapezoid: `half_step` = dt/2, with the velocity before the kick for the step
    /// that ends at n and with the one after it for the step that begins there.
    void do_work(const NodeRows& v, double half_step) {
        Row sum = {};
        for (std::size_t i = 0; i < node.size(); ++i) sum += as_row(force[i]) * as_row(v[node[i]]);
        work += half_step * (sum[0] + sum[1] + sum[2]);
    }
};

}  // namespace undertow::fem
