#include "fem_solver/nodes.hpp"

#include <algorithm>
#include <utility>

#include "fem_solver/node_blocks.hpp"

namespace undertow::fem {
namespace {

Row row_of(double a, double b, double c) {
    return Row{a, b, c, 0};
}

struct KickSums {
    Row kinetic = {}, before = {}, after = {}, speed2 = {};
};

inline void drift_node(Nodes& nodes, double dt, std::size_t n) {
    as_row(nodes.x[n]) += dt * as_row(nodes.v[n]);
    as_row(nodes.f[n]) = Row{};
}

/// Nodes first .. last, and their drift where `drifts`.
template <bool drifts>
void kick_run(Nodes& nodes, const Kick& step, std::size_t first, std::size_t last, KickSums& sums) {
    const double span = 0.5 * (step.dt_before + step.dt_after);
    const double keep = 1 - 0.5 * step.damping * span, divide = 1 / (1 + 0.5 * step.damping * span);
    const Row g = row_of(step.gravity[0], step.gravity[1], step.gravity[2]);
    KickSums s = sums;
    for (std::size_t n = first; n < last; ++n) {
        const Row im = as_row(nodes.inverse_mass[n]), v_old = as_row(nodes.v[n]);
        const Row weight =
            im != 0.0 ? nodes.weight_share[n] * g : Row{};  // no weight where a support carries it
        const Row a = as_row(nodes.f[n]) * im + weight;
        const Row v_new = (v_old * keep + span * a) * divide;
        const Row v_mean = v_old + v_new, m = nodes.mass[n] - Row{};
        as_row(nodes.v[n]) = v_new;
        if constexpr (drifts) drift_node(nodes, step.dt_after, n);
        s.kinetic += m * (v_old * v_new);
        s.before += m * (v_mean * v_old);
        s.after += m * (v_mean * v_new);
        const Row v2 = v_new * v_new;
        const Row sum = v2 + __builtin_shufflevector(v2, v2, 1, 2, 0, 3) +
                        __builtin_shufflevector(v2, v2, 2, 0, 1, 3);
        s.speed2 = larger(sum, s.speed2);
    }
    sums = s;
}

KickReport report_of(const KickSums& s, const Kick& step) {
    const double quarter = 0.25 * step.damping;
    return {0.5 * (s.kinetic[0] + s.kinetic[1] + s.kinetic[2]),
            quarter * step.dt_before * (s.before[0] + s.before[1] + s.before[2]),
            quarter * step.dt_after * (s.after[0] + s.after[1] + s.after[2]), s.speed2[0]};
}

KickReport kick_block(Nodes& nodes, const Kick& step, std::size_t first, std::size_t last) {
    KickSums sums;
    kick_run<false>(nodes, step, first, last, sums);
    return report_of(sums, step);
}

KickReport kick_and_drift_block(Nodes& nodes, const Kick& step,
                                std::span<const std::int32_t> later, std::size_t first,
                                std::size_t last) {
    KickSums sums;
    auto next = std::lower_bound(later.begin(), later.end(), std::int32_t(first));
    while (first < last) {
        const std::size_t stop =
            next == later.end() ? last : std::min(last, std::size_t(*next));
        kick_run<true>(nodes, step, first, stop, sums);
        first = stop;
        while (first < last && next != later.end() && std::size_t(*next) == first) {
            ++first;
            ++next;
        }
        kick_run<false>(nodes, step, stop, first, sums);
    }
    return report_of(sums, step);
}

}  // namespace

KickReport& KickReport::operator+=(const KickReport& other) {
    kinetic += other.kinetic;
    damping_before += other.damping_before;
    damping_after += other.damping_after;
    speed2 = std::max(speed2, other.speed2);
    return *this;
}

Nodes make_nodes(const Mesh& mesh, std::vector<double> mass,
                 const std::vector<double>& weight_mass) {
    const std::size_t n = mesh.x.size();
    Nodes nodes;
    nodes.x0.resize(n);
    nodes.v.resize(n);
    nodes.f.resize(n);
    nodes.inverse_mass.resize(n);
    nodes.weight_share.resize(n);
    for (std::size_t i = 0; i < n; ++i)
        nodes.weight_share[i] = mass[i] > 0 ? weight_mass[i] / mass[i] : 0;
    for (std::size_t i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) {
            nodes.x0[i].c[d] = mesh.x[i][d];
            nodes.inverse_mass[i].c[d] = mass[i] > 0 ? 1 / mass[i] : 0;
        }
    nodes.x = nodes.x0;
    nodes.mass = std::move(mass);
    return nodes;
}

KickReport kick(Nodes& nodes, const Kick& step, int threads) {
    return sum_over_node_blocks<KickReport>(
        nodes.size(), threads, [&](std::size_t first, std::size_t last) {
            return kick_block(nodes, step, first, last);
        });
}

KickReport kick_and_drift(Nodes& nodes, const Kick& step, std::span<const std::int32_t> later,
                          int threads) {
    return sum_over_node_blocks<KickReport>(
        nodes.size(), threads, [&](std::size_t first, std::size_t last) {
            return kick_and_drift_block(nodes, step, later, first, last);
        });
}

void drift(Nodes& nodes, double dt, std::span<const std::int32_t> these) {
    for (std::int32_t n : these) drift_node(nodes, dt, std::size_t(n));
}

void drift(Nodes& nodes, double dt, int threads) {
    for_node_blocks(nodes.size(), threads, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) drift_node(nodes, dt, n);
    });
}

}  // namespace undertow::fem
