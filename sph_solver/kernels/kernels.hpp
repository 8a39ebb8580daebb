#pragma once
// Smoothing kernels with support R = 2h. Each knows its value W(r) [1/m^d] and the factor F(r) of its
// gradient, grad_i W_ij = -scale F(r) x_ij: in the pair loop only F is evaluated, the constant
// `scale` multiplies the finished sums.

#include <numbers>

#include "sph_solver/simd.hpp"

namespace undertow::sph {

/// W = a (1 - q/2)^4 (1 + 2q), q = r/h.  [Wendland 1995; a = 21/(16 pi h^3) in 3D, 7/(4 pi h^2) in 2D]
/// grad W = -5 a/h^2 (1 - q/2)^3 x_ij
struct WendlandC2 {
    double h;               // [m]
    double normalization;   // a [1/m^d]

    WendlandC2(double smoothing_length, int dimension)
        : h(smoothing_length),
          normalization(dimension == 3 ? 21 / (16 * std::numbers::pi * h * h * h)
                                       : 7 / (4 * std::numbers::pi * h * h)) {}

    double value(double r) const {
        const double u = positive_part(1 - r / (2 * h));
        return normalization * u * u * u * u * (1 + 2 * r / h);
    }
    double scale() const { return 5 * normalization / (h * h); }

    /// r2 [length unit^2], inverse_h [1/length unit] -> F [-]
    template <class Real, class Scalar>
    static Real gradient_factor(Real r2, Scalar inverse_h) {
        const Real u = positive_part(Scalar(1) - square_root(r2) * (Scalar(0.5) * inverse_h));
        return u * u * u;
    }
};

/// W = a (1 - 3/2 q^2 + 3/4 q^3) for q < 1, a/4 (2 - q)^3 for q < 2.
/// [Monaghan 1994; Wang 2024, Eq. 4 with q = |x_ij|/h; a = 1/(pi h^3) in 3D, 10/(7 pi h^2) in 2D]
/// grad W = -3/4 a/h^2 [(2 - q)+^2 - 4 (1 - q)+^2]/q x_ij
struct CubicSpline {
    double h;               // [m]
    double normalization;   // a [1/m^d]

    CubicSpline(double smoothing_length, int dimension)
        : h(smoothing_length),
          normalization(dimension == 3 ? 1 / (std::numbers::pi * h * h * h)
                                       : 10 / (7 * std::numbers::pi * h * h)) {}

    double value(double r) const {
        const double q = r / h, a = positive_part(2 - q), b = positive_part(1 - q);
        return normalization * (0.25 * a * a * a - b * b * b);
    }
    double scale() const { return 0.75 * normalization / (h * h); }

    template <class Real, class Scalar>
    static Real gradient_factor(Real r2, Scalar inverse_h) {
        const Real q = square_root(r2) * inverse_h;
        const Real a = positive_part(Scalar(2) - q), b = positive_part(Scalar(1) - q);
        return (a * a - Scalar(4) * (b * b)) / q;
    }
};

}  // namespace undertow::sph
