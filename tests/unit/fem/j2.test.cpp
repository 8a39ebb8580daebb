// J2 plasticity in solids: radial return, hardening by a line and by a table, and the elements that
// carry it.

#include "fem_solver/materials/j2.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support.hpp"

namespace undertow::fem {
namespace {

constexpr double sy = 4e8;  // [Pa]
const LinearElastic moduli = LinearElastic::from_young(1.17e11, 0.35);
const std::array<double, 2> rows[] = {{0, sy}, {0.002, 1.5 * sy}, {0.01, 1.6 * sy}, {0.05, 2 * sy}};
const J2 line{moduli, Hardening::line(sy, 1e9)}, table{moduli, Hardening::table(rows)},
    perfect{moduli, Hardening::line(sy, 0)};

template <class T>
T von_mises(const Symmetric<T>& s) {
    const T p = (s.xx + s.yy + s.zz) / 3.0;
    const T xx = s.xx - p, yy = s.yy - p, zz = s.zz - p;
    return square_root(
        T(1.5 * (xx * xx + yy * yy + zz * zz) + 3.0 * (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx)));
}

double interpolated(double e) {
    for (int k = 1; k < 4; ++k)
        if (e < rows[k][0])
            return rows[k - 1][1] + (rows[k][1] - rows[k - 1][1]) * (e - rows[k - 1][0]) /
                                        (rows[k][0] - rows[k - 1][0]);
    return rows[3][1];
}

TEST_CASE("a hardening table is followed piece by piece, and exactly across many of them") {
    const Hardening& k = table.hardening;
    for (const double e : {0.0, 0.001, 0.002, 0.005, 0.01, 0.03, 0.05, 3.0}) {
        CHECK(k.strength(e) == Approx(interpolated(e)).epsilon(1e-14));
        // each trial stress beyond the strength: what flows ends on the table
        for (const double beyond : {1e-6, 0.01, 1.0, 10.0, 1e4}) {
            const double stiffness = 3 * moduli.mu, trial = k.strength(e) * (1 + beyond);
            const double d = k.flow(trial, stiffness, e);
            CHECK(d > 0);
            CHECK(trial - stiffness * d == Approx(interpolated(e + d)).epsilon(1e-12 * (1 + beyond)));
        }
    }
    CHECK(k.tangent(0.002) == Approx(0.1 * sy / 0.008));
    CHECK(k.tangent(1.0) == 0);
}

TEST_CASE("the stress returns along its deviator to the strength that it leaves behind") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    // by pointer: of a list of copies on the stack, 16-byte aligned, g++ 12.2 loads the table with
    // aligned 32-byte moves in the 256-bit epilogue of the loop over its pieces, which it vectorizes
    // with 512 bits. The compiler's fault: with --param vect-epilogues-nomask=0, or
    // -Wa,-muse-unaligned-vector-move, the same source runs
    for (const J2* of_kind : {&line, &table, &perfect})
        for (int k = 0; k < 300; ++k) {
            const double size = std::pow(10.0, 2 * uniform(random) - 3);  // of strain, 1e-5 to 0.1
            const Symmetric<double> before{1e8 * uniform(random), 1e8 * uniform(random),
                                           1e8 * uniform(random), 1e8 * uniform(random),
                                           1e8 * uniform(random), 1e8 * uniform(random)};
            const Symmetric<double> d{size * uniform(random), size * uniform(random),
                                      size * uniform(random), size * uniform(random),
                                      size * uniform(random), size * uniform(random)};
            const double strain = 0.03 * (1 + uniform(random));
            Symmetric<double> trial = before, s = before;
            moduli(trial, d, 1);
            const J2& law = *of_kind;
            PlasticFlow<double> flow;
            law(s, d, 1, strain, flow);
            const double q = von_mises(trial), limit = law.strength(strain);
            CHECK(flow.yielding == (q > limit ? 1 : 0));
            CHECK(von_mises(s) ==
                  Approx(std::min(q, law.strength(strain + flow.strain))).epsilon(1e-12));
            // what is not elastic is the plastic strain: its norm, its direction, its work
            const double share = q > limit ? von_mises(s) / q : 1, mean = (s.xx + s.yy + s.zz) / 3;
            CHECK(mean == Approx((trial.xx + trial.yy + trial.zz) / 3).margin(1e-12 * q));
            CHECK(s.xy == Approx(share * trial.xy).margin(1e-12 * q));
            CHECK(s.zz - mean == Approx(share * (trial.zz - mean)).margin(1e-12 * q));
            CHECK(flow.strain == Approx((1 - share) * q / (3 * moduli.mu)).margin(1e-14));
            const double n = flow.strain / q * 1.5;  // times the trial deviator
            const double work = 0.5 * n *
                                ((before.xx + s.xx) * (trial.xx - mean) +
                                 (before.yy + s.yy) * (trial.yy - mean) +
                                 (before.zz + s.zz) * (trial.zz - mean) +
                                 2 * ((before.xy + s.xy) * trial.xy + (before.yz + s.yz) * trial.yz +
                                      (before.zx + s.zx) * trial.zx));
            CHECK(flow.work == Approx(work).margin(1e-12 * q * size));
        }
}

TEST_CASE("eight lanes of J2 give what eight scalars give, yielding or not") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int k = 0; k < 200; ++k) {
        Symmetric<Lanes> s = {}, d = {};
        Lanes strain;
        Symmetric<double> s1[n_lanes], d1[n_lanes];
        for (int l = 0; l < n_lanes; ++l) {
            const double size = k % 2 ? 1e-2 : 4e-3 * l / n_lanes;
            d1[l] = {size * uniform(random), size * uniform(random), size * uniform(random),
                     size * uniform(random), size * uniform(random), size * uniform(random)};
            s1[l] = {1e8 * uniform(random), 0, 0, 1e8 * uniform(random), 0, 0};
            d.xx[l] = d1[l].xx, d.yy[l] = d1[l].yy, d.zz[l] = d1[l].zz;
            d.xy[l] = d1[l].xy, d.yz[l] = d1[l].yz, d.zx[l] = d1[l].zx;
            s.xx[l] = s1[l].xx, s.xy[l] = s1[l].xy;
            strain[l] = 0.02 * (1 + uniform(random));
        }
        PlasticFlow<Lanes> flow;
        table(s, d, 1, strain, flow);
        for (int l = 0; l < n_lanes; ++l) {
            PlasticFlow<double> flow1;
            table(s1[l], d1[l], 1, double(strain[l]), flow1);
            CHECK(s.xx[l] == Approx(s1[l].xx).margin(1e-12 * sy));
            CHECK(s.yz[l] == Approx(s1[l].yz).margin(1e-12 * sy));
            CHECK(flow.yielding[l] == flow1.yielding);
            CHECK(flow.strain[l] == Approx(flow1.strain).margin(1e-14));
            CHECK(flow.work[l] == Approx(flow1.work).margin(1e-12 * sy));
        }
    }
}

TEST_CASE("simple shear hardens along the line: tau sqrt 3 is k of gamma_p/sqrt 3") {
    const double gamma = 0.1;  // engineering
    constexpr int steps = 1000;
    Symmetric<double> s{};
    double strain = 0, work = 0;
    for (int k = 0; k < steps; ++k) {
        PlasticFlow<double> flow;
        line(s, {0, 0, 0, gamma / 2 / steps, 0, 0}, 1, strain, flow);
        strain += flow.strain;
        work += flow.work;
    }
    // gamma = tau/mu + sqrt 3 eps_p, sqrt 3 tau = sy + H eps_p
    const double H = 1e9, mu = moduli.mu, exact = (gamma - sy / std::sqrt(3.) / mu) /
                                                  (std::sqrt(3.) + H / std::sqrt(3.) / mu);
    CHECK(strain == Approx(exact).epsilon(1e-12));
    CHECK(std::sqrt(3.) * s.xy == Approx(sy + H * exact).epsilon(1e-12));
    CHECK(work == Approx(sy * exact + H / 2 * exact * exact).epsilon(1e-3));  // its first step
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

Case metal_block(const Kind& kind) {
    BlockCase block{{1, 1, 2}, {2, 2, 4}, 1e9, 0.3, 1000, kind.element, kind.cells};
    Case c = block.settings();
    c.fem.material[0].kind = MaterialKind::j2;
    c.fem.material[0].yield_stress = 1e6;
    c.fem.material[0].hardening = 2e7;
    c.fem.support = {{"zmin", {"z"}}, {"xmin", {"x"}}, {"ymin", {"y"}}};
    return c;
}

TEST_CASE("a bar that is pulled slowly hardens as its law says, whatever the element") {
    const Kind kind = kinds[GENERATE(0, 1, 2)];
    Case c = metal_block(kind);
    // so slowly that damping, which bears alpha rho v L/2 of the load, is 0.1 % of it
    c.fem.traction = {{"zmax", {0, 0, 1.2e6}, 15}};
    c.fem.damping_alpha = 220;
    Structure s(build_model(c), 1);
    const double dt = s.stable_step().dt;
    march(s, dt, int(18 / dt));
    const std::vector<double> strain = s.elements().plastic_strain(), stress = s.elements().stress();
    double low = 1e300, high = 0;
    for (double e : strain) low = std::min(low, e), high = std::max(high, e);
    const double exact = (1.2e6 * 1.01 - 1e6) / 2e7;  // 1 %: the section shrinks as it flows
    WARN(kind.name << ": plastic strain " << low << " to " << high << ", law " << exact);
    CHECK(low == Approx(exact).epsilon(0.02));
    CHECK(high == Approx(exact).epsilon(0.02));
    CHECK(stress[2] == Approx(1e6 + 2e7 * strain[0]).epsilon(1e-3));
}

TEST_CASE("metal that yields under a blow closes its energy balance, whatever the element") {
    const Kind kind = kinds[GENERATE(0, 1, 2)];
    Case c = metal_block(kind);
    c.fem.support.push_back({"zmin", {"x", "y", "z"}});
    c.fem.pressure = {{"zmax", 1.5e6, 0.002}};
    Structure s(build_model(c), 1);
    const double dt = 0.5 * s.stable_step().dt;
    Energies e;
    march(s, dt, int(0.02 / dt), [&](int) { e = s.energies(); });
    WARN(kind.name << ": plastic " << e.plastic << " J, stored " << e.internal << " J, hourglass "
                   << e.hourglass << " J, balance error over both "
                   << e.balance_error() / (e.internal + e.plastic));
    CHECK(e.plastic > e.internal);
    CHECK(std::abs(e.balance_error()) < 1e-5 * (e.internal + e.plastic));
    CHECK(e.hourglass < 0.05 * e.plastic);
}

}  // namespace
}  // namespace undertow::fem
