#include "fem_solver/boundary/static_water.hpp"

#include <algorithm>
#include <cmath>

#include "fem_solver/boundary/facet_nodes.hpp"

namespace undertow::fem {

StaticWater::StaticWater(const std::vector<Quad>& facets, double weight_density, double level)
    : load(nodes_of(facets)), facets_(facets), weight_density_(weight_density), level_(level) {
    number_within(load.node, facets_);
}

void StaticWater::evaluate(const NodeRows& x) {
    std::fill(load.force.begin(), load.force.end(), NodeRow{});
    // shape function, pressure and area vector have degree 3 at most in each of xi, eta: 2 x 2
    // points are exact
    constexpr double g = 0.57735026918962576;  // 1/sqrt 3
    constexpr double xi[4] = {-g, g, g, -g}, eta[4] = {-g, -g, g, g};
    for (const Quad& q : facets_) {
        const Row a = as_row(x[load.node[q[0]]]), b = as_row(x[load.node[q[1]]]);
        const Row c = as_row(x[load.node[q[2]]]), d = as_row(x[load.node[q[3]]]);
        const Row e1 = 0.25 * ((b - a) + (c - d)), e2 = 0.25 * ((d - a) + (c - b));
        const Row h = 0.25 * ((a - b) + (c - d)), middle = 0.25 * ((a + b) + (c + d));
        for (int k = 0; k < 4; ++k) {
            const Row along_xi = e1 + eta[k] * h, along_eta = e2 + xi[k] * h;
            const double z = middle[2] + xi[k] * e1[2] + eta[k] * e2[2] + xi[k] * eta[k] * h[2];
            const double p = weight_density_ * std::max(0.0, level_ - z);
            const Row u = __builtin_shufflevector(along_xi, along_xi, 1, 2, 0, 3);
            const Row v = __builtin_shufflevector(along_eta, along_eta, 1, 2, 0, 3);
            const Row zxy = along_xi * v - u * along_eta;  // cross product in the order z, x, y
            const Row pull = p * __builtin_shufflevector(zxy, zxy, 1, 2, 0, 3);
            constexpr double corner_xi[4] = {-1, 1, 1, -1}, corner_eta[4] = {-1, -1, 1, 1};
            for (int I = 0; I < 4; ++I)
                as_row(load.force[q[I]]) +=
                    0.25 * (1 + corner_xi[I] * xi[k]) * (1 + corner_eta[I] * eta[k]) * pull;
        }
    }
    for (std::size_t i = 0; i < constant_.size(); ++i) as_row(load.force[i]) -= as_row(constant_[i]);
}

void StaticWater::observe(const NodalLoad& contact, double dt) {
    if (at_.empty()) {
        for (std::int32_t n : load.node)
            at_.push_back(std::int32_t(
                std::lower_bound(contact.node.begin(), contact.node.end(), n) -
                contact.node.begin()));
        sum_.resize(load.node.size());
    }
    for (std::size_t i = 0; i < at_.size(); ++i)
        as_row(sum_[i]) += dt * (as_row(contact.force[at_[i]]) + as_row(load.force[i]));
    observed_ += dt;
}

void StaticWater::balance(const NodeRows& inverse_mass) {
    if (observed_ == 0 || !constant_.empty()) return;
    constant_.resize(sum_.size());
    Row net{}, net_static{};
    double square = 0, square_static = 0;
    for (std::size_t i = 0; i < sum_.size(); ++i) {
        as_row(constant_[i]) = as_row(sum_[i]) * (1 / observed_);
        const double* free = inverse_mass[load.node[i]].c;
        if (free[0] + free[1] + free[2] == 0) continue;  // a rigid bed may reach beyond the water
        const Row c = as_row(constant_[i]), p = as_row(load.force[i]);
        net += c, net_static += p;
        square += c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
        square_static += p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    }
    const auto norm = [](const Row& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); };
    difference_ = {norm(net) / norm(net_static), std::sqrt(square / square_static)};
}

}  // namespace undertow::fem
