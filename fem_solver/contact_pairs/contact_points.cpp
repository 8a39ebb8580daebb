#include "fem_solver/contact_pairs/contact_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace undertow::fem {
namespace {

using Vector = Eigen::Vector3d;

Vector vector(const Row& row) {
    return Vector(row[0], row[1], row[2]);
}

}  // namespace

ContactPoints::ContactPoints(std::vector<std::int32_t> node, const Nodes& nodes)
    : node_(std::move(node)), x_(3 * node_.size()), v_(3 * node_.size()) {
    follow(nodes, nullptr);
}

ContactPoints::ContactPoints(const FaceLayout& faces, const Nodes& nodes,
                             const TurningNodes& turning)
    : node_(faces.node),
      faces_(faces, turning),
      offset_(faces.offset),
      x_(3 * node_.size()),
      v_(3 * node_.size()) {
    follow(nodes, &turning);
}

void ContactPoints::follow(const Nodes& nodes, const TurningNodes* turning) {
    for (std::size_t i = 0; i < node_.size(); ++i)
        for (int d = 0; d < 3; ++d) {
            x_[3 * i + d] = nodes.x[node_[i]].c[d];
            v_[3 * i + d] = nodes.v[node_[i]].c[d];
        }
    if (faces_.empty()) return;
    faces_.follow(nodes.x);
    for (std::size_t i = 0; i < node_.size(); ++i) {
        const Row lever = faces_.lever(i), v = faces_.velocity(i, *turning);
        for (int d = 0; d < 3; ++d) {
            x_[3 * i + d] += lever[d];
            v_[3 * i + d] += v[d];
        }
    }
}

Vector ContactPoints::normal(std::size_t i) const {
    return vector(faces_.lever(i)) / std::abs(offset_[i]);
}

Vector ContactPoints::turn_rate(std::size_t i, const TurningNodes* turning) const {
    if (faces_.empty()) return Vector::Zero();
    return vector(as_row(turning->omega[faces_.row(i)]));
}

void ContactPoints::add_force(std::size_t i, const Vector& force, const Vector& arm, Nodes& nodes,
                              TurningNodes* turning) const {
    NodeRow& f = nodes.f[node_[i]];
    for (int d = 0; d < 3; ++d) f.c[d] += force[d];
    if (faces_.empty()) return;
    const Vector moment = (vector(faces_.lever(i)) + arm).cross(force);
    NodeRow& m = turning->moment[faces_.row(i)];
    for (int d = 0; d < 3; ++d) m.c[d] += moment[d];
}

double ContactPoints::yields(std::size_t i, double arm, const Nodes& nodes,
                             const TurningNodes* turning) const {
    double moves = 0, turns = 0;
    for (int d = 0; d < 3; ++d) moves = std::max(moves, nodes.inverse_mass[node_[i]].c[d]);
    if (faces_.empty()) return moves;
    for (int d = 0; d < 3; ++d)
        turns = std::max(turns, turning->inverse_inertia[faces_.row(i)].c[d]);
    const double lever = std::abs(offset_[i]) + arm;
    return moves + lever * lever * turns;
}

}  // namespace undertow::fem
