// Strength that grows with depth: where a column yields, how stiff it is, what else has to know.

#include "fem_solver/materials/depth.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "support.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

constexpr double s0 = 2e3, gradient = 1.5e3, level = -1;  // [Pa], [Pa/m], [m]
constexpr double young = 5e6, nu = 0.49;

double strength(double z) {
    return s0 + gradient * std::max(0.0, level - z);
}

/// A column of clay 8 m deep, its top at z = 0.
Case column(std::array<int, 3> divisions = {2, 2, 8}) {
    Case c = BlockCase{{1, 1, 8}, divisions, young, nu, 1800}.settings();
    c.fem.block->box = {{0, 0, -8}, {1, 1, 0}};
    FemMaterial& clay = c.fem.material[0];
    clay.kind = MaterialKind::tresca;
    clay.shear_strength = s0;
    clay.strength_gradient = gradient;
    clay.strength_level = level;
    return c;
}

struct Kind {
    ElementFormulation element;
    BlockCells cells;
};
const Kind kinds[] = {{ElementFormulation::one_point, BlockCells::hexahedra},
                      {ElementFormulation::b_bar, BlockCells::hexahedra},
                      {ElementFormulation::averaged_pressure, BlockCells::tetrahedra}};

void choose(Case& c, const Kind& kind) {
    c.fem.part[0].element = kind.element;
    c.fem.block->cells = kind.cells;
}

/// Every node is led so that the whole column shears alike, by `shear` in all.
void lead(Structure& s, double shear) {
    constexpr int steps = 400;
    const double dt = 1e-5;
    for (int n = 0; n <= steps; ++n) {
        s.internal_forces();
        for (std::size_t i = 0; i < s.nodes().size(); ++i)
            s.nodes().v[i] = {{shear / (steps * dt) * (s.nodes().x0[i].c[2] + 8), 0, 0, 0}};
        if (n < steps) s.drift(dt);
    }
}

TEST_CASE("a sheared column yields down to where its strength reaches the shear stress") {
    const double mu = young / (2 * (1 + nu)), deepest = 5, shear = strength(-deepest) / mu;
    for (const Kind& kind : kinds) {
        Case c = column();
        choose(c, kind);
        Structure s(build_model(c), 1);
        lead(s, shear);
        const std::vector<double> stress = s.elements().stress(),
                                  flow = s.elements().plastic_strain();
        double worst = 0;
        for (std::size_t e = 0; e < s.elements().size(); ++e) {
            const double z = height_of(s.model().mesh, e);
            const double expected = std::min(mu * shear, strength(z));
            worst = std::max(worst, std::abs(stress[6 * e + 5] / expected - 1));
            CHECK(s.model().strength[e] == Approx(strength(z)).epsilon(1e-14));
            // equivalent plastic strain of simple shear: (shear - s/mu)/sqrt 3
            CHECK(flow[e] == Approx((shear - expected / mu) / std::sqrt(3.0)).margin(1e-3 * shear));
        }
        WARN("column of " << int(kind.element) << ": largest error of the shear stress " << worst);
        // the Jaumann rate turns the stress by half of the shear, 0.003: its square
        CHECK(worst < 2e-5);
    }
}

TEST_CASE(
    "stiffness in proportion to strength: all depths are strained alike, and the step follows") {
    constexpr double ratio = 500;
    for (const Kind& kind : kinds) {
        Case c = column();
        choose(c, kind);
        c.fem.material[0].modulus_ratio = ratio;
        c.fem.material[0].young_modulus = ratio * s0;
        Structure s(build_model(c), 1);
        // the deepest element is the stiffest: its bound is that of a column as stiff as it is
        double deepest = 0;
        for (std::size_t e = 0; e < s.elements().size(); ++e)
            deepest = std::min(deepest, height_of(s.model().mesh, e));
        Case stiff = c;
        stiff.fem.material[0].kind = MaterialKind::linear_elastic;
        stiff.fem.material[0].young_modulus = ratio * strength(deepest);
        Structure uniform(build_model(stiff), 1);
        CHECK(s.elements().omega2_start() ==
              Approx(uniform.elements().omega2_start()).epsilon(1e-12));
        CHECK(s.elements().largest_wave_speed() ==
              Approx(uniform.elements().largest_wave_speed()).epsilon(1e-12));

        // 0.8 s_u everywhere; upper points of a b_bar element are weaker than its center, down to 0.84
        const double shear = 1.6 * (1 + nu) / ratio;
        lead(s, shear);
        const std::vector<double> stress = s.elements().stress();
        double worst = 0;
        for (std::size_t e = 0; e < s.elements().size(); ++e) {
            const double z = height_of(s.model().mesh, e);
            worst = std::max(worst, std::abs(stress[6 * e + 5] / (0.8 * strength(z)) - 1));
            CHECK(s.elements().plastic_strain()[e] == 0);
        }
        CHECK(worst < 2e-5);
    }
}

TEST_CASE(
    "a column of growing stiffness that swings, twists and yields keeps its balance of energy") {
    for (const Kind& kind : kinds) {
        Case c = column({2, 2, 6});
        choose(c, kind);
        c.fem.material[0].modulus_ratio = 500;
        c.fem.support = {{"zmin", {"x", "y", "z"}}};
        Structure s(build_model(c), 1);
        Nodes& nodes = s.nodes();
        double start = 0;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (int d = 0; d < 3; ++d) {
                if (nodes.inverse_mass[i].c[d] == 0) continue;
                nodes.v[i].c[d] = 0.5 * std::sin(5.0 * double(i) + d);
                start += 0.5 * nodes.mass[i] * nodes.v[i].c[d] * nodes.v[i].c[d];
            }
        march(s, 0.9 * s.stable_step().dt, 3000);
        const Energies e = s.energies();
        WARN("column of " << int(kind.element) << ": balance "
                          << (e.balance_error() - start) / start << " of the start, plastic "
                          << e.plastic / start);
        CHECK(e.plastic > 0.05 * start);
        CHECK(std::abs(e.balance_error() - start) < 1e-3 * start);
    }
}

TEST_CASE("a strength that stays the same gives the bits of the law without depth") {
    for (const Kind& kind : kinds) {
        Case c = column({3, 2, 5});
        choose(c, kind);
        c.fem.support = {{"zmin", {"x", "y", "z"}}};
        c.fem.pressure = {{"zmax", 8e3, 0}};
        const auto end = [&](bool packed) {
            FemMaterial& clay = c.fem.material[0];
            clay.strength_gradient.reset();
            if (packed) clay.strength_gradient = gradient, clay.strength_level = -100;
            Structure s(build_model(c), 1);
            march(s, 0.5 * s.stable_step().dt, 400);
            CHECK(s.energies().plastic > 0);
            return s.nodes().x;
        };
        const NodeRows plain = end(false), local = end(true);
        if (kind.cells == BlockCells::tetrahedra) {  // patches of packed laws average their stress
            double far = 0;
            for (std::size_t i = 0; i < plain.size(); ++i)
                far = std::max(far, std::abs(plain[i].c[2] - local[i].c[2]));
            CHECK(far < 1e-10);
        } else {
            CHECK(std::memcmp(plain.data(), local.data(), plain.size() * sizeof(NodeRow)) == 0);
        }
    }
}

TEST_CASE(
    "cohesion that grows with depth: with phi = 0 it is Tresca, with phi > 0 its cone moves") {
    Case c = column({1, 1, 6});
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 9e3, 0}};
    const auto end = [&] {
        Structure s(build_model(c), 1);
        march(s, 0.5 * s.stable_step().dt, 400);
        CHECK(s.energies().plastic > 0);
        return s.elements().stress();
    };
    const std::vector<double> tresca = end();
    FemMaterial& soil = c.fem.material[0];
    soil.kind = MaterialKind::mohr_coulomb;
    soil.cohesion = s0;
    const std::vector<double> coulomb = end();
    for (std::size_t i = 0; i < tresca.size(); ++i)
        CHECK(coulomb[i] == Approx(tresca[i]).margin(1e-6 * s0));

    soil.friction_angle = 30;
    soil.tension_cutoff = 5e3;
    const Model model = build_model(c);
    const double cot = std::sqrt(3.0);
    for (const double z : {-0.5, -2.0, -7.0}) {
        const MohrCoulomb law = std::get<MohrCoulomb>(law_at(model.parts[0].material, z));
        CHECK(law.cohesion == Approx(strength(z) * std::cos(std::acos(-1.0) / 6)).epsilon(1e-14));
        CHECK(law.tension == Approx(std::min(5e3, strength(z) * cot)).epsilon(1e-14));
    }
}

TEST_CASE("ground at rest is held against the strength of its place") {
    Case c = column({1, 1, 8});
    c.info.gravity = {0, 0, -10};
    c.fem.material[0].weight_density = 800;
    // sigma_v - sigma_h = 0.3 x 8 kPa/m: at every depth d less than 2 s = 4 + 3 (d - 1) kPa
    c.fem.geostatic = FemGeostatic{"block", 0, 0.7};
    CHECK_NOTHROW(build_model(c));
    c.fem.material[0].strength_gradient = 900;  // too little for 18 kPa at 7.5 m
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("shear_strength = 7850 Pa") &&
                                          Catch::Contains("z = -7.5 m") &&
                                          Catch::Contains(number_text(18 / 15.7)));
    c.fem.material[0].strength_gradient.reset();
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("shear_strength = 2000 Pa"));
}

TEST_CASE("a strength that ends within the mesh is refused with its place") {
    Case c = column();
    c.fem.material[0].strength_gradient = -500;  // 2 kPa are used up 4 m below the level
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("strength_gradient = -500 Pa/m") &&
                                          Catch::Contains("hexahedron") && Catch::Contains("> 0"));
    c.fem.material[0].strength_gradient = -200;
    CHECK_NOTHROW(build_model(c));
    // nothing at the mud line itself will do, for elements lie below it
    c.fem.material[0].strength_gradient = 1e3;
    c.fem.material[0].shear_strength = 0;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("leaves a strength of 0 Pa"));
    c.fem.material[0].strength_level = 0;
    CHECK_NOTHROW(build_model(c));
}

TEST_CASE("packed laws give the same bits for one and two threads") {
    Case c = column({8, 8, 20});
    c.fem.part[0].element = GENERATE(ElementFormulation::one_point, ElementFormulation::b_bar);
    c.fem.material[0].modulus_ratio = 500;
    Structure s(build_model(c), 1);
    for (std::size_t i = 0; i < s.nodes().size(); ++i)
        s.nodes().v[i].c[0] = std::sin(3.0 * double(i));
    const auto forces = [&](int threads) {
        Structure copy(build_model(c), 1);
        copy.nodes().v = s.nodes().v;
        copy.elements().step(copy.nodes(), 1e-2, threads);
        return copy.nodes().f;
    };
    const NodeRows one = forces(1), two = forces(2);
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(NodeRow)) == 0);
}

}  // namespace
}  // namespace undertow::fem
