// Tresca's law: closest point, face and edges, plastic work, and what it leaves to the hourglass
// stresses.

#include "fem_solver/materials/tresca.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "fem_solver/elements/hexahedron.hpp"
#include "support.hpp"

namespace undertow::fem {
namespace {

using Tensor = Eigen::Matrix3d;

constexpr double su = 9540;  // [Pa]
const LinearElastic moduli = LinearElastic::from_young(500 * su, 0.49);
const Tresca law{moduli, su};
constexpr double corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                 {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

Tensor matrix(const Symmetric<double>& s) {
    Tensor m;
    m << s.xx, s.xy, s.zx, s.xy, s.yy, s.yz, s.zx, s.yz, s.zz;
    return m;
}
Symmetric<double> symmetric(const Tensor& m) {
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(2, 0)};
}
/// Strain that takes one stress to the other elastically.
Tensor strain_between(const Tensor& from, const Tensor& to) {
    const Tensor d = to - from;
    const double bulk = 3 * moduli.lambda + 2 * moduli.mu;
    return (d - moduli.lambda / bulk * d.trace() * Tensor::Identity()) / (2 * moduli.mu);
}
Tensor rotation(std::mt19937& random) {
    std::normal_distribution<double> gauss;
    Eigen::Quaterniond q(gauss(random), gauss(random), gauss(random), gauss(random));
    return q.normalized().toRotationMatrix();
}

/// Distance in the deviatoric plane from d (principal deviators, decreasing) to the hexagon, by
/// walking along its six sides. Energy is distance squared over 4 mu, and the mean stress is best
/// left as it is, so this is the closest point of the whole surface.
double distance_by_search(const Eigen::Vector3d& d) {
    // corners: permutations of 2/3 s_u (1, 1, -2) and 2/3 s_u (2, -1, -1), around
    const Eigen::Vector3d c[6] = {{2, -1, -1}, {1, 1, -2},  {-1, 2, -1},
                                  {-2, 1, 1},  {-1, -1, 2}, {1, -2, 1}};
    double best = 1e300;
    for (int side = 0; side < 6; ++side) {
        const Eigen::Vector3d a = 2. / 3 * su * c[side], b = 2. / 3 * su * c[(side + 1) % 6];
        for (int k = 0; k <= 4000; ++k)
            best = std::min(best, (d - (a + (b - a) * (k / 4000.0))).norm());
    }
    return best;
}

struct Trial {
    Tensor before, trial;
    Eigen::Vector3d principal;  // deviators of the trial stress, decreasing
};

/// Trial stresses on faces, on edges, near and exactly on triaxial states; `size` of the largest
/// shear stress over s_u.
Trial make_trial(std::mt19937& random, int kind, double size) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::Vector3d d;
    const double apart = kind == 1 ? 0 : kind == 2 ? 1e-9 : 0.5 * (uniform(random) + 1);
    d << 1, 1 - 2 * apart, -1;  // apart = 0 and 1: triaxial extension and compression
    if (kind == 3) d[1] = -1;
    d *= size * su;
    d.array() -= d.mean();
    const Tensor R = rotation(random);
    const double p = 20 * su * uniform(random);
    Trial t;
    t.principal = d;
    t.trial = R * d.asDiagonal() * R.transpose() + p * Tensor::Identity();
    const Tensor Q = rotation(random);
    t.before = 0.4 * su * (Q * Eigen::Vector3d(1, 0.3, -1.3).asDiagonal() * Q.transpose());
    t.before += 5 * su * uniform(random) * Tensor::Identity();
    return t;
}

TEST_CASE("a trial stress returns to the closest point of the Tresca surface, coaxially") {
    std::mt19937 random(3);
    const double size = GENERATE(0.999, 1.0001, 1.3, 3.0, 100.0);
    const int kind = GENERATE(0, 1, 2, 3);
    for (int k = 0; k < 25; ++k) {
        const Trial t = make_trial(random, kind, size);
        const Tensor d_eps = strain_between(t.before, t.trial);
        Symmetric<double> s = symmetric(t.before);
        PlasticFlow<double> flow;
        law(s, symmetric(d_eps), 1, flow);
        const Tensor returned = matrix(s);
        // round-off of the trial stress, whose mean is up to 20 s_u, and up to sqrt of it where
        // two principal values meet
        const double tolerance = 1e-12 * (size + 25) * su;
        Eigen::SelfAdjointEigenSolver<Tensor> principal(returned, Eigen::EigenvaluesOnly);
        const double shear = 0.5 * (principal.eigenvalues()[2] - principal.eigenvalues()[0]);
        CHECK(flow.yielding == (size > 1 ? 1 : 0));
        CHECK(shear == Approx(std::min(size, 1.0) * su).epsilon(0).margin(tolerance));
        CHECK((returned * t.trial - t.trial * returned).norm() < 20 * tolerance * (size + 25) * su);
        CHECK(returned.trace() == Approx(t.trial.trace()).margin(tolerance));
        const double distance = (t.trial - returned).norm(), best = distance_by_search(t.principal);
        if (size > 1) CHECK(distance <= best + tolerance);
        // the search steps by 4e-4 s_u along a side: its distance is off by the square of half that
        // over the distance
        const double resolution = std::pow(2e-4 * su, 2) / (2 * std::max(distance, 1e-4 * su));
        if (size > 1) CHECK(distance > best - resolution - tolerance);
        // plastic strain and work from the drop of the stress
        const Tensor plastic = d_eps - strain_between(t.before, returned);
        CHECK(std::abs(plastic.trace()) < 1e-12 * d_eps.norm());
        CHECK(flow.strain == Approx(std::sqrt(2. / 3) * plastic.norm())
                                 .margin(1e-12 * (d_eps.norm() + (size + 25) * su / moduli.mu)));
        const double work = (0.5 * (t.before + returned).cwiseProduct(plastic)).sum();
        CHECK(flow.work == Approx(work).margin(1e-10 * su * size * su / moduli.mu));
    }
}

TEST_CASE("eight lanes of the Tresca law give what eight scalars give, yielding or not") {
    std::mt19937 random(5);
    for (int k = 0; k < 200; ++k) {
        Symmetric<Lanes> s, d_eps;
        Symmetric<double> s1[n_lanes], d_eps1[n_lanes];
        for (int l = 0; l < n_lanes; ++l) {
            const Trial t = make_trial(random, l % 4, k % 3 == 0 ? 0.5 : 0.3 + 0.3 * l);
            s1[l] = symmetric(t.before);
            d_eps1[l] = symmetric(strain_between(t.before, t.trial));
            s.xx[l] = s1[l].xx, s.yy[l] = s1[l].yy, s.zz[l] = s1[l].zz;
            s.xy[l] = s1[l].xy, s.yz[l] = s1[l].yz, s.zx[l] = s1[l].zx;
            d_eps.xx[l] = d_eps1[l].xx, d_eps.yy[l] = d_eps1[l].yy, d_eps.zz[l] = d_eps1[l].zz;
            d_eps.xy[l] = d_eps1[l].xy, d_eps.yz[l] = d_eps1[l].yz, d_eps.zx[l] = d_eps1[l].zx;
        }
        PlasticFlow<Lanes> flow;
        law(s, d_eps, 1, flow);
        for (int l = 0; l < n_lanes; ++l) {
            PlasticFlow<double> flow1;
            law(s1[l], d_eps1[l], 1, flow1);
            const double tolerance = 1e-12 * 30 * su;  // round-off at a mean stress of 20 s_u
            const double got[6] = {s.xx[l], s.yy[l], s.zz[l], s.xy[l], s.yz[l], s.zx[l]};
            const double want[6] = {s1[l].xx, s1[l].yy, s1[l].zz, s1[l].xy, s1[l].yz, s1[l].zx};
            for (int c = 0; c < 6; ++c) CHECK(got[c] == Approx(want[c]).margin(tolerance));
            CHECK(flow.yielding[l] == flow1.yielding);
            CHECK(flow.strain[l] == Approx(flow1.strain).margin(30e-12));
            CHECK(flow.work[l] == Approx(flow1.work).margin(1e-10 * su));
        }
    }
}

/// Equal steps of strain up to `total`.
PlasticFlow<double> strain_to(Symmetric<double>& s, const Symmetric<double>& total, int steps) {
    PlasticFlow<double> sum{}, flow;
    const double f = 1.0 / steps;
    for (int k = 0; k < steps; ++k) {
        law(s, {f * total.xx, f * total.yy, f * total.zz, f * total.xy, f * total.yz, f * total.zx},
            1, flow);
        sum.strain += flow.strain;
        sum.work += flow.work;
    }
    return sum;
}

TEST_CASE("simple shear stops at s_u and dissipates s_u times the plastic shear") {
    const double gamma = 0.01, elastic = su / moduli.mu;  // engineering
    Symmetric<double> s{};
    const PlasticFlow<double> sum = strain_to(s, {0, 0, 0, gamma / 2, 0, 0}, 100);
    CHECK(s.xy == Approx(su).epsilon(1e-12));
    CHECK(std::abs(s.xx) + std::abs(s.yy) + std::abs(s.zz) < 1e-9 * su);
    CHECK(sum.strain == Approx((gamma - elastic) / std::sqrt(3)).epsilon(1e-9));
    // the step in which flow begins takes the mean of both stresses
    CHECK(sum.work == Approx(su * (gamma - elastic)).epsilon(0.01));
    const PlasticFlow<double> back = strain_to(s, {0, 0, 0, -elastic, 0, 0}, 100);
    CHECK(s.xy == Approx(-su).epsilon(1e-9));  // unloads elastically, 2 s_u to the other side
    CHECK(back.strain == Approx(0).margin(1e-12));
}

TEST_CASE("triaxial compression and extension end at q = 2 s_u on an edge, from any K0") {
    const double direction = GENERATE(-1.0, 1.0), K0 = GENERATE(1.0, 0.5);
    Symmetric<double> s{-K0 * su, -K0 * su, -su, 0, 0, 0};
    const double p = (s.xx + s.yy + s.zz) / 3, e = 0.01 * direction;
    const PlasticFlow<double> sum = strain_to(s, {-e / 2, -e / 2, e, 0, 0, 0}, 50);
    CHECK(s.zz - s.xx == Approx(2 * su * direction).epsilon(1e-12));
    CHECK(s.xx == Approx(s.yy).epsilon(1e-12));
    CHECK((s.xx + s.yy + s.zz) / 3 == Approx(p).epsilon(1e-12));
    const double start = (K0 - 1) * su;  // q at the start
    const double elastic = std::abs(2 * su * direction - start) / (3 * moduli.mu);
    CHECK(sum.strain == Approx(0.01 - elastic).epsilon(1e-9));
}

TEST_CASE("plane strain compression flows on a face: the middle stress stays where it was") {
    Symmetric<double> s{};
    strain_to(s, {0.01, 0, -0.01, 0, 0, 0}, 40);
    CHECK(s.xx - s.zz == Approx(2 * su).epsilon(1e-12));
    CHECK(std::abs(s.yy) < 1e-9 * su);
}

TEST_CASE("what is left of the stress work after the plastic work is the elastic energy") {
    BlockCase block{{1, 1, 1}, {2, 3, 2}, 500 * su, 0.49, 1846};
    Case c = block.settings();
    c.fem.material[0].kind = MaterialKind::tresca;
    c.fem.material[0].shear_strength = su;
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 3 * su, 0.2}};  // beyond the limit: it gives way
    Structure s(build_model(c), 1);
    const double dt = 0.5 * s.stable_step().dt;
    Energies e;
    march(s, dt, int(0.18 / dt), [&](int) { e = s.energies(); });
    double stored = 0, flowed = 0;
    const std::vector<double> stress = s.elements().stress(),
                              strain = s.elements().plastic_strain();
    for (std::size_t e = 0; e < s.elements().size(); ++e) {
        const double* r = &stress[6 * e];
        const Tensor sigma = matrix({r[0], r[1], r[2], r[3], r[4], r[5]});
        stored += 0.5 * sigma.cwiseProduct(strain_between(Tensor::Zero(), sigma)).sum() / 12;
        flowed = std::max(flowed, strain[e]);
    }
    WARN("largest plastic strain " << flowed << ", stored " << e.internal << " J of "
                                   << e.internal + e.plastic << ", hourglass over internal "
                                   << e.hourglass / (e.internal + e.plastic));
    CHECK(flowed > 1e-3);
    CHECK(e.plastic > 0.2 * e.internal);
    CHECK(e.internal == Approx(stored).epsilon(0.02));  // strains of 1e-2: volumes, Jaumann rate
    CHECK(std::abs(e.balance_error()) < 1e-5 * (e.internal + e.plastic));
}

/// An element that is bent by u_x = q xi zeta while a mean shear strain gamma_xy = `shear` q goes
/// on: its moment at last over that at which the outer fiber of an elastic section reaches 2 s_u.
double bending_moment(double shear) {
    HexahedronState<double> state{};
    HexahedronConstants<double> constants{.mass = 1000,
                                          .length = 1,
                                          .axis_weight = {1. / 16, 1. / 16, 1. / 16},
                                          .omega2_reference = 1};
    const double mu = moduli.mu, nu = moduli.poisson_ratio();
    const ElementLaw constants_of_law{.inverse_density = 1e-3,
                                         .lambda = moduli.lambda,
                                         .mu = mu,
                                         .sound_speed = 100,
                                         .bending_modulus = 2 * mu / (1 - nu),
                                         .poisson_ratio = nu,
                                         .young_modulus = 2 * mu * (1 + nu),
                                         .bulk_viscosity_linear = 0,
                                         .bulk_viscosity_quadratic = 0};
    double x[3][8], dx[3][8] = {}, f[3][8];
    for (int n = 0; n < 8; ++n)
        for (int d = 0; d < 3; ++d) x[d][n] = 0.5 * corner[n][d];
    for (int n = 0; n < 8; ++n) dx[0][n] = 1e-4 * (corner[n][0] * corner[n][2] + shear * x[1][n]);
    ElementReport<double> report;
    double plastic_strain = 0;
    for (int k = 0; k < 200; ++k)
        step_hexahedron(x, dx, 1.0, constants, law, constants_of_law, state, &plastic_strain, f, report);
    // fiber stress 2 s_u at the faces of a cube of side 1: M = 2 s_u/6; four nodes at x = 1/2
    double moment = 0;
    for (int n = 0; n < 8; ++n)
        if (corner[n][0] > 0) moment += f[0][n] * x[2][n];
    return moment / (2 * su / 6);
}

TEST_CASE("bending of one element ends at the plastic moment, and at less where the whole flows") {
    CHECK(bending_moment(0) == Approx(1.5).epsilon(1e-9));
    // fiber stress E_ps (u_x,x at the face = 2 q) against its decay at gammadot mu/s_u: in units of
    // 2 s_u, E_ps 2 q/(2 mu gammadot) = 2/(1 - nu)/(shear of the flow)
    const double nu = moduli.poisson_ratio();
    for (const double shear : {10.0, 40.0}) {
        INFO("shear over bending " << shear);
        CHECK(bending_moment(shear) == Approx(2 / (1 - nu) / shear).epsilon(0.05));
    }
}

}  // namespace
}  // namespace undertow::fem
