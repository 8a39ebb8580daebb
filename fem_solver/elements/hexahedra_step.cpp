// The hot loops over all hexahedra. Alone in this file, so that nothing else is compiled with it.

#include "fem_solver/elements/batched_step.hpp"
#include "fem_solver/elements/hexahedra.hpp"

namespace undertow::fem {
namespace {

struct OnePoint {
    template <class... Arguments>
    UNDERTOW_KERNEL void operator()(std::size_t /*batch*/, Arguments&&... arguments) const {
        step_hexahedron(arguments...);
    }
};

}  // namespace

ElementsReport Hexahedra::step(Nodes& nodes, double dt, int threads) {
    return step_all(nodes, dt, threads, OnePoint{});
}

void Hexahedra::subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const {
    subtract_tangent(x, u, f, OnePoint{});
}

}  // namespace undertow::fem
