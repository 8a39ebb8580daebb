// The hot loops over all tetrahedra. Alone in this file, so that nothing else is compiled with it.

#include "fem_solver/elements/batched_step.hpp"
#include "fem_solver/elements/tetrahedra.hpp"

namespace undertow::fem {

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

/// Over the volumes, so that patch and elements do the same work: sum V p theta_patch = p_patch sum
/// V theta.
void Tetrahedra::average_mean_stress(int threads) {
    const auto average_patch = [&](std::size_t p) {
        double volume = 0, sum = 0;
        for (std::int32_t i = patch_begin_[p]; i < patch_begin_[p + 1]; ++i) {
            const std::int32_t b = patch_slot_[i] / n_lanes, l = patch_slot_[i] % n_lanes;
            const Symmetric<Lanes>& s = state_[b].stress;
            const double V = dilatation_.volume[b][l];
            volume += V;
            sum += V * ((1.0 / 3) * (s.xx[l] + s.yy[l] + s.zz[l]) - start_mean_[b][l]);
        }
        mean_stress_[p] = sum / volume;
    };
    const std::size_t n = patches();
    if (threads > 1) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (std::size_t p = 0; p < n; ++p) average_patch(p);
    } else {
        for (std::size_t p = 0; p < n; ++p) average_patch(p);
    }
}

/// Forces of the mean stress where materials dilate: the patch's, and on top what the element was given
/// at the start, so that ground at rest stays at rest. Returns the work [J] that the latter does on the
/// element's own dilatation beyond the patch's.
double Tetrahedra::press(Nodes& nodes, int threads) {
    average_mean_stress(threads);
    const ElementsReport sum = batches_.sweep(threads, [&](const Chunk& chunk) {
        ElementsReport report;
        if (!dilates(parts_[batches_[chunk.begin].part].material)) return report;
        Lanes work = {};
        for (std::int32_t b = chunk.begin; b < chunk.end; ++b) {
            const auto& batch = batches_[b];
            Lanes x[3][4], f[3][4], p;
            gather_corners(nodes.x.data(), batch.node, x);
            for (int l = 0; l < n_lanes; ++l) p[l] = mean_stress_[patch_of_[b][l]];
            press_tetrahedron(x, Lanes(p + start_mean_[b]), f);
            scatter_corners(nodes.f.data(), batch.node, batch.valid, f);
            const Lanes of_midpoint = dilatation_.volume[b] - 0.5 * dilatation_.change[b];
            const Lanes other =
                dilatation_.change[b] - of_midpoint * dilatation(b, dilatation_);  // [m3]
            work += first_lanes(start_mean_[b] * other, batch.valid);
        }
        report.strain_work = sum_lanes(work);
        return report;
    });
    return sum.strain_work;
}

/// The kernel with the dilatation of the elements' patches.
struct Tetrahedra::WithDilatation {
    const Tetrahedra& group;
    const Dilatation& from;
    template <class Nodal, class... Arguments>
    UNDERTOW_KERNEL void operator()(std::size_t b, const Nodal& x, const Nodal& dx,
                                    Arguments&&... arguments) const {
        step_tetrahedron(x, dx, group.dilatation(b, from), arguments...);
    }
};

ElementsReport Tetrahedra::step(Nodes& nodes, double dt, int threads) {
    batches_.sweep(threads, [&](const Chunk& chunk) {
        for (std::int32_t b = chunk.begin; b < chunk.end; ++b)
            find_volumes(b, nodes.x, nodes.v, dt, dilatation_);
        return ElementsReport{};
    });
    average(dilatation_, threads);
    ElementsReport report = step_all(nodes, dt, threads, WithDilatation{*this, dilatation_});
    if (!mean_stress_.empty()) report.strain_work += press(nodes, threads);
    return report;
}

void Tetrahedra::subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const {
    Dilatation of_u = make_dilatation();
    for (std::size_t b = 0; b < batches_.size(); ++b) find_volumes(b, x, u, 1, of_u);
    average(of_u, 1);
    subtract_tangent(x, u, f, WithDilatation{*this, of_u});
}

}  // namespace undertow::fem
