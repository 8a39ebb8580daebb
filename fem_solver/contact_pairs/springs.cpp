#include "fem_solver/contact_pairs/springs.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

/// The surface of a body as points that carry its area.
struct Skin {
    std::vector<Vec3> x;        // [m] corners of all facets
    std::vector<double> share;  // [m2] a quarter of the facet at each corner
    double area = 0;            // [m2]
    double rim = 0;             // [m] length of edges with a facet on one side only
    double extent = 0;          // [m] diagonal of the box around it
};

Skin skin_of(const std::vector<Quad>& facets, const Nodes& nodes) {
    const auto at = [&](std::int32_t n) { return Vector(Vector::Map(nodes.x[n].c)); };
    Skin skin;
    std::map<std::pair<std::int32_t, std::int32_t>, int> facets_at;
    Vector low = at(facets.front()[0]), high = low;
    for (const Quad& q : facets) {
        const double area = 0.5 * (at(q[2]) - at(q[0])).cross(at(q[3]) - at(q[1])).norm();
        skin.area += area;
        for (int k = 0; k < 4; ++k) {
            const Vector x = at(q[k]);
            low = low.cwiseMin(x);
            high = high.cwiseMax(x);
            skin.x.push_back({x[0], x[1], x[2]});
            skin.share.push_back(0.25 * area);
            ++facets_at[std::minmax(q[k], q[(k + 1) % 4])];
        }
    }
    for (const auto& [edge, count] : facets_at)
        if (count == 1) skin.rim += (at(edge.first) - at(edge.second)).norm();
    skin.extent = (high - low).norm();
    return skin;
}

}  // namespace

std::vector<ContactSpring> make_contact_springs(const ContactSet& set,
                                                const std::vector<double>& yields,
                                                const std::vector<double>& share, double dt) {
    constexpr double zeta = contact_damping_ratio;
    std::vector<ContactSpring> spring(yields.size());
    for (std::size_t i = 0; i < spring.size(); ++i) {
        const double omega = (std::sqrt(4 * zeta * zeta + share[i]) - 2 * zeta) / dt;
        double k = contact_stiffness_factor * set.stiffness[i];
        if (yields[i] > 0) k = std::min(k, omega * omega / yields[i]);
        spring[i] = {k, 2 * zeta * k / omega};
    }
    return spring;
}

double load_on_body(const ContactSet& set, const Nodes& nodes, const RigidBody& body) {
    const Skin skin = skin_of(set.surface, nodes);
    double easiest = 0;  // [1/kg] at any point of the surface
    for (const Vec3& x : skin.x) easiest = std::max(easiest, body.yield_to({x}, {1.0}));
    const double all = std::accumulate(set.area.begin(), set.area.end(), 0.0);
    const double largest = *std::max_element(set.area.begin(), set.area.end());
    // Nodes stand for a cell of size h each, of which half may hang over the rim.
    const double h = std::sqrt(largest);
    const double covered = std::max(skin.area + 0.5 * h * skin.rim, h * skin.extent) + h * h;
    const double everywhere =
        std::max(covered / skin.area * body.yield_to(skin.x, skin.share), largest * easiest);
    return std::min(everywhere, all * easiest);
}

}  // namespace undertow::fem
