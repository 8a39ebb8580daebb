// The hot loops over all tetrahedra. Alone in this file, so that nothing else is compiled with it.

#include "fem_solver/elements/lane_report.hpp"
#include "fem_solver/elements/tetrahedra.hpp"

namespace undertow::fem {
namespace {

UNDERTOW_KERNEL void gather_step(const NodeRows& x_rows, const NodeRows& v_rows, double dt,
                                 const std::int32_t (&node)[4][n_lanes], Lanes (&x)[3][4],
                                 Lanes (&dx)[3][4]) {
    gather_corners(x_rows.data(), node, x);
    gather_corners(v_rows.data(), node, dx);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 4
        for (int corner = 0; corner < 4; ++corner) dx[i][corner] *= dt;
}

}  // namespace

void Tetrahedra::find_volumes(std::size_t b, const NodeRows& x_rows, const NodeRows& v_rows,
                              double dt, Dilatation& out) const {
    Lanes x[3][4], dx[3][4];
    gather_step(x_rows, v_rows, dt, batches_[b].node, x, dx);
    volume_and_change(x, dx, out.volume[b], out.change[b]);
}

/// Of the midpoint: change over the mean of the volumes before and after.
void Tetrahedra::average(Dilatation& out, int threads) const {
    const auto average_patch = [&](std::size_t p) {
        double volume = 0, change = 0;
        for (std::int32_t i = patch_begin_[p]; i < patch_begin_[p + 1]; ++i) {
            const std::int32_t slot = patch_slot_[i];
            volume += out.volume[slot / n_lanes][slot % n_lanes];
            change += out.change[slot / n_lanes][slot % n_lanes];
        }
        out.of_patch[p] = change / (volume - 0.5 * change);
    };
    const std::size_t n = patches();
    if (threads > 1) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (std::size_t p = 0; p < n; ++p) average_patch(p);
    } else {
        for (std::size_t p = 0; p < n; ++p) average_patch(p);
    }
}

inline Lanes Tetrahedra::dilatation(std::size_t b, const Dilatation& from) const {
    Lanes out;
    for (int l = 0; l < n_lanes; ++l) out[l] = from.of_patch[patch_of_[b][l]];
    return out;
}

template <class Law>
ElementsReport Tetrahedra::step_chunk(const Chunk& chunk, Nodes& nodes, double dt,
                                      const Law& law_of_part) {
    const ElementLaw law = law_[batches_[chunk.begin].part];
    const Law material = law_of_part;  // a copy on the stack: nothing below can change it
    LaneReport sum;
    for (std::int32_t b = chunk.begin; b < chunk.end; ++b) {
        const Batches<4>::Batch& batch = batches_[b];
        Lanes x[3][4], dx[3][4], f[3][4];
        gather_step(nodes.x, nodes.v, dt, batch.node, x, dx);
        ElementReport<Lanes> report;
        step_tetrahedron(x, dx, dilatation(b, dilatation_), dt, constants_[b], material, law,
                         state_[b], f, report);
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

ElementsReport Tetrahedra::step(Nodes& nodes, double dt, int threads) {
    batches_.sweep(threads, [&](const Chunk& chunk) {
        for (std::int32_t b = chunk.begin; b < chunk.end; ++b)
            find_volumes(b, nodes.x, nodes.v, dt, dilatation_);
        return ElementsReport{};
    });
    average(dilatation_, threads);
    return batches_.sweep(threads, [&](const Chunk& chunk) {
        return std::visit([&](const auto& law) { return step_chunk(chunk, nodes, dt, law); },
                          parts_[batches_[chunk.begin].part].material);
    });
}

void Tetrahedra::subtract_tangent_forces(const NodeRows& x_rows, const NodeRows& u,
                                         NodeRows& f_rows) const {
    Dilatation of_u = make_dilatation();
    for (std::size_t b = 0; b < batches_.size(); ++b) find_volumes(b, x_rows, u, 1, of_u);
    average(of_u, 1);
    for (std::size_t b = 0; b < batches_.size(); ++b) {
        const Batches<4>::Batch& batch = batches_[b];
        ElementLaw law = law_[batch.part];
        law.bulk_viscosity_linear = law.bulk_viscosity_quadratic = 0;
        Lanes x[3][4], dx[3][4], f[3][4];
        gather_step(x_rows, u, 1, batch.node, x, dx);
        TetrahedronState<Lanes> state = {};
        ElementReport<Lanes> report;
        step_tetrahedron(x, dx, dilatation(b, of_u), 1.0, constants_[b],
                         elastic_moduli(parts_[batch.part].material), law, state, f, report);
        scatter_corners(f_rows.data(), batch.node, batch.valid, f);
    }
}

}  // namespace undertow::fem
