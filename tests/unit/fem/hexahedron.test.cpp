// One element: the kernel against independent formulas, and scalar against vector.

#include "fem_solver/elements/hexahedron.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support.hpp"

namespace undertow::fem {
namespace {

constexpr double corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                 {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

/// Volume of the trilinear hexahedron by 3 x 3 x 3 Gauss points (its Jacobian is quadratic).
double gauss_volume(const double (&x)[3][8]) {
    const double point[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)},
                 weight[3] = {5. / 9, 8. / 9, 5. / 9};
    double volume = 0;
    for (int a = 0; a < 27; ++a) {
        const int q[3] = {a % 3, a / 3 % 3, a / 9};
        double J[3][3] = {};
        for (int n = 0; n < 8; ++n)
            for (int k = 0; k < 3; ++k) {
                double dN = 0.125 * corner[n][k];
                for (int m = 0; m < 3; ++m)
                    if (m != k) dN *= 1 + corner[n][m] * point[q[m]];
                for (int d = 0; d < 3; ++d) J[d][k] += x[d][n] * dN;
            }
        volume += weight[q[0]] * weight[q[1]] * weight[q[2]] *
                  (J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) -
                   J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
                   J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]));
    }
    return volume;
}

struct OneElement {
    double x[3][8], dx[3][8] = {}, f[3][8] = {};
    HexahedronState<double> state{};
    HexahedronConstants<double> constants{};
    ElementReport<double> report{};
    LinearElastic material;
    ElementLaw law;

    OneElement(const Vec3& size, double distortion, double E = 2e9, double nu = 0.3) {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> shift(-distortion, distortion);
        for (int n = 0; n < 8; ++n)
            for (int d = 0; d < 3; ++d) x[d][n] = size[d] * (0.5 * corner[n][d] + shift(random));
        material = LinearElastic::from_young(E, nu);
        law = {.inverse_density = 1e-3,
               .lambda = material.lambda,
               .mu = material.mu,
               .sound_speed = std::sqrt((material.lambda + 2 * material.mu) * 1e-3),
               .bending_modulus = E / (1 - nu * nu),
               .poisson_ratio = nu,
               .young_modulus = E,
               .bulk_viscosity_linear = 0.06,
               .bulk_viscosity_quadratic = 1.2};
        const Modes<double> modes[3] = {to_modes(x[0]), to_modes(x[1]), to_modes(x[2])};
        double C[6][3], D;
        mean_gradient(modes, C, D);
        constants.mass = 1000 * D / 64;
        constants.length = 0.3 * size[0];
        constants.omega2_reference = 1;
        for (int k = 0; k < 3; ++k) {
            double squared = 0;
            for (int d = 0; d < 3; ++d) squared += modes[d].linear[k] * modes[d].linear[k];
            constants.axis_weight[k] = 1 / squared;
        }
    }
    void step(double dt) {
        double* none = nullptr;  // elastic: no plastic strain
        step_hexahedron(x, dx, dt, constants, material, law, state, none, f, report);
    }
};

TEST_CASE("volume and mean gradient are exact for a twisted hexahedron") {
    const OneElement e({1.0, 0.7, 1.3}, 0.15);
    const Modes<double> modes[3] = {to_modes(e.x[0]), to_modes(e.x[1]), to_modes(e.x[2])};
    double C[6][3], D;
    mean_gradient(modes, C, D);
    CHECK(D / 64 == Approx(gauss_volume(e.x)).epsilon(1e-14));
    // b_iI = dV/dx_iI against central differences; V is linear in each coordinate, so these are
    // exact to round-off
    for (int i = 0; i < 3; ++i) {
        const Modes<double> modal = {{C[0][i], C[1][i], C[2][i]}, {C[3][i], C[4][i], C[5][i], 0}};
        double b[8];
        from_modes(modal, b);
        for (int n = 0; n < 8; ++n) {
            double x[3][8];
            std::copy(&e.x[0][0], &e.x[0][0] + 24, &x[0][0]);
            x[i][n] += 0.1;
            const double up = gauss_volume(x);
            x[i][n] -= 0.2;
            CHECK(b[n] / 64 == Approx((up - gauss_volume(x)) / 0.2).margin(1e-14));
        }
    }
}

TEST_CASE("the vector kernel repeats the scalar reference") {
    constexpr double dt = 1e-5;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> shift(-1, 1);
    Lanes x[3][8], dx[3][8], f[3][8];
    HexahedronState<Lanes> state = {};
    HexahedronConstants<Lanes> constants = {};
    ElementReport<Lanes> report;
    std::vector<OneElement> reference;
    for (int l = 0; l < n_lanes; ++l) {
        OneElement e({1.0, 0.5 + 0.1 * l, 2.0}, 0.02 * l);
        for (int d = 0; d < 3; ++d)
            for (int n = 0; n < 8; ++n) {
                e.dx[d][n] = 1e-3 * shift(random);
                x[d][n][l] = e.x[d][n];
                dx[d][n][l] = e.dx[d][n];
            }
        constants.mass[l] = e.constants.mass;
        constants.length[l] = e.constants.length;
        for (int k = 0; k < 3; ++k) constants.axis_weight[k][l] = e.constants.axis_weight[k];
        reference.push_back(e);
    }
    for (int repeat = 0; repeat < 2; ++repeat)
        step_hexahedron(x, dx, dt, constants, reference[0].material, reference[0].law, state,
                        static_cast<Lanes*>(nullptr), f, report);
    for (int l = 0; l < n_lanes; ++l) {
        OneElement& e = reference[l];
        e.step(dt);
        e.step(dt);
        // the compiler may contract a*b+c differently in the two: a few ulp of the largest term
        const double scale = 1e6;
        CHECK(state.stress.xx[l] == Approx(e.state.stress.xx).margin(1e-13 * scale));
        CHECK(state.stress.zx[l] == Approx(e.state.stress.zx).margin(1e-13 * scale));
        CHECK(report.strain_work[l] == Approx(e.report.strain_work).epsilon(1e-12));
        CHECK(report.hourglass_work[l] == Approx(e.report.hourglass_work).epsilon(1e-12));
        CHECK(report.viscous_work[l] == Approx(e.report.viscous_work).epsilon(1e-12));
        CHECK(report.omega2[l] == Approx(e.report.omega2).epsilon(1e-13));
        for (int d = 0; d < 3; ++d)
            for (int n = 0; n < 8; ++n)
                CHECK(f[d][n][l] == Approx(e.f[d][n]).margin(1e-12 * scale));
    }
}

TEST_CASE("hourglass displacements meet the stiffness of beam theory at any aspect ratio") {
    // u_x = q xi zeta is pure bending about y: energy 1/2 E' kappa^2 I a with plane stress across,
    // E' = E/(1 - nu^2) while the anticlastic mode is held, so f_I = (4/3) E' b c/a q / 8
    const double E = 2e9, nu = 0.49, q = 1e-9;
    const Vec3 size = GENERATE(Vec3{1, 1, 1}, Vec3{0.02, 0.01875, 0.02}, Vec3{3, 1, 0.2});
    OneElement e(size, 0, E, nu);
    for (int n = 0; n < 8; ++n) e.dx[0][n] = q * corner[n][0] * corner[n][2];
    e.step(1);
    const double expected = 4.0 / 3 * E / (1 - nu * nu) * size[1] * size[2] / size[0] * q / 8;
    for (int n = 0; n < 8; ++n)
        CHECK(e.f[0][n] == Approx(expected * corner[n][0] * corner[n][2]).epsilon(1e-9));
}

TEST_CASE("torsion and warping displacements meet the stiffness of their strain energy") {
    // u_x = q eta zeta: shears u_x,y and u_x,z, energy 1/2 mu V/3 (4 q^2/b^2 + 4 q^2/c^2);
    // u_x = q xi eta zeta: 1/2 E V/9 4 q^2/a^2. A nodal force is an eighth of the derivative by q.
    const double E = 2e9, nu = 0.3, mu = E / (2 * (1 + nu)), q = 1e-9;
    const Vec3 size{3, 1, 0.2};
    const double volume = size[0] * size[1] * size[2];
    OneElement twisted(size, 0, E, nu), warped(size, 0, E, nu);
    for (int n = 0; n < 8; ++n) {
        twisted.dx[0][n] = q * corner[n][1] * corner[n][2];
        warped.dx[0][n] = q * corner[n][0] * corner[n][1] * corner[n][2];
    }
    twisted.step(1);
    warped.step(1);
    const double torsion =
        4.0 / 3 * mu * volume * (1 / (size[1] * size[1]) + 1 / (size[2] * size[2])) * q / 8;
    const double warping = 4.0 / 9 * E * volume / (size[0] * size[0]) * q / 8;
    for (int n = 0; n < 8; ++n) {
        CHECK(twisted.f[0][n] == Approx(torsion * corner[n][1] * corner[n][2]).epsilon(1e-9));
        CHECK(warped.f[0][n] ==
              Approx(warping * corner[n][0] * corner[n][1] * corner[n][2]).epsilon(1e-9));
    }
}

TEST_CASE("bulk viscosity resists both ways linearly, and compression by a square on top") {
    OneElement e({1, 1, 1}, 0);
    const double rate = GENERATE(10.0, -10.0), dt = 1e-6;  // [1/s] of one direction
    for (int n = 0; n < 8; ++n) e.dx[0][n] = rate * dt * e.x[0][n];
    e.step(dt);
    const double l = e.constants.length, rho = 1000, c = e.law.sound_speed;
    const double quadratic = rate < 0 ? std::pow(1.2 * l * rate, 2) : 0.0;
    // strain 1e-5 in a step: midpoint and end differ by that
    CHECK(e.state.viscous == Approx(rho * (0.06 * c * l * rate - quadratic)).epsilon(2e-5));
    const double sum = (e.material.lambda + 2 * e.material.mu) * rate * dt + e.state.viscous;
    CHECK(e.f[0][1] == Approx(sum / 4).epsilon(5e-5));  // a quarter of the face's force
    CHECK(e.report.viscous_work > 0);
}

TEST_CASE("a rigid turn by 90 degrees turns stress and hourglass forces, and does no work") {
    const int steps = GENERATE(10, 10000);
    OneElement e({1.0, 0.6, 1.4}, 0.1);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> shift(-1e-3, 1e-3);
    for (int d = 0; d < 3; ++d)
        for (int n = 0; n < 8; ++n) {
            e.dx[d][n] = shift(random);
            e.x[d][n] += e.dx[d][n];
        }
    e.law.bulk_viscosity_linear = e.law.bulk_viscosity_quadratic = 0;
    e.step(1e-5);
    const OneElement start = e;
    const double angle = std::acos(-1.0) / 2;
    double work = 0;
    for (int k = 1; k <= steps; ++k) {  // about z, exact positions at each step
        const double c = std::cos(angle * k / steps), s = std::sin(angle * k / steps);
        for (int n = 0; n < 8; ++n) {
            const double x[2] = {c * start.x[0][n] - s * start.x[1][n],
                                 s * start.x[0][n] + c * start.x[1][n]};
            for (int d = 0; d < 2; ++d) {
                e.dx[d][n] = x[d] - e.x[d][n];
                e.x[d][n] = x[d];
            }
            e.dx[2][n] = 0;
        }
        e.step(1e-5);
        work += std::abs(e.report.strain_work) + std::abs(e.report.hourglass_work);
    }
    const Symmetric<double>&a = start.state.stress, &b = e.state.stress;
    const double size = std::abs(a.xx) + std::abs(a.yy) + std::abs(a.zz);
    // x -> y, y -> -x. Each step rounds positions of size 1 by 1e-16, which the material sees as
    // strain; the error may grow like the square root of the number of steps.
    const double tolerance = 1e-16 * (2e9 / size) * 30 * std::sqrt(double(steps));
    CHECK(b.yy / size == Approx(a.xx / size).margin(tolerance));
    CHECK(b.xx / size == Approx(a.yy / size).margin(tolerance));
    CHECK(b.zz / size == Approx(a.zz / size).margin(tolerance));
    CHECK(b.xy / size == Approx(-a.xy / size).margin(tolerance));
    CHECK(b.yz / size == Approx(a.zx / size).margin(tolerance));
    CHECK(b.zx / size == Approx(-a.yz / size).margin(tolerance));
    double error = 0, force = 0;
    for (int n = 0; n < 8; ++n) {
        error =
            std::max({error, std::abs(e.f[1][n] - start.f[0][n]),
                      std::abs(e.f[0][n] + start.f[1][n]), std::abs(e.f[2][n] - start.f[2][n])});
        force = std::max(force, std::abs(start.f[0][n]));
    }
    CHECK(error / force < tolerance);
    CHECK(work < 1e-9 * start.report.strain_work);
    WARN("90 degrees in " << steps << " steps: stress error " << std::abs(b.yy - a.xx) / size
                          << ", force error " << error / force << ", spurious work "
                          << work / start.report.strain_work);
}

}  // namespace
}  // namespace undertow::fem
