#include "fem_solver/shells/turning_nodes.hpp"

#include <algorithm>
#include <utility>

#include "fem_solver/node_blocks.hpp"

namespace undertow::fem {

TurningNodes make_turning_nodes(std::vector<std::int32_t> node, std::vector<double> inertia) {
    TurningNodes turning;
    const std::size_t n = node.size();
    turning.omega.resize(n);
    turning.moment.resize(n);
    turning.inverse_inertia.resize(n);
    for (std::size_t i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) turning.inverse_inertia[i].c[d] = 1 / inertia[i];
    turning.node = std::move(node);
    turning.inertia = std::move(inertia);
    return turning;
}

std::int32_t TurningNodes::index_of(std::int32_t node_of_mesh) const {
    const auto found = std::lower_bound(node.begin(), node.end(), node_of_mesh);
    return found == node.end() || *found != node_of_mesh ? -1 : std::int32_t(found - node.begin());
}

KickReport TurningNodes::kick(const Kick& step, int threads) {
    return sum_over_node_blocks<KickReport>(
        size(), threads,
        [&](std::size_t first, std::size_t last) { return kick_block(step, first, last); });
}

KickReport TurningNodes::kick_block(const Kick& step, std::size_t first, std::size_t last) {
    const double span = 0.5 * (step.dt_before + step.dt_after);
    const double keep = 1 - 0.5 * step.damping * span, divide = 1 / (1 + 0.5 * step.damping * span);
    Row kinetic = {}, before = {}, after = {};
    for (std::size_t i = first; i < last; ++i) {
        const Row w_old = as_row(omega[i]), a = as_row(moment[i]) * as_row(inverse_inertia[i]);
        const Row w_new = (w_old * keep + span * a) * divide;
        const Row w_mean = w_old + w_new, J = inertia[i] - Row{};
        as_row(omega[i]) = w_new;
        kinetic += J * (w_old * w_new);
        before += J * (w_mean * w_old);
        after += J * (w_mean * w_new);
    }
    const double quarter = 0.25 * step.damping;
    return {0.5 * (kinetic[0] + kinetic[1] + kinetic[2]),
            quarter * step.dt_before * (before[0] + before[1] + before[2]),
            quarter * step.dt_after * (after[0] + after[1] + after[2]), 0};
}

void TurningNodes::clear_moments(int threads) {
    for_node_blocks(size(), threads, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) moment[i] = NodeRow{};
    });
}

void TurningNodes::stop() {
    for (NodeRow& w : omega) w = NodeRow{};
}

void TurningNodes::hold(std::int32_t node_of_mesh, int axis) {
    const std::int32_t i = index_of(node_of_mesh);
    if (i >= 0) inverse_inertia[i].c[axis] = 0;
}

}  // namespace undertow::fem
