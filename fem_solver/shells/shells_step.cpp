// The hot loops over all shells. Alone in this file, so that nothing else is compiled with it.

#include <algorithm>

#include "fem_solver/shells/shells.hpp"

namespace undertow::fem {
namespace {

/// Sums and extremes of a chunk, lane by lane.
struct LaneReport {
    Lanes strain_work = {}, hourglass_work = {}, plastic_work = {}, yielding = {};
    Lanes omega2 = {}, stiffening = {};
    Lanes relative_area = 1.0 - Lanes{};
};

UNDERTOW_KERNEL Lanes first_lanes(const Lanes& a, int n) {
    Lanes out = {};
    for (int l = 0; l < n; ++l) out[l] = a[l];
    return out;
}

UNDERTOW_KERNEL void collect(LaneReport& sum, const ShellReport<Lanes>& r,
                             const Lanes& omega2_reference, int valid) {
    if (valid == n_lanes) {
        sum.strain_work += r.strain_work;
        sum.hourglass_work += r.hourglass_work;
    } else {  // padding repeats an element: its energy counts once
        sum.strain_work += first_lanes(r.strain_work, valid);
        sum.hourglass_work += first_lanes(r.hourglass_work, valid);
    }
    sum.omega2 = larger(r.omega2, sum.omega2);
    sum.stiffening = larger(Lanes(r.omega2 / omega2_reference), sum.stiffening);
    sum.relative_area = smaller(r.relative_area, sum.relative_area);
}

}  // namespace

template <class Law>
ElementsReport Shells::step_chunk(const Chunk& chunk, Nodes& nodes, double dt,
                                  const Law& section_of_part) {
    const ShellLaw law = law_[batches_[chunk.begin].part];
    const Law section = section_of_part;  // a copy on the stack: nothing below can change it
    LaneReport sum;
    for (std::int32_t b = chunk.begin; b < chunk.end; ++b) {
        const auto& batch = batches_[b];
        Lanes x[3][4], dx[3][4], dphi[3][4], f[3][4], m[3][4];
        gather_corners(nodes.x.data(), batch.node, x);
        gather_corners(nodes.v.data(), batch.node, dx);
        gather_corners(turning_.omega.data(), corners_[b].node, dphi);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i)
#pragma GCC unroll 4
            for (int corner = 0; corner < 4; ++corner) {
                dx[i][corner] *= dt;
                dphi[i][corner] *= dt;
            }
        ShellReport<Lanes> report;
        ShellFrame<Lanes> frame;
        Resultants<Lanes> resultants;
        if constexpr (Law::plastic) {
            step_shell(x, dx, dphi, constants_[b], section, law, layers_[layers_at_[b]], state_[b],
                       resultants, f, m, report, frame);
            resultants_[b] = resultants;
            sum.plastic_work += batch.valid == n_lanes
                                    ? report.plastic_work
                                    : first_lanes(report.plastic_work, batch.valid);
            sum.yielding += batch.valid == n_lanes ? report.yielding
                                                   : first_lanes(report.yielding, batch.valid);
        } else {
            step_shell(x, dx, dphi, constants_[b], section, law, resultants_[b], state_[b],
                       resultants, f, m, report, frame);
        }
        scatter_corners(nodes.f.data(), batch.node, batch.valid, f);
        scatter_corners(turning_.moment.data(), corners_[b].node, batch.valid, m);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
            axes_[b].e1[i] = frame.e1[i];
            axes_[b].e2[i] = frame.e2[i];
        }
        omega2_[b] = report.omega2;
        collect(sum, report, constants_[b].omega2_reference, batch.valid);
    }
    ElementsReport out;
    out.strain_work = sum_lanes(sum.strain_work);
    out.hourglass_work = sum_lanes(sum.hourglass_work);
    out.plastic_work = sum_lanes(sum.plastic_work);
    out.yielding = sum_lanes(sum.yielding);
    out.omega2 = largest_lane(sum.omega2);
    out.stiffening = largest_lane(sum.stiffening);
    out.relative_volume = smallest_lane(sum.relative_area);
    return out;
}

ElementsReport Shells::step(Nodes& nodes, double dt, int threads) {
    return batches_.sweep(threads, [&](const Chunk& chunk) {
        return std::visit(
            [&](const auto& section) { return step_chunk(chunk, nodes, dt, section); },
            section_[batches_[chunk.begin].part]);
    });
}

void Shells::subtract_tangent_forces(const NodeRows& x_rows, const NodeRows& u,
                                     NodeRows& f_rows) const {
    const NodeRow* phi = u.data() + x_rows.size();  // rotations follow the displacements
    NodeRow* moments = f_rows.data() + x_rows.size();
    for (std::size_t b = 0; b < batches_.size(); ++b) {
        const auto& batch = batches_[b];
        const ShellLaw& law = law_[batch.part];
        const ElasticSection section{law.thickness, law.plane_modulus, law.poisson_ratio};
        Lanes x[3][4], dx[3][4], dphi[3][4], f[3][4], m[3][4];
        gather_corners(x_rows.data(), batch.node, x);
        gather_corners(u.data(), batch.node, dx);
        gather_corners(phi, corners_[b].node, dphi);
        ShellState<Lanes> state = {};
        Resultants<Lanes> kept = {}, resultants;
        ShellReport<Lanes> report;
        ShellFrame<Lanes> frame;
        step_shell(x, dx, dphi, constants_[b], section, law, kept, state, resultants, f, m, report,
                   frame);
        scatter_corners(f_rows.data(), batch.node, batch.valid, f);
        scatter_corners(moments, corners_[b].node, batch.valid, m);
    }
}

}  // namespace undertow::fem
