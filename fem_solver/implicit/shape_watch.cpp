#include "fem_solver/implicit/shape_watch.hpp"

#include <algorithm>
#include <cmath>

#include "fem_solver/elements/modes.hpp"

namespace undertow::fem {

ShapeWatch::ShapeWatch(const Mesh& mesh, const std::vector<std::int32_t>& elements,
                       const TurningBodies& bodies)
    : accepted_(elements.size()) {
    for (std::int32_t e : elements) {
        element_.push_back(mesh.hexahedra[e]);
        std::int32_t body = -1;
        for (std::int32_t n : element_.back()) body = std::max(body, bodies.body_of_node()[n]);
        body_.push_back(body);
    }
}

ShapeWatch::Axes ShapeWatch::axes_of(const Hexahedron& node, const NodeRows& x) {
    Axes axes;
    for (int d = 0; d < 3; ++d) {
        double a[8];
        for (int corner = 0; corner < 8; ++corner) a[corner] = x[node[corner]].c[d];
        const Modes<double> modes = to_modes(a);
        for (int k = 0; k < 3; ++k) axes[k][d] = modes.linear[k];
    }
    return axes;
}

void ShapeWatch::accept(const NodeRows& x) {
    for (std::size_t e = 0; e < element_.size(); ++e) accepted_[e] = axes_of(element_[e], x);
}

double ShapeWatch::largest_change(const NodeRows& x, const TurningBodies& bodies) const {
    double largest2 = 0;
    for (std::size_t e = 0; e < element_.size(); ++e) {
        if (body_[e] < 0) continue;  // nothing moves
        const Rotation& r = bodies.rotation(body_[e]);
        const Axes now = axes_of(element_[e], x);
        for (int k = 0; k < 3; ++k) {
            double change2 = 0, length2 = 0;
            for (int d = 0; d < 3; ++d) {
                const auto& was = accepted_[e][k];
                const double change =
                    now[k][d] - (r[3 * d] * was[0] + r[3 * d + 1] * was[1] + r[3 * d + 2] * was[2]);
                change2 += change * change;
                length2 += was[d] * was[d];
            }
            largest2 = std::max(largest2, change2 / length2);
        }
    }
    return std::sqrt(largest2);
}

}  // namespace undertow::fem
