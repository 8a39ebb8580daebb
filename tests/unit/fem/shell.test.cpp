// One shell: what a rigid turn, a uniform strain and the stable step must be.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "fem_solver/shells/plastic_section.hpp"
#include "shell_statics.hpp"

namespace undertow::fem {
namespace {

using Vector3 = Eigen::Vector3d;

/// Random convex quads, warped: corners of a rectangle of sides 1 and `aspect`, moved by `amount`.
ShellModel random_quad(std::mt19937& random, double aspect, double amount, double warp) {
    std::uniform_real_distribution<double> in(-1, 1);
    ShellModel model;
    const double a[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(in(random), in(random), in(random), in(random)).normalized();
    for (const auto& c : a) {
        const Vector3 x = turn * Vector3(aspect * c[0] + amount * in(random),
                                         c[1] + amount * in(random), warp * in(random));
        model.x.push_back({x[0], x[1], x[2]});
    }
    model.quad = {{0, 1, 2, 3}};
    model.thickness = 0.1;
    model.young_modulus = 7;
    model.poisson_ratio = 0.3;
    model.density = 2;
    return model;
}

TEST_CASE("a shell has six rigid motions without force, three patterns of drilling, and no more") {
    std::mt19937 random(1);
    for (int trial = 0; trial < 20; ++trial) {
        const ShellModel model = random_quad(random, 1.5, 0.2, trial % 2 ? 0.2 : 0.0);
        const ElementMatrix K = stiffness(model, model.quad[0]);
        CHECK((K - K.transpose()).norm() < 1e-13 * K.norm());
        for (int k = 0; k < 6; ++k) {
            Eigen::Matrix<double, 24, 1> u;
            for (int corner = 0; corner < 4; ++corner) {
                const auto& x = model.x[corner];
                const Vector3 axis = Vector3::Unit(k % 3);
                const Vector3 v = k < 3 ? axis : axis.cross(Vector3(x[0], x[1], x[2]));
                u.segment<3>(6 * corner) = v;
                u.segment<3>(6 * corner + 3) = k < 3 ? Vector3(0, 0, 0) : axis;
            }
            CHECK((K * u).norm() < 1e-13 * K.norm() * u.norm());
        }
        const Eigen::VectorXd values = eigenvalues(K);
        int zero = 0;
        for (int k = 0; k < 24; ++k) zero += values(k) < 1e-10 * values(23);
        // the nodes' turns about the normal count by their mean alone
        CHECK(zero == 9);
    }
}

TEST_CASE("the eigenvalue bound of a shell is above its largest eigenvalue and not far above") {
    std::mt19937 random(2);
    double least = 1e300, most = 0, square = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const double aspect = std::pow(10.0, (trial % 11) / 10.0);
        ShellModel model = random_quad(random, aspect, trial % 3 * 0.12, trial % 4 * 0.1);
        model.poisson_ratio = (trial % 5) * 0.12;
        model.thickness = std::pow(10.0, -(trial % 7) / 2.0);
        if (trial == 0) {
            model = random_quad(random, 1, 0, 0);
            model.thickness = 1e-3;
        }
        const auto& q = model.quad[0];
        const ElementMatrix K = stiffness(model, q);
        const Eigen::Matrix<double, 24, 1> root = lumped_mass(model, q).cwiseSqrt().cwiseInverse();
        const double exact =
            eigenvalues(root.asDiagonal() * K * root.asDiagonal())(23);
        double x[3][4], xi[3], eta[3], h[3], mean[3];
        for (int corner = 0; corner < 4; ++corner)
            for (int d = 0; d < 3; ++d) x[d][corner] = model.x[corner][d];
        mode_vectors(x, xi, eta, h, mean);
        const double ratio =
            shell_eigenvalue_bound(model.law(), model.constants(q), shell_frame(xi, eta, h)) /
            exact;
        if (trial == 0) square = ratio;
        least = std::min(least, ratio);
        most = std::max(most, ratio);
    }
    WARN("bound over largest eigenvalue: square " << square << ", all shapes " << least << " to "
                                                  << most);
    CHECK(least >= 1 - 1e-12);
    CHECK(square < 1.01);
    CHECK(most < 6);
}

TEST_CASE("a shell that turns as a rigid body by 90 degrees keeps its stress to round-off") {
    std::mt19937 random(3);
    for (const int steps : {10, 1000}) {
        const ShellModel model = random_quad(random, 1.3, 0.2, 0.15);
        const auto& q = model.quad[0];
        const ShellConstants<double> element = model.constants(q);
        ShellState<double> state{};
        Resultants<double> kept{{1, -2, 0.5}, {0.1, 0.3, -0.2}}, resultants;
        state.shear[0] = 0.7;
        const Vector3 axis = Vector3(1, 2, -0.5).normalized();
        const double angle = std::acos(0.0) / steps;
        // the finite turn whose displacements are those of the rotation vector at the midpoint
        const Vector3 dphi = 2 * std::tan(0.5 * angle) * axis;
        double x[3][4], f[3][4], m[3][4];
        for (int corner = 0; corner < 4; ++corner)
            for (int d = 0; d < 3; ++d) x[d][corner] = model.x[corner][d];
        ShellReport<double> report;
        ShellFrame<double> end;
        double work = 0;
        for (int n = 1; n <= steps; ++n) {
            const Eigen::AngleAxisd turn(angle * n, axis);
            double dx[3][4], turns[3][4];
            for (int corner = 0; corner < 4; ++corner) {
                const auto& x0 = model.x[corner];
                const Vector3 now = turn * Vector3(x0[0], x0[1], x0[2]);
                for (int d = 0; d < 3; ++d) {
                    dx[d][corner] = now[d] - x[d][corner];
                    x[d][corner] = now[d];
                    turns[d][corner] = dphi[d];
                }
            }
            step_shell(x, dx, turns, element, model.section(), model.law(), kept, state, resultants,
                       f, m, report, end);
            work += std::abs(report.strain_work) + std::abs(report.hourglass_work);
        }
        INFO(steps << " steps");
        const double modulus = model.young_modulus * model.thickness;
        CHECK(std::abs(resultants.N[0] - 1) < 1e-12 * modulus);
        CHECK(std::abs(resultants.N[1] + 2) < 1e-12 * modulus);
        CHECK(std::abs(resultants.N[2] - 0.5) < 1e-12 * modulus);
        CHECK(std::abs(resultants.M[0] - 0.1) < 1e-12 * modulus);
        CHECK(std::abs(state.shear[0] - 0.7) < 1e-12 * modulus);
        CHECK(std::abs(state.shear[1]) < 1e-12 * modulus);
        for (int k = 0; k < 2; ++k) {
            CHECK(std::abs(state.membrane[k]) < 1e-12 * modulus);
            CHECK(std::abs(state.bending[k]) < 1e-12 * modulus);
            CHECK(std::abs(state.twist[k]) < 1e-12 * modulus);
        }
        CHECK(work < 1e-11);
    }
}

/// A section of a shell, layered; 200 GPa, yields at 200 MPa.
PlasticSection steel_section(double hardening) {
    return {0.01, {LinearElastic::from_young(2e11, 0.3), Hardening::line(2e8, hardening)}};
}

TEST_CASE(
    "a layered section is elastic as the exact one is, and yields as J2 in plane stress does") {
    const PlasticSection section = steel_section(1e9);
    const ElasticSection elastic{0.01, 2e11 / 0.91, 0.3};
    LayeredState<double> layers{};
    Resultants<double> kept{}, out, exact;
    const double turn = 0, eps[3] = {2e-5, -1e-5, 3e-5}, kappa[3] = {1e-3, 2e-3, -1e-3};
    const double work = section(layers, turn, eps, kappa, out).total;
    CHECK(work == Approx(elastic(kept, turn, eps, kappa, exact).total).epsilon(1e-13));
    for (int k = 0; k < 3; ++k) {
        CHECK(out.N[k] == Approx(exact.N[k]).epsilon(1e-13));
        CHECK(out.M[k] == Approx(exact.M[k]).epsilon(1e-13));
    }

    // uniaxial tension far beyond yield: stress = yield + hardening * plastic strain
    layers = {};
    const double none[3] = {0, 0, 0};
    double strain = 0, plastic = 0, total = 0;
    for (int n = 0; n < 2000; ++n) {
        // the strain across follows from a free side: half of the axial one once plastic
        double side = -0.3e-5;
        for (int k = 0; k < 20; ++k) {
            LayeredState<double> tried = layers;
            const double d[3] = {1e-5, side, 0};
            section(tried, turn, d, none, out);
            side -= out.N[1] / (2e11 / 0.91 * 0.01);
        }
        const double d[3] = {1e-5, side, 0};
        const SectionWork<double> w = section(layers, turn, d, none, out);
        plastic += w.plastic;
        total += w.total;
        strain += 1e-5;
    }
    const double stress = out.N[0] / 0.01, eps_p = strain - stress / 2e11;
    CHECK(std::abs(out.N[1]) < 1e-6 * out.N[0]);
    CHECK(stress == Approx(2e8 + 1e9 * eps_p).epsilon(1e-6));
    CHECK(layers.plastic_strain[2] == Approx(eps_p).epsilon(1e-6));
    // what is not dissipated is stored
    CHECK((total - plastic) / 0.01 == Approx(stress * stress / 2 / 2e11).epsilon(1e-4));

    // pure shear of a perfectly plastic section
    const PlasticSection perfect = steel_section(0);
    layers = {};
    const double shear[3] = {0, 0, 1e-3};
    for (int n = 0; n < 10; ++n) perfect(layers, turn, shear, none, out);
    CHECK(out.N[2] == Approx(2e8 / std::sqrt(3.0) * 0.01).epsilon(1e-12));

    // bending beyond yield: the plastic moment of plane strain across, (2/sqrt 3) s_y t^2/4
    layers = {};
    const double bend[3] = {1e-2, 0, 0};
    for (int n = 0; n < 200; ++n) perfect(layers, turn, none, bend, out);
    const double full = 2 / std::sqrt(3.0) * 2e8 * 1e-4 / 4;
    WARN("plastic moment with five points: " << out.M[0] / full << " of the exact one");
    CHECK(out.M[0] / full == Approx(1).epsilon(1e-3));
}

/// The five-element patch of MacNeal and Harder 1985.
ShellModel patch() {
    ShellModel model;
    model.x = {{0, 0, 0},       {0.24, 0, 0},    {0.24, 0.12, 0}, {0, 0.12, 0},
               {0.04, 0.02, 0}, {0.18, 0.03, 0}, {0.16, 0.08, 0}, {0.08, 0.08, 0}};
    model.quad = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};
    model.thickness = 0.02;
    model.young_modulus = 1e6;
    model.poisson_ratio = 0.25;
    return model;
}

TEST_CASE("a distorted patch carries a uniform membrane strain and a uniform curvature exactly") {
    const ShellModel model = patch();
    const int n = int(model.x.size());
    const bool bending = GENERATE(false, true);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(6 * n);
    for (int k = 0; k < n; ++k) {
        const double x = model.x[k][0], y = model.x[k][1];
        if (bending) {  // w = 1e-3 (x^2 + x y + y^2)/2, normals stay normal
            u(6 * k + 2) = 0.5e-3 * (x * x + x * y + y * y);
            u(6 * k + 3) = 0.5e-3 * (x + 2 * y);   // phi_x = w,y
            u(6 * k + 4) = -0.5e-3 * (2 * x + y);  // phi_y = -w,x
        } else {
            u(6 * k) = 1e-3 * (x + 0.5 * y);
            u(6 * k + 1) = 1e-3 * (y + 0.5 * x);
        }
    }
    std::vector<int> outer;
    for (int k = 0; k < 4; ++k)
        for (int d = 0; d < 6; ++d) outer.push_back(6 * k + d);
    // the inner nodes find the field from the outer ones alone
    Eigen::VectorXd given = u;
    given.tail(6 * 4).setZero();
    const Eigen::VectorXd found = given + solve(model, outer, -internal_forces(model, given));
    double worst = 0;
    for (int k = 4; k < n; ++k)
        for (int d = 0; d < 5; ++d)  // not the turn about the normal
            worst = std::max(worst, std::abs(found(6 * k + d) - u(6 * k + d)));
    WARN((bending ? "bending" : "membrane")
         << " patch: error of the inner nodes " << worst / u.cwiseAbs().maxCoeff());
    // t/L = 1/12; the conditioning of bending grows as (L/t)^2, and round-off with it
    CHECK(worst < 1e-12 * u.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace undertow::fem
