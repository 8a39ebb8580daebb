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
    return {LinearElastic::from_young(500 * 1e4, nu), std::sin(phi * degree),
            std::sin(psi * degree), c * std::cos(phi * degree), cutoff * c * of_c};
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
            const Symmetric<double> start =
                symmetric(R * principal.cast<double>().asDiagonal() * R.transpose());
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

TEST_CASE("without friction Mohr-Coulomb is Tresca with s_u = c") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    constexpr double su = 1e4;
    const MohrCoulomb law = make_law(su, 0, 0, 0.49, 1);
    const Tresca tresca{law.elastic, su};
    const double mu = law.elastic.mu;
    int returned = 0;
    for (int k = 0; k < 1000; ++k) {
        const auto some = [&](double size) {
            return Symmetric<double>{size * uniform(random), size * uniform(random),
                                     size * uniform(random), size * uniform(random),
                                     size * uniform(random), size * uniform(random)};
        };
        Symmetric<double> s = some(0.5 * su), t = s;
        const Symmetric<double> d_eps = some(2 * su / mu);
        PlasticFlow<double> flow, flow_of_tresca;
        law(s, d_eps, 1, flow);
        tresca(t, d_eps, 1, flow_of_tresca);
        const double size = matrix(t).norm();
        CHECK((matrix(s) - matrix(t)).norm() < 1e-13 * size);
        CHECK(flow.yielding == flow_of_tresca.yielding);
        CHECK(flow.strain == Approx(flow_of_tresca.strain).margin(1e-13 * size / mu));
        CHECK(flow.work == Approx(flow_of_tresca.work).margin(1e-13 * size * size / mu));
        returned += flow.yielding > 0;
    }
    CHECK(returned > 500);
}

TEST_CASE("eight lanes of Mohr-Coulomb give what eight scalars give, and book the plastic work") {
    std::mt19937 random(5);
    for (const Sand& sand : sands) {
        const MohrCoulomb law = make_law(sand.c, sand.phi, sand.psi, sand.nu, sand.cutoff);
        const double lambda = law.elastic.lambda, mu = law.elastic.mu;
        for (int k = 0; k < 100; ++k) {
            Symmetric<Lanes> s = {}, d_eps = {};
            Symmetric<double> s1[n_lanes], d1[n_lanes];
            double size = 0;
            for (int l = 0; l < n_lanes; ++l) {
                const Tensor R = rotation(random);
                const Point a = make_trial(random, law, l), b = make_trial(random, law, 0);
                s1[l] = symmetric(R * a.cast<double>().asDiagonal() * R.transpose());
                d1[l] = symmetric(0.3 / mu * b.cast<double>().asDiagonal().toDenseMatrix());
                const double *from = &s1[l].xx, *step = &d1[l].xx;
                Lanes *to = &s.xx, *step_to = &d_eps.xx;
                for (int c = 0; c < 6; ++c) to[c][l] = from[c], step_to[c][l] = step[c];
                size = std::max({size, double(a.norm()), 3 * (lambda / mu + 2) * double(b.norm())});
            }
            PlasticFlow<Lanes> flow;
            law(s, d_eps, 1, flow);
            for (int l = 0; l < n_lanes; ++l) {
                const Tensor before = matrix(s1[l]);
                PlasticFlow<double> flow1;
                law(s1[l], d1[l], 1, flow1);
                const double* want = &s1[l].xx;
                const Lanes* got = &s.xx;
                for (int c = 0; c < 6; ++c)
                    CHECK(double(got[c][l]) == Approx(want[c]).margin(1e-12 * size));
                CHECK(flow.yielding[l] == flow1.yielding);
                CHECK(flow.strain[l] == Approx(flow1.strain).margin(1e-12 * size / mu));
                CHECK(flow.work[l] == Approx(flow1.work).margin(1e-11 * size * size / mu));
                // what is not elastic is the plastic strain
                const Tensor d_eps1 = matrix(d1[l]), change = matrix(s1[l]) - before;
                const Tensor plastic = d_eps1 - (change - lambda / (3 * lambda + 2 * mu) *
                                                              change.trace() * Tensor::Identity()) /
                                                    (2 * mu);
                const Tensor deviator = plastic - plastic.trace() / 3 * Tensor::Identity();
                CHECK(flow1.strain ==
                      Approx(std::sqrt(2. / 3) * deviator.norm()).margin(1e-12 * size / mu));
                const double work = 0.5 * (before + matrix(s1[l])).cwiseProduct(plastic).sum();
                CHECK(flow1.work == Approx(work).margin(1e-11 * size * size / mu));
            }
        }
    }
}

struct Kind {
    const char* name;
    ElementFormulation element;
    BlockCells cells;
};
const Kind kinds[] = {
    {"one-point hexahedra", ElementFormulation::one_point, BlockCells::hexahedra},
    {"8-point hexahedra", ElementFormulation::b_bar, BlockCells::hexahedra},
    {"tetrahedra", ElementFormulation::averaged_pressure, BlockCells::tetrahedra}};

TEST_CASE("sand that slides and opens closes its energy balance, whatever the element") {
    const Kind kind = kinds[GENERATE(0, 1, 2)];
    BlockCase block{{1, 1, 1}, {2, 3, 2}, 5e6, 0.3, 1846, kind.element, kind.cells};
    Case c = block.settings();
    FemMaterial& sand = c.fem.material[0];
    sand.kind = MaterialKind::mohr_coulomb;
    sand.cohesion = 5e3;
    sand.friction_angle = 30;
    sand.dilation_angle = 10;
    sand.tension_cutoff = 2e3;
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    const double load = GENERATE(3e4, -8e3);  // pressed, pulled: more than it bears
    c.fem.pressure = {{"zmax", load, 0.1}};
    Structure s(build_model(c), 1);
    const double dt = 0.5 * s.stable_step().dt;
    Energies e;
    march(s, dt, int(0.1 / dt), [&](int) { e = s.energies(); });
    const double scale = e.internal + e.plastic;
    WARN(kind.name << (load > 0 ? ", pressed" : ", pulled") << ": plastic " << e.plastic
                   << " J, stored " << e.internal << " J, hourglass " << e.hourglass
                   << " J, balance error over both " << e.balance_error() / scale);
    CHECK(e.plastic > 0.2 * e.internal);
    CHECK(std::abs(e.balance_error()) < 1e-5 * scale);
    CHECK(s.yielding_elements() > 0);
}

}  // namespace
}  // namespace undertow::fem
