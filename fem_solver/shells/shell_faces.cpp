#include "fem_solver/shells/shell_faces.hpp"

#include <cmath>

namespace undertow::fem {
namespace {

Row cross(const Row& a, const Row& b) {
    const Row a_yzx = __builtin_shufflevector(a, a, 1, 2, 0, 3);
    const Row b_yzx = __builtin_shufflevector(b, b, 1, 2, 0, 3);
    const Row c = a * b_yzx - a_yzx * b;  // in the order z, x, y
    return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

}  // namespace

ShellFaces::ShellFaces(const FaceLayout& faces, const TurningNodes& turning)
    : offset_(faces.offset), node_(faces.node), twin_(faces.twin) {
    for (std::size_t i = 0; i < node_.size(); ++i)
        turning_.push_back(offset_[i] == 0 ? -1 : turning.index_of(node_[i]));
    for (const Quad& q : faces.quad)
        if (offset_[q[0]] > 0) quad_.push_back(q);
    normal_.resize(node_.size());
}

void ShellFaces::follow(const NodeRows& x) {
    for (NodeRow& n : normal_) n = NodeRow{};
    for (const Quad& q : quad_) {
        const Row diagonal = as_row(x[node_[q[2]]]) - as_row(x[node_[q[0]]]);
        const Row other = as_row(x[node_[q[3]]]) - as_row(x[node_[q[1]]]);
        const Row area = cross(diagonal, other);
        for (std::int32_t i : q) as_row(normal_[i]) += area;
    }
    for (std::size_t i = 0; i < node_.size(); ++i) {
        if (offset_[i] <= 0) continue;
        const Row n = as_row(normal_[i]);
        const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        as_row(normal_[i]) = n / (length > 0 ? length : 1);
    }
    for (std::size_t i = 0; i < node_.size(); ++i)
        if (offset_[i] < 0) normal_[i] = normal_[twin_[i]];
}

Row ShellFaces::velocity(std::size_t i, const TurningNodes& turning) const {
    return turning_[i] < 0 ? Row{} : cross(as_row(turning.omega[turning_[i]]), lever(i));
}

double ShellFaces::mass(std::size_t i, double node_mass, const TurningNodes& turning) const {
    if (turning_[i] < 0) return node_mass;
    const double inertia = turning.inertia[turning_[i]];
    return 0.5 / (1 / node_mass + offset_[i] * offset_[i] / inertia);
}

void ShellFaces::add_moments(const NodeRows& force, TurningNodes& turning) const {
    for (std::size_t i = 0; i < node_.size(); ++i)
        if (turning_[i] >= 0)
            as_row(turning.moment[turning_[i]]) += cross(lever(i), as_row(force[i]));
}

double ShellFaces::power(const NodeRows& force, const TurningNodes& turning) const {
    double sum = 0;
    for (std::size_t i = 0; i < node_.size(); ++i) {
        if (turning_[i] < 0) continue;
        const Row m = cross(lever(i), as_row(force[i])), w = as_row(turning.omega[turning_[i]]);
        sum += m[0] * w[0] + m[1] * w[1] + m[2] * w[2];
    }
    return sum;
}

}  // namespace undertow::fem
