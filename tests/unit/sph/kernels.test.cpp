#include "sph_solver/kernels/kernels.hpp"

#include <catch2/catch.hpp>

using namespace undertow::sph;

namespace {

template <class KernelLaw>
void check_kernel(int dimension) {
    const double h = 0.013;
    const KernelLaw kernel(h, dimension);
    // midpoint rule over the support; its error at 4000 points is below 1e-6
    double integral = 0;
    const int n = 4000;
    for (int k = 0; k < n; ++k) {
        const double r = (k + 0.5) * 2 * h / n;
        const double shell = dimension == 3 ? 4 * M_PI * r * r : 2 * M_PI * r;
        integral += kernel.value(r) * shell * 2 * h / n;
    }
    CHECK(integral == Approx(1).epsilon(1e-6));

    for (const double r : {0.1 * h, 0.5 * h, 0.99 * h, 1.3 * h, 1.9 * h, 2.1 * h}) {
        const double d = 1e-6 * h;
        const double slope = (kernel.value(r + d) - kernel.value(r - d)) / (2 * d);
        const double gradient = -kernel.scale() * KernelLaw::gradient_factor(r * r, 1 / h) * r;
        CHECK(gradient == Approx(slope).epsilon(1e-5).margin(1e-6 * kernel.value(0) / h));
    }
    CHECK(kernel.value(2 * h) == 0);
    CHECK(kernel.value(3 * h) == 0);
}

}  // namespace

TEST_CASE("a kernel integrates to one and its gradient factor is the slope of its value") {
    SECTION("Wendland C2 in 3D") { check_kernel<WendlandC2>(3); }
    SECTION("Wendland C2 in 2D") { check_kernel<WendlandC2>(2); }
    SECTION("Wendland C4 in 3D") { check_kernel<WendlandC4>(3); }
    SECTION("Wendland C4 in 2D") { check_kernel<WendlandC4>(2); }
    SECTION("cubic spline in 3D") { check_kernel<CubicSpline>(3); }
    SECTION("cubic spline in 2D") { check_kernel<CubicSpline>(2); }
}

TEST_CASE("eight lanes give the same gradient factor as one") {
    float8 r2;
    for (int k = 0; k < lanes; ++k) r2[k] = 0.05f + 0.6f * k;
    const float8 wendland = WendlandC2::gradient_factor(r2, 1.0f);
    const float8 c4 = WendlandC4::gradient_factor(r2, 1.0f);
    const float8 cubic = CubicSpline::gradient_factor(r2, 1.0f);
    for (int k = 0; k < lanes; ++k) {
        // one fused multiply-add more or less
        CHECK(wendland[k] == Approx(WendlandC2::gradient_factor(r2[k], 1.0f)).epsilon(1e-6));
        CHECK(c4[k] == Approx(WendlandC4::gradient_factor(r2[k], 1.0f)).epsilon(1e-6));
        CHECK(cubic[k] == Approx(CubicSpline::gradient_factor(r2[k], 1.0f)).epsilon(1e-6));
    }
}
