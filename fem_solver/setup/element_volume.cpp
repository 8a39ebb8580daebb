#include "fem_solver/setup/element_volume.hpp"

#include <cmath>
#include <span>

#include "fem_solver/elements/hexahedron.hpp"

namespace undertow::fem {

double element_volume(const Mesh& mesh, std::int32_t element, double thickness) {
    const std::span<const std::int32_t> corners = mesh.corners(element);
    if (mesh.shape_of(element) == ElementShape::shell) {
        double a[3], b[3], n[3];  // the diagonals span twice the area
        for (int d = 0; d < 3; ++d) {
            a[d] = mesh.x[corners[2]][d] - mesh.x[corners[0]][d];
            b[d] = mesh.x[corners[3]][d] - mesh.x[corners[1]][d];
        }
        cross(a, b, n);
        return 0.5 * thickness * std::sqrt(dot(n, n));
    }
    if (mesh.shape_of(element) == ElementShape::tetrahedron) {
        double e[3][3];
        for (int k = 0; k < 3; ++k)
            for (int d = 0; d < 3; ++d) e[k][d] = mesh.x[corners[k + 1]][d] - mesh.x[corners[0]][d];
        double c[3];
        cross(e[1], e[2], c);
        return dot(e[0], c) / 6;
    }
    double x[3][8];
    for (int corner = 0; corner < 8; ++corner)
        for (int d = 0; d < 3; ++d) x[d][corner] = mesh.x[corners[corner]][d];
    const Modes<double> modes[3] = {to_modes(x[0]), to_modes(x[1]), to_modes(x[2])};
    double C[6][3], D;
    mean_gradient(modes, C, D);
    return D / 64;
}

}  // namespace undertow::fem
