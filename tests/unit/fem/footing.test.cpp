// A limit load: the strip footing on clay, against Prandtl's (2 + pi) s_u.

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"

namespace undertow::fem {
namespace {

struct LimitLoad {
    double Nc;         // mean pressure over s_u at the end
    double hourglass;  // hourglass over plastic energy
    double kinetic;    // kinetic over plastic energy
};

/// Half of a smooth rigid strip of half width 1 m, pressed down 10 mm into clay without weight,
/// slowly (1e-4 of the shear wave speed); `n` elements along the half width. E = 5000 s_u, so that
/// the limit is reached before the shape changes.
LimitLoad strip_footing(int n, ElementFormulation element = ElementFormulation::automatic,
                        BlockCells cells = BlockCells::hexahedra) {
    const double su = 1e4, b = 1, h = b / n;
    Case c = BlockCase{{5, h, 3}, {5 * n, 1, 3 * n}, 5000 * su, 0.49, 1846}.settings();
    c.fem.block->box = {{0, 0, -3}, {5, h, 0}};
    c.fem.block->cells = cells;
    c.fem.part[0].element = element;
    c.info.dimension = 2;
    c.info.thickness = h;
    c.fem.material[0].kind = MaterialKind::tresca;
    c.fem.material[0].shear_strength = su;
    c.fem.support = {{"zmin", {"x", "y", "z"}}, {"xmin", {"x"}}, {"xmax", {"x"}}};
    c.fem.bulk_viscosity_linear = 0.06;
    c.fem.bulk_viscosity_quadratic = 1.2;
    Structure s(build_model(c), 1);
    Nodes& nodes = s.nodes();
    std::vector<std::int32_t> footing;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes.x0[i].c[2] > -1e-9 && nodes.x0[i].c[0] < b + 1e-9)
            footing.push_back(std::int32_t(i));
    for (std::int32_t i : footing) nodes.inverse_mass[i].c[2] = 0;
    const double speed = 1e-4 * std::sqrt(5000 * su / 2.98 / 1846), dt = s.stable_step().dt;
    const int steps = int(0.0105 / (speed * dt));
    double sum = 0;
    int summed = 0;
    LimitLoad out{};
    for (int k = 0; k < steps; ++k) {
        for (std::int32_t i : footing) nodes.v[i].c[2] = -speed * std::min(1.0, 10.0 * k / steps);
        s.internal_forces();
        if (k > 0.9 * steps) {
            for (std::int32_t i : footing) sum += nodes.f[i].c[2];  // upward
            ++summed;
        }
        s.kick(dt);
        const Energies e = s.energies();
        out.hourglass = e.hourglass / e.plastic;
        out.kinetic = e.kinetic / e.plastic;
        s.drift(dt);
    }
    // the outermost held node carries half an element beyond the edge
    out.Nc = sum / summed / (h * (b + h / 2)) / su;
    return out;
}

TEST_CASE("a strip footing gives way at (2 + pi) s_u, and hourglass stresses add nothing to it") {
    const double prandtl = 2 + std::acos(-1.0);
    const LimitLoad coarse = strip_footing(4), fine = strip_footing(8);
    WARN("strip footing, Nc over 2 + pi: 4 elements on the half width "
         << coarse.Nc / prandtl << ", 8: " << fine.Nc / prandtl
         << "; hourglass over plastic energy " << coarse.hourglass << ", " << fine.hourglass
         << "; kinetic " << fine.kinetic);
    // 1.007, 1.012 (16 elements: 1.014), of which 1 % comes from 10 mm of settlement (slope of the
    // curve)
    CHECK(fine.Nc == Approx(prandtl).epsilon(0.025));
    CHECK(std::abs(fine.Nc - coarse.Nc) < 0.02 * prandtl);
    // Work of the stress that varies within an element: halves with the element, 4.1 and 2.1 %.
    // Where hourglass stresses do not flow it is 6 %, and the limit load 15 % too high.
    CHECK(fine.hourglass < 0.03);
    CHECK(fine.hourglass < 0.6 * coarse.hourglass);
    CHECK(fine.kinetic < 1e-3);
}

TEST_CASE("8-point hexahedra and tetrahedra find the footing's limit load as well") {
    const double prandtl = 2 + std::acos(-1.0);
    const LimitLoad eight = strip_footing(4, ElementFormulation::b_bar),
                    four = strip_footing(4, ElementFormulation::averaged_pressure,
                                         BlockCells::tetrahedra);
    WARN("strip footing, 4 cells on the half width, Nc over 2 + pi: 8-point hexahedra "
         << eight.Nc / prandtl << ", tetrahedra " << four.Nc / prandtl);
    CHECK(eight.Nc == Approx(prandtl).epsilon(0.025));
    CHECK(four.Nc == Approx(prandtl).epsilon(0.05));
    CHECK(eight.hourglass == 0);
}

}  // namespace
}  // namespace undertow::fem
