// The hot loops over all hexahedra. Alone in this file, so that nothing else is compiled with it.

#include <algorithm>

#include "fem_solver/elements/hexahedra.hpp"

namespace undertow::fem {
namespace {

UNDERTOW_KERNEL void gather_corners(const NodeRow* rows, const std::int32_t (&node)[8][n_lanes],
                                    Lanes (&out)[3][8]) {
#pragma GCC unroll 8
    for (int corner = 0; corner < 8; ++corner)
        gather(rows, node[corner], out[0][corner], out[1][corner], out[2][corner]);
}

/// Sums and extremes of a chunk, lane by lane.
struct LaneReport {
    Lanes strain_work = {}, hourglass_work = {}, viscous_work = {};
    Lanes omega2 = {}, stiffening = {}, compression = {};
    Lanes relative_volume = 1.0 - Lanes{};
    Lanes plastic_work = {}, yielding = {};
};

UNDERTOW_KERNEL Lanes first_lanes(const Lanes& a, int n) {
    Lanes out = {};
    for (int l = 0; l < n; ++l) out[l] = a[l];
    return out;
}

UNDERTOW_KERNEL void collect(LaneReport& sum, const HexahedronReport<Lanes>& r,
                             const Lanes& omega2_reference, int valid) {
    if (valid == n_lanes) {
        sum.strain_work += r.strain_work;
        sum.hourglass_work += r.hourglass_work;
        sum.viscous_work += r.viscous_work;
    } else {  // padding repeats an element: its energy counts once
        sum.strain_work += first_lanes(r.strain_work, valid);
        sum.hourglass_work += first_lanes(r.hourglass_work, valid);
        sum.viscous_work += first_lanes(r.viscous_work, valid);
    }
    sum.omega2 = larger(r.omega2, sum.omega2);
    sum.stiffening = larger(Lanes(r.omega2 / omega2_reference), sum.stiffening);
    sum.compression = larger(r.compression, sum.compression);
    sum.relative_volume = smaller(r.relative_volume, sum.relative_volume);
}

UNDERTOW_KERNEL void collect_flow(LaneReport& sum, const HexahedronReport<Lanes>& r, int valid) {
    sum.plastic_work += valid == n_lanes ? r.plastic_work : first_lanes(r.plastic_work, valid);
    sum.yielding += valid == n_lanes ? r.yielding : first_lanes(r.yielding, valid);
}

}  // namespace

template <class Law>
ElementsReport Hexahedra::step_chunk(const Chunk& chunk, Nodes& nodes, double dt,
                                     const Law& law_of_part) {
    const HexahedronLaw law = law_[batch_[chunk.begin].part];
    const Law material = law_of_part;  // a copy on the stack: nothing below can change it
    LaneReport sum;
    for (std::int32_t b = chunk.begin; b < chunk.end; ++b) {
        const Batch& batch = batch_[b];
        Lanes x[3][8], dx[3][8], f[3][8];
        gather_corners(nodes.x.data(), batch.node, x);
        gather_corners(nodes.v.data(), batch.node, dx);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
#pragma GCC unroll 8
            for (int corner = 0; corner < 8; ++corner) dx[i][corner] *= dt;
        HexahedronReport<Lanes> report;
        step_hexahedron(x, dx, dt, constants_[b], material, law, state_[b], f, report);
#pragma GCC unroll 8
        for (int corner = 0; corner < 8; ++corner)
            scatter_subtract(nodes.f.data(), batch.node[corner], batch.valid, f[0][corner],
                             f[1][corner], f[2][corner]);
        omega2_[b] = report.omega2;
        collect(sum, report, constants_[b].omega2_reference, batch.valid);
        if constexpr (Law::plastic) {
            collect_flow(sum, report, batch.valid);
            plastic_strain_[b] += report.plastic_strain;
        }
    }
    if (parts_[batch_[chunk.begin].part].implicit) sum.omega2 = sum.stiffening = Lanes{};
    return {sum_lanes(sum.strain_work),    sum_lanes(sum.hourglass_work),
            sum_lanes(sum.viscous_work),   largest_lane(sum.omega2),
            largest_lane(sum.stiffening),  smallest_lane(sum.relative_volume),
            largest_lane(sum.compression), sum_lanes(sum.plastic_work),
            sum_lanes(sum.yielding)};
}

ElementsReport Hexahedra::step_chunk(const Chunk& chunk, Nodes& nodes, double dt) {
    return std::visit([&](const auto& law) { return step_chunk(chunk, nodes, dt, law); },
                      parts_[batch_[chunk.begin].part].material);
}

ElementsReport Hexahedra::step(Nodes& nodes, double dt, int threads) {
    for (std::size_t color = 0; color + 1 < color_begin_.size(); ++color) {
        const std::int32_t begin = color_begin_[color], end = color_begin_[color + 1];
        if (threads > 1 && end - begin > 1) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
            for (std::int32_t c = begin; c < end; ++c)
                chunk_report_[c] = step_chunk(chunk_[c], nodes, dt);
        } else {
            for (std::int32_t c = begin; c < end; ++c)
                chunk_report_[c] = step_chunk(chunk_[c], nodes, dt);
        }
    }
    ElementsReport total;
    for (const ElementsReport& r : chunk_report_) {  // in the order of the chunks, always
        total.strain_work += r.strain_work;
        total.hourglass_work += r.hourglass_work;
        total.viscous_work += r.viscous_work;
        total.omega2 = std::max(total.omega2, r.omega2);
        total.stiffening = std::max(total.stiffening, r.stiffening);
        total.compression = std::max(total.compression, r.compression);
        total.relative_volume = std::min(total.relative_volume, r.relative_volume);
        total.plastic_work += r.plastic_work;
        total.yielding += r.yielding;
    }
    return total;
}

void Hexahedra::subtract_tangent_forces(const NodeRows& x_rows, const NodeRows& u,
                                        NodeRows& f_rows, WhichParts which) const {
    for (std::size_t b = 0; b < batch_.size(); ++b) {
        if (!is_among(b, which)) continue;
        const Batch& batch = batch_[b];
        HexahedronLaw law = law_[batch.part];
        law.bulk_viscosity_linear = law.bulk_viscosity_quadratic = 0;
        Lanes x[3][8], dx[3][8], f[3][8];
        gather_corners(x_rows.data(), batch.node, x);
        gather_corners(u.data(), batch.node, dx);
        HexahedronState<Lanes> state = {};
        HexahedronReport<Lanes> report;
        step_hexahedron(x, dx, 1.0, constants_[b], elastic_moduli(parts_[batch.part].material), law,
                        state, f, report);
        for (int corner = 0; corner < 8; ++corner)
            scatter_subtract(f_rows.data(), batch.node[corner], batch.valid, f[0][corner],
                             f[1][corner], f[2][corner]);
    }
}

}  // namespace undertow::fem
