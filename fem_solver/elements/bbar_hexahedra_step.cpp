// The hot loops over all 8-point hexahedra. Alone in this file, so that nothing else is compiled
// with it.

#include "fem_solver/elements/batched_step.hpp"
#include "fem_solver/elements/bbar_hexahedra.hpp"

namespace undertow::fem {
namespace {

struct EightPoints {
    template <class... Arguments>
    UNDERTOW_KERNEL void operator()(std::size_t /*batch*/, Arguments&&... arguments) const {
        step_bbar(arguments...);
    }
};

}  // namespace

ElementsReport BbarHexahedra::step(Nodes& nodes, double dt, int threads) {
    return step_all(nodes, dt, threads, EightPoints{});
}

void BbarHexahedra::subtract_tangent_forces(const NodeRows& x, const NodeRows& u,
                                            NodeRows& f) const {
    subtract_tangent(x, u, f, EightPoints{});
}

}  // namespace undertow::fem
