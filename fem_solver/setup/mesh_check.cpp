#include "fem_solver/setup/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fem_solver/elements/corners.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

Vec3 edge(const Mesh& mesh, std::int32_t from, std::int32_t to) {
    const Vec3 &a = mesh.x[from], &b = mesh.x[to];
    return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}
double length(const Vec3& a) {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}
double triple(const Vec3& a, const Vec3& b, const Vec3& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

MeshQuality check_mesh(const Mesh& mesh) {
    if (mesh.hexahedra.empty())
        throw InputError("fem: the mesh " + mesh.source + " has no hexahedra.");
    MeshQuality quality;
    std::size_t bad = 0, first_bad = 0;
    double first_jacobian = 0;
    for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) {
        const Hexahedron& h = mesh.hexahedra[e];
        double shortest = std::numeric_limits<double>::infinity(), longest = 0;
        double smallest = std::numeric_limits<double>::infinity(), sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            Vec3 edges[3];
            for (int k = 0; k < 3; ++k) {
                edges[k] = edge(mesh, h[corner], h[corner_edges[corner][k]]);
                shortest = std::min(shortest, length(edges[k]));
                longest = std::max(longest, length(edges[k]));
            }
            const double jacobian = triple(edges[0], edges[1], edges[2]);
            smallest = std::min(smallest, jacobian);
            sum += jacobian;
        }
        // flatter than this a corner cannot be told from a collapsed one in float positions
        if (!(smallest > 1e-12 * longest * longest * longest)) {
            if (bad++ == 0) {
                first_bad = e;
                first_jacobian = smallest;
            }
            continue;
        }
        if (longest / shortest > quality.worst_aspect) {
            quality.worst_aspect = longest / shortest;
            quality.worst_aspect_element = e;
        }
        if (smallest / (sum / 8) < quality.worst_corner) {
            quality.worst_corner = smallest / (sum / 8);
            quality.worst_corner_element = e;
        }
    }
    if (bad > 0) {
        throw InputError("fem: " + mesh.element_name(first_bad) + " of " + mesh.source +
                         " is inverted or degenerate (smallest corner Jacobian " +
                         number_text(first_jacobian, 3) + " m3, must be > 0); " +
                         std::to_string(bad) + " of " + std::to_string(mesh.hexahedra.size()) +
                         " elements are. Mend the mesh, or turn the node order round.");
    }
    return quality;
}

}  // namespace undertow::fem
