#include "fem_solver/boundary/traction.hpp"

#include <cmath>

#include "fem_solver/boundary/facet_nodes.hpp"

namespace undertow::fem {

TractionLoad::TractionLoad(const std::vector<Quad>& facets, const std::vector<Vec3>& x,
                           const Vec3& value, double ramp)
    : load(nodes_of(facets)), full_(load.node.size()), ramp_(ramp) {
    // int N_I dA by 2 x 2 points: exact for flat facets, and for triangles, which repeat a node
    constexpr double g = 0.57735026918962576;  // 1/sqrt 3
    constexpr double xi[4] = {-1, 1, 1, -1}, eta[4] = {-1, -1, 1, 1};
    std::vector<Quad> within = facets;
    number_within(load.node, within);
    for (std::size_t q = 0; q < facets.size(); ++q)
        for (int k = 0; k < 4; ++k) {
            double along_xi[3] = {}, along_eta[3] = {}, weight[4];
            for (int I = 0; I < 4; ++I) {
                const double a = 1 + g * xi[I] * xi[k], b = 1 + g * eta[I] * eta[k];
                weight[I] = 0.25 * a * b;
                for (int d = 0; d < 3; ++d) {
                    along_xi[d] += 0.25 * xi[I] * b * x[facets[q][I]][d];
                    along_eta[d] += 0.25 * eta[I] * a * x[facets[q][I]][d];
                }
            }
            double normal[3], squared = 0;
            for (int d = 0; d < 3; ++d) {
                const int e = (d + 1) % 3, f = (d + 2) % 3;
                normal[d] = along_xi[e] * along_eta[f] - along_xi[f] * along_eta[e];
                squared += normal[d] * normal[d];
            }
            const double area = std::sqrt(squared);
            for (int I = 0; I < 4; ++I)
                for (int d = 0; d < 3; ++d) full_[within[q][I]].c[d] += weight[I] * area * value[d];
        }
}

void TractionLoad::evaluate(double t) {
    const double s = t < ramp_ ? t / ramp_ : 1;
    const double share = s * s * (3 - 2 * s);  // no jump in the load or in its rate
    for (std::size_t i = 0; i < full_.size(); ++i) as_row(load.force[i]) = share * as_row(full_[i]);
}

}  // namespace undertow::fem
