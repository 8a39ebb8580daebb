#pragma once
// Finite rotations: vector [rad] to matrix and back.

#include <Eigen/Dense>
#include <cmath>

namespace undertow::fem {

inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
    Eigen::Matrix3d m;
    m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
    return m;
}

/// exp([theta]x) - I = s [theta]x + c [theta]x^2, s = sin a/a, c = (1 - cos a)/a^2, a = |theta|:
/// without the I, so that small rotations keep their digits.  [Rodrigues]
inline Eigen::Matrix3d rotation_less_one(const Eigen::Vector3d& theta) {
    const double a = theta.norm();
    // below this the next terms of the series, a^2/6 and a^2/12, are less than round-off
    const double s = a < 1e-8 ? 1 : std::sin(a) / a;
    const double half = 0.5 * a, c = a < 1e-8 ? 0.5 : 0.5 * std::pow(std::sin(half) / half, 2);
    const Eigen::Matrix3d m = cross_matrix(theta);
    return s * m + c * (m * m);
}

inline Eigen::Matrix3d rotation_matrix(const Eigen::Vector3d& theta) {
    return Eigen::Matrix3d::Identity() + rotation_less_one(theta);
}

inline Eigen::Quaterniond rotation_quaternion(const Eigen::Vector3d& theta) {
    const double half = 0.5 * theta.norm();
    const double s = half < 1e-8 ? 0.5 : 0.5 * std::sin(half) / half;
    return {std::cos(half), s * theta[0], s * theta[1], s * theta[2]};
}

/// The rotation vector [rad] of a unit quaternion, |theta| <= pi.
inline Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q) {
    const double sine = q.vec().norm(), sign = q.w() < 0 ? -1 : 1;
    if (sine == 0) return Eigen::Vector3d::Zero();
    return (2 * sign * std::atan2(sine, sign * q.w()) / sine) * q.vec();
}

}  // namespace undertow::fem
