#pragma once
// The loops over all elements of a group, once for all kinds. For the *_step.cpp alone: each
// compiles them for its kernel, and nothing else is compiled with it.

#include "fem_solver/elements/batched_group.hpp"
#include "fem_solver/elements/fetch_ahead.hpp"
#include "fem_solver/elements/lane_report.hpp"

namespace undertow::fem {

/// A kernel, and whether memory is asked for what batches ahead need: two loops, so that small meshes
/// run the code, rounded as it is, that they would run without.
template <class Kernel, bool ahead>
struct StepKernel {
    static constexpr bool fetches_ahead = ahead;
    const Kernel& kernel;
    template <class... Arguments>
    UNDERTOW_KERNEL void operator()(Arguments&&... arguments) const {
        kernel(arguments...);
    }
};

/// Positions and displacements of the step, dx = dt v, of a batch's corners.
template <int n_corners>
UNDERTOW_KERNEL void gather_step(const NodeRows& x_rows, const NodeRows& v_rows, double dt,
                                 const std::int32_t (&node)[n_corners][n_lanes],
                                 Lanes (&x)[3][n_corners], Lanes (&dx)[3][n_corners]) {
    gather_corners(x_rows.data(), node, x);
    gather_corners(v_rows.data(), node, dx);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
#pragma GCC unroll 8
        for (int corner = 0; corner < n_corners; ++corner) dx[i][corner] *= dt;
}

/// The same, with requests for records ahead between the gathers.
template <int n_corners, class... Records>
UNDERTOW_KERNEL void gather_step(const NodeRows& x_rows, const NodeRows& v_rows, double dt,
                                 const std::int32_t (&node)[n_corners][n_lanes],
                                 Lanes (&x)[3][n_corners], Lanes (&dx)[3][n_corners],
                                 const RecordsAhead<Records...>& ahead) {
#pragma GCC unroll 8
    for (int corner = 0; corner < n_corners; ++corner) {
        gather(x_rows.data(), node[corner], x[0][corner], x[1][corner], x[2][corner]);
        ahead.ask(2 * corner, 2 * n_corners);
        gather(v_rows.data(), node[corner], dx[0][corner], dx[1][corner], dx[2][corner]);
        ahead.ask(2 * corner + 1, 2 * n_corners);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) dx[i][corner] *= dt;
    }
}

template <int n_corners, class Constants, class State>
template <class Kernel, class Law>
ElementsReport BatchedGroup<n_corners, Constants, State>::step_chunk(const Chunk& chunk,
                                                                     Nodes& nodes, double dt,
                                                                     const Law& law_of_part,
                                                                     const Kernel& kernel) {
    const ElementLaw law = law_[batches_[chunk.begin].part];
    const Law material = law_of_part;  // a copy on the stack: nothing below can change it
    LaneReport sum;
    for (std::int32_t b = chunk.begin; b < chunk.end; ++b) {
        const auto& batch = batches_[b];
        Lanes x[3][n_corners], dx[3][n_corners], f[3][n_corners];
        if constexpr (Kernel::fetches_ahead) {
            ask_for_nodes(batches_, std::size_t(b), nodes);
            const RecordsAhead ahead(std::size_t(b), batches_.batches(), constants_, state_,
                                     omega2_);
            gather_step(nodes.x, nodes.v, dt, batch.node, x, dx, ahead);
        } else {
            gather_step(nodes.x, nodes.v, dt, batch.node, x, dx);
        }
        ElementReport<Lanes> report;
        Lanes* plastic_strain = nullptr;
        if constexpr (Law::plastic) plastic_strain = &plastic_strain_[b * strain_points_];
        if constexpr (depends_on_depth<Law>)
            kernel(b, x, dx, dt, constants_[b], LocalLaw{material, local(b)},
                   local_element_law(law, local(b)), state_[b], plastic_strain, f, report);
        else
            kernel(b, x, dx, dt, constants_[b], material, law, state_[b], plastic_strain, f, report);
        scatter_corners(nodes.f.data(), batch.node, batch.valid, f);
        omega2_[b] = report.omega2;
        collect(sum, report, constants_[b].omega2_reference, batch.valid);
        if constexpr (Law::plastic) collect_flow(sum, report, batch.valid);
    }
    return reduce(sum);
}

/// kernel(b, x, dx, dt, constants, material, law, state, plastic_strain, f, report) does one step of batch b.
template <int n_corners, class Constants, class State>
template <class Kernel>
ElementsReport BatchedGroup<n_corners, Constants, State>::step_all(Nodes& nodes, double dt,
                                                                   int threads,
                                                                   const Kernel& kernel) {
    const auto sweep = [&](const auto& with) {
        return batches_.sweep(threads, [&](const Chunk& chunk) {
            return std::visit(
                [&](const auto& law) { return step_chunk(chunk, nodes, dt, law, with); },
                parts_[batches_[chunk.begin].part].material);
        });
    };
    if constexpr (worth_fetching)
        if (batches_.fetches_ahead()) return sweep(StepKernel<Kernel, true>{kernel});
    return sweep(StepKernel<Kernel, false>{kernel});
}

template <int n_corners, class Constants, class State>
template <class Kernel>
void BatchedGroup<n_corners, Constants, State>::subtract_tangent(const NodeRows& x_rows,
                                                                 const NodeRows& u,
                                                                 NodeRows& f_rows,
                                                                 const Kernel& kernel) const {
    for (std::size_t b = 0; b < batches_.size(); ++b) {
        const auto& batch = batches_[b];
        ElementLaw law = law_[batch.part];
        law.bulk_viscosity_linear = law.bulk_viscosity_quadratic = 0;
        Lanes x[3][n_corners], dx[3][n_corners], f[3][n_corners];
        gather_step(x_rows, u, 1, batch.node, x, dx);
        State state = {};
        ElementReport<Lanes> report;
        const auto step = [&](const auto& moduli, const auto& element_law) {
            kernel(b, x, dx, 1.0, constants_[b], moduli, element_law, state,
                   static_cast<Lanes*>(nullptr), f, report);
        };
        if (is_local(b))
            step(LinearElasticOf<Lanes>{local(b)[packed::lambda], local(b)[packed::mu]},
                 local_element_law(law, local(b)));
        else
            step(form_moduli(parts_[batch.part].material), law);
        scatter_corners(f_rows.data(), batch.node, batch.valid, f);
    }
}

}  // namespace undertow::fem
