// The hot loops over all 8-point hexahedra. Alone in this file, so that nothing else is compiled
// with it.

#include "fem_solver/elements/bbar_hexahedra.hpp"
#include "fem_solver/elements/lane_report.hpp"

namespace undertow::fem {

template <class Law>
ElementsReport BbarHexahedra::step_chunk(const Chunk& chunk, Nodes& nodes, double dt,
                                         const Law& law_of_part) {
    const ElementLaw law = law_[batches_[chunk.begin].part];
    const Law material = law_of_part;  // a copy on the stack: nothing below can change it
    LaneReport sum;
    for (std::int32_t b = chunk.begin; b < chunk.end; ++b) {
        const Batches<8>::Batch& batch = batches_[b];
        Lanes x[3][8], dx[3][8], f[3][8];
        gather_corners(nodes.x.data(), batch.node, x);
        gather_corners(nodes.v.data(), batch.node, dx);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
#pragma GCC unroll 8
            for (int corner = 0; corner < 8; ++corner) dx[i][corner] *= dt;
        ElementReport<Lanes> report;
        step_bbar(x, dx, dt, constants_[b], material, law, state_[b], f, report);
        scatter_corners(nodes.f.data(), batch.node, batch.valid, f);
        omega2_[b] = report.omega2;
        collect(sum, report, constants_[b].omega2_reference, batch.valid);
        if constexpr (Law::plastic) {
            collect_flow(sum, report, batch.valid);
            plastic_strain_[b] += report.plastic_strain;
        }
    }
    return reduce(sum);
}

ElementsReport BbarHexahedra::step(Nodes& nodes, double dt, int threads) {
    return batches_.sweep(threads, [&](const Chunk& chunk) {
        return std::visit([&](const auto& law) { return step_chunk(chunk, nodes, dt, law); },
                          parts_[batches_[chunk.begin].part].material);
    });
}

void BbarHexahedra::subtract_tangent_forces(const NodeRows& x_rows, const NodeRows& u,
                                            NodeRows& f_rows) const {
    for (std::size_t b = 0; b < batches_.size(); ++b) {
        const Batches<8>::Batch& batch = batches_[b];
        ElementLaw law = law_[batch.part];
        law.bulk_viscosity_linear = law.bulk_viscosity_quadratic = 0;
        Lanes x[3][8], dx[3][8], f[3][8];
        gather_corners(x_rows.data(), batch.node, x);
        gather_corners(u.data(), batch.node, dx);
        BbarState<Lanes> state = {};
        ElementReport<Lanes> report;
        step_bbar(x, dx, 1.0, constants_[b], elastic_moduli(parts_[batch.part].material), law,
                  state, f, report);
        scatter_corners(f_rows.data(), batch.node, batch.valid, f);
    }
}

}  // namespace undertow::fem
