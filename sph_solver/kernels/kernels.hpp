#pragma once
// Smoothing kernels with support R = 2h. Each knows its value W(r) [1/m^d] and the factor F(r) of its
// gradient, grad_i W_ij = -scale F(r) x_ij: in the pair loop only F is evaluated, the constant
// `scale` multiplies the finished sums.

#include <numbers>

#include "case/case.hpp"
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

/// W = a (1 - q/2)^6 (1 + 3q + 35/12 q^2).  [Wendland 1995; a = 495/(256 pi h^3) in 3D, 9/(4 pi h^2)
/// in 2D]   grad W = -14/3 a/h^2 (1 - q/2)^5 (1 + 5/2 q) x_ij
struct WendlandC4 {
    double h;               // [m]
    double normalization;   // a [1/m^d]

    WendlandC4(double smoothing_length, int dimension)
        : h(smoothing_length),
          normalization(dimension == 3 ? 495 / (256 * std::numbers::pi * h * h * h)
                                       : 9 / (4 * std::numbers::pi * h * h)) {}

    double value(double r) const {
        const double q = r / h, u = positive_part(1 - 0.5 * q), u2 = u * u;
        return normalization * u2 * u2 * u2 * (1 + q * (3 + 35.0 / 12 * q));
    }
    double scale() const { return 14.0 / 3 * normalization / (h * h); }

    template <class Real, class Scalar>
    static Real gradient_factor(Real r2, Scalar inverse_h) {
        const Real half = square_root(r2) * (Scalar(0.5) * inverse_h);
        const Real u = positive_part(Scalar(1) - half), u2 = u * u;
        return u2 * u2 * u * (Scalar(1) + Scalar(5) * half);
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

/// Calls f(kernel) with the kernel that the case names.
template <class F>
decltype(auto) with_kernel(Kernel kernel, double h, int dimension, F&& f) {
    switch (kernel) {
        case Kernel::cubic_spline: return f(CubicSpline(h, dimension));
        case Kernel::wendland_c4: return f(WendlandC4(h, dimension));
        case Kernel::wendland_c2: break;
    }
    return f(WendlandC2(h, dimension));
}

}  // namespace undertow::sph
