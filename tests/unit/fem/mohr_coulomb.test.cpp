// Mohr-Coulomb's law with a tension cut-off, against a search through all sets of active planes.

#include "fem_solver/materials/mohr_coulomb.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "fem_solver/materials/tresca.hpp"
#include "support.hpp"

namespace undertow::fem {
namespace {

using Tensor = Eigen::Matrix3d;
using Number = long double;
using Point = Eigen::Matrix<Number, 3, 1>;  // principal stresses, in any order

constexpr double degree = 3.14159265358979324 / 180;

Tensor matrix(const Symmetric<double>& s) {
    Tensor m;
    m << s.xx, s.xy, s.zx, s.xy, s.yy, s.yz, s.zx, s.yz, s.zz;
    return m;
}
Symmetric<double> symmetric(const Tensor& m) {
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)};
}
Tensor rotation(std::mt19937& random) {
    std::normal_distribution<double> gauss;
    Eigen::Quaterniond q(gauss(random), gauss(random), gauss(random), gauss(random));
    return q.normalized().toRotationMatrix();
}

/// `cutoff` over c cot phi (over c where phi = 0); 1 is the tip itself.
MohrCoulomb make_law(double c, double phi, double psi, double nu, double cutoff) {
    const double of_c = phi > 0 ? 1 / std::tan(phi * degree) : cutoff < 1 ? 1 : 1e100 / c;
    return {LinearElastic::from_young(500 * 1e4, nu), std::sin(phi * degree), std::sin(psi * degree),
            c * std::cos(phi * degree), cutoff * c * of_c};
}

/// n . s <= limit, flow along m.
struct Plane {
    Point n, m;
    Number limit;
};

std::vector<Plane> planes_of(const MohrCoulomb& law) {
    std::vector<Plane> planes;
    const Number phi = law.sin_friction, psi = law.sin_dilation;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (i == j) continue;
            Plane plane{Point::Zero(), Point::Zero(), 2 * Number(law.cohesion)};
            plane.n[i] = 1 + phi, plane.n[j] = phi - 1;
            plane.m[i] = 1 + psi, plane.m[j] = psi - 1;
            planes.push_back(plane);
        }
        Plane plane{Point::Unit(i), Point::Unit(i), Number(law.tension)};
        if (law.tension < 1e50) planes.push_back(plane);
    }
    return planes;
}

/// Every set of one, two and three planes is tried: stress = trial - D sum dl m, the set's planes
/// reached. The one whose multipliers and other planes are least violated is the answer, and any
/// other that is as good must give the same stress.
struct Search {
    Point best;
    Number violation = 1e300;  // [Pa]
    Number spread = 0;         // [Pa] between consistent answers
    int active = 0;
};

Search search(const MohrCoulomb& law, const Point& trial, Number tolerance) {
    const std::vector<Plane> planes = planes_of(law);
    const Number lambda = law.elastic.lambda, mu = law.elastic.mu;
    Eigen::Matrix<Number, 3, 3> D = Eigen::Matrix<Number, 3, 3>::Constant(lambda);
    D.diagonal().array() += 2 * mu;
    Search out;
    std::vector<Point> consistent;
    const auto consider = [&](const Point& s, Number least_multiplier, int active) {
        Number violation = std::max(Number(0), -least_multiplier * mu);
        for (const Plane& plane : planes)
            violation = std::max(violation, plane.n.dot(s) - plane.limit);
        if (violation < tolerance) consistent.push_back(s);
        if (violation < out.violation) out = {s, violation, 0, active};
    };
    const auto solve = [&](const std::vector<int>& set) {
        const int k = int(set.size());
        Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic> A(k, k);
        Eigen::Matrix<Number, Eigen::Dynamic, 1> b(k);
        for (int i = 0; i < k; ++i) {
            b[i] = planes[set[i]].n.dot(trial) - planes[set[i]].limit;
            for (int j = 0; j < k; ++j) A(i, j) = planes[set[i]].n.dot(D * planes[set[j]].m);
        }
        Eigen::FullPivLU<Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>> lu(A);
        lu.setThreshold(1e-12L);
        if (lu.rank() < k) return;
        const Eigen::Matrix<Number, Eigen::Dynamic, 1> dl = lu.solve(b);
        Point s = trial;
        for (int i = 0; i < k; ++i) s -= dl[i] * (D * planes[set[i]].m);
        consider(s, dl.minCoeff(), k);
    };
    consider(trial, 0, 0);
    const int n = int(planes.size());
    if (out.violation <= 0) return out;
    for (int i = 0; i < n; ++i) {
        solve({i});
        for (int j = i + 1; j < n; ++j) {
            solve({i, j});
            for (int k = j + 1; k < n; ++k) solve({i, j, k});
        }
    }
    for (const Point& s : consistent) out.spread = std::max(out.spread, (s - out.best).norm());
    return out;
}

struct Sand {
    double c, phi, psi, nu, cutoff;
};
const Sand sands[] = {{1e4, 30, 0, 0.3, 1},    {1e4, 30, 10, 0.3, 0.4}, {1e4, 45, 45, 0.49, 0},
                      {0, 35, 5, 0.25, 1},     {1e4, 0, 0, 0.49, 1},    {1e4, 0, 0, 0.49, 0.3},
                      {2e3, 60, 30, 0.1, 0.9}, {1e4, 20, 20, 0.0, 1},   {1e4, 80, 80, -0.3, 0.5}};

/// Trial stresses of every kind: anywhere, on the axes of the cone, near and on its edges, beyond
/// its tip, in tension along one, two, three directions.
Point make_trial(std::mt19937& random, const MohrCoulomb& law, int kind) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const double size = 1e4 * std::pow(10.0, 1.5 * uniform(random));
    double mean = 3 * size * uniform(random);
    Point s(uniform(random), uniform(random), uniform(random));
    if (kind == 1) s[1] = s[0];                         // triaxial: on an edge
    if (kind == 2) s[1] = s[0] + 1e-9 * s[2];           // beside it
    if (kind == 3) s[1] = s[0] + 1e-4 * s[2];           // not so near
    if (kind == 4) s = Point::Zero();                   // isotropic
    if (kind == 5) s *= 1e-7;                           // nearly
    if (kind >= 4 || kind == 6) mean = std::abs(mean);  // beyond the tip
    if (kind == 7) s = s.cwiseAbs(), mean = 0.1 * size;
    s *= size;
    s.array() += mean + (law.tension < 1e50 ? law.tension : 0.0);
    return s;
}

TEST_CASE("Mohr-Coulomb returns to where a search through all sets of planes finds the stress") {
    std::mt19937 random(7);
    Number worst = 0, apart = 0, unsure = 0;
    int returned = 0, of_active[4] = {};
    for (const Sand& sand : sands) {
        const MohrCoulomb law = make_law(sand.c, sand.phi, sand.psi, sand.nu, sand.cutoff);
        for (int k = 0; k < 1200; ++k) {
            const Point principal = make_trial(random, law, k % 8);
            const Tensor R = rotation(random);
            const Symmetric<double> start = symmetric(
                R * principal.cast<double>().asDiagonal() * R.transpose());
            Symmetric<double> s = start;
            PlasticFlow<double> flow;
            law(s, Symmetric<double>{}, 1, flow);
            const Number size = principal.norm() + law.cohesion;
            const Search exact = search(law, principal, 1e-15L * size);
            const Tensor reference = R * exact.best.cast<double>().asDiagonal() * R.transpose();
            const Number error = (matrix(s) - reference).norm() / size;
            worst = std::max(worst, error);
            apart = std::max(apart, exact.spread / size);
            unsure = std::max(unsure, exact.violation / size);
            ++of_active[exact.active];
            returned += flow.yielding > 0;
            INFO("phi " << sand.phi << ", psi " << sand.psi << ", nu " << sand.nu << ", cut-off "
                        << sand.cutoff << ", kind " << k % 8 << ", active planes " << exact.active
                        << ", trial " << principal.transpose() / 1e4L << ", reference "
                        << exact.best.transpose() / 1e4L);
            CHECK(double(error) < 1e-12);
            // states on the surface to round-off may go either way
            if (exact.active == 0) CHECK(flow.strain * law.elastic.mu <= 1e-12 * double(size));
        }
    }
    WARN("Mohr-Coulomb, " << std::size(sands) * 1200 << " trial stresses, " << returned
                          << " of them returned (active planes 0, 1, 2, 3: " << of_active[0] << ", "
                          << of_active[1] << ", " << of_active[2] << ", " << of_active[3]
                          << "): largest error over the trial stress " << double(worst)
                          << "; consistent sets differ by " << double(apart)
                          << ", the best is violated by " << double(unsure));
    CHECK(double(apart) < 1e-13);
    CHECK(double(unsure) < 1e-15);
    for (int active : of_active) CHECK(active > 500);
}

}  // namespace
}  // namespace undertow::fem
