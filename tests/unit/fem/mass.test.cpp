// Masses that the material does not have: on nodes, and by mass scaling.

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "fem_solver/setup/block_mesh.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

double inertia_of(const Structure& structure) {
    const std::vector<double>& mass = structure.nodes().mass;
    return std::accumulate(mass.begin(), mass.end(), 0.0);
}
double weight_of(const Structure& structure) {  // [kg]
    double sum = 0;
    for (std::size_t n = 0; n < structure.nodes().size(); ++n)
        sum += structure.nodes().mass[n] * structure.nodes().weight_share[n];
    return sum;
}

TEST_CASE("a bar with its own mass on its end swings at the frequency of x tan x = 1") {
    BlockCase block{{2, 0.1, 0.1}, {40, 1, 1}};
    block.poisson_ratio = 0;
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.mass = {{.set = "xmax", .point = {}, .mass = block.density * 0.02}};
    Structure structure(build_model(c), 1);
    CHECK(inertia_of(structure) == Approx(40).epsilon(1e-13));
    // the first mode, sin(x s/L), at its largest speed
    const double x = 0.860333589019380, c0 = std::sqrt(block.young_modulus / block.density);
    for (std::size_t n = 0; n < structure.nodes().size(); ++n)
        structure.nodes().v[n].c[0] = 1e-3 * std::sin(x * structure.nodes().x[n].c[0] / 2);
    const std::int32_t end = nearest_node(structure.model().mesh, {2, 0, 0});
    const double dt = 0.5 * structure.stable_step().dt;
    double before = 0, last = 0, started = 0;
    Energies e;
    int crossings = 0;
    march(structure, dt, 20000, [&](int n) {
        e = structure.energies();
        if (n == 1) started = e.balance_error();  // all that moved then
        const double u = structure.displacement(end)[0];
        if (before > 0 && u <= 0 && ++crossings) last = (n - u / (u - before)) * dt;
        before = u;
    });
    // downward zeros of sin(omega t): half a period, then whole ones
    const double omega = 2 * std::acos(-1.0) * (crossings - 0.5) / last;
    INFO(crossings << " periods");
    CHECK(omega == Approx(x * c0 / 2).epsilon(3e-4));  // 40 elements: (x/80)^2/6 and the lumped end
    CHECK(std::abs(e.balance_error() - started) < 1e-6 * (e.kinetic + e.internal));
}

TEST_CASE("point masses weigh, and lengthen the step of a light element") {
    BlockCase block{{1, 1, 1}, {1, 1, 1}};
    Case c = block.settings();
    c.info.gravity = {0, 0, -10};
    const double alone = Structure(build_model(c), 1).stable_step().dt;
    c.fem.mass = {{.set = "block", .point = {}, .mass = 3000}};
    Structure structure(build_model(c), 1);
    CHECK(structure.stable_step().dt == Approx(2 * alone).epsilon(0.011));  // 1 % for Lanczos
    CHECK(weight_of(structure) == Approx(4000));
    const double dt = structure.stable_step().dt;
    double started = 0;
    Energies e;
    march(structure, dt, 100, [&](int n) {  // falls free, as anything does
        e = structure.energies();           // in the end at 99 dt
        if (n == 1) started = e.balance_error();
    });
    CHECK(e.external == Approx(4000 * 10 * 0.5 * 10 * std::pow(99 * dt, 2)).epsilon(1e-9));
    CHECK(std::abs(e.balance_error() - started) < 1e-9 * e.external);

    c.fem.mass = {{.set = {}, .point = {1, 1, 1}, .mass = 5}};
    CHECK(inertia_of(Structure(build_model(c), 1)) == Approx(1005));
    c.fem.rigid = {{.name = "stone", .set = "block"}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("fem.mass at (1, 1, 1) m") &&
                                          Catch::Contains("rigid body \"stone\""));
}

/// Eight layers along z, one of them a tenth as high as the others.
Mesh with_a_thin_layer(const BlockCase& block) {
    Mesh mesh = make_block(FemBlock{{{0, 0, 0}, block.size}, block.divisions, {}, block.cells});
    const double h = block.size[2] / block.divisions[2];
    for (Vec3& x : mesh.x)
        if (std::abs(x[2] - 4 * h) < 1e-9) x[2] -= 0.9 * h;
    return mesh;
}

double sag_at_rest(const Case& c, const Mesh& mesh, double& step) {
    Structure structure(build_model(c, mesh), 1);
    step = structure.stable_step().dt;
    march(structure, step, int(0.25 / step));
    return structure.displacement(nearest_node(mesh, {0.5, 0.5, 4}))[2];
}

TEST_CASE("mass scaling brings the step that was asked for and leaves weight and statics alone") {
    const BlockCells cells = GENERATE(BlockCells::hexahedra, BlockCells::tetrahedra);
    BlockCase block{{0.5, 0.5, 4}, {1, 1, 8}};
    block.cells = cells;
    block.young_modulus = 1e8;  // strains of 4e-4: what is left of the path is below 1e-6
    Case c = block.settings();
    c.info.gravity = {0, 0, -10};
    c.fem.support = {{"zmin", {"z"}}, {"block", {"x", "y"}}};  // no slow swaying
    c.fem.damping_alpha = 250;  // twice the first frequency
    const Mesh mesh = with_a_thin_layer(block);
    double plain_step = 0, scaled_step = 0;
    const double plain = sag_at_rest(c, mesh, plain_step);
    const Structure unscaled(build_model(c, mesh), 1);
    const double wanted = 2 * 2 * c.fem.cfl / unscaled.omega_bound();  // twice what elements allow
    c.fem.mass_scaling = wanted;
    const double scaled = sag_at_rest(c, mesh, scaled_step);
    CHECK(scaled_step >= wanted);
    CHECK(scaled_step > 1.1 * plain_step);  // neighbors had softened the thin layer before
    CHECK(scaled == Approx(plain).epsilon(1e-5));

    const Structure structure(build_model(c, mesh), 1);
    const std::vector<ScaledPart>& report = structure.model().mass_scaling;
    REQUIRE(report.size() == 1);
    CHECK(report[0].part == "block");
    CHECK(report[0].mass == Approx(1000).epsilon(1e-12));
    CHECK(report[0].added > 1);
    CHECK(report[0].elements < mesh.n_elements());
    CHECK(inertia_of(structure) == Approx(1000 + report[0].added).epsilon(1e-12));
    CHECK(weight_of(structure) == Approx(1000).epsilon(1e-12));
}

TEST_CASE("mass scaling of shells makes their turning heavier as well") {
    BlockCase block{{1, 1, 0}, {4, 4, 0}};
    block.cells = BlockCells::shells;
    block.element = ElementFormulation::shell;
    Case c = block.settings();
    c.fem.part[0].thickness = 0.01;
    const double plain = Structure(build_model(c), 1).stable_step().dt;
    c.fem.part[0].mass_factor = 4;
    Structure structure(build_model(c), 1);
    CHECK(structure.stable_step().dt == Approx(2 * plain).epsilon(1e-6));
    CHECK(structure.model().mass_scaling[0].added == Approx(30));
    CHECK(weight_of(structure) == Approx(10));
    c.fem.part[0].mass_factor = 1;
    c.fem.mass_scaling = 2 * plain;
    Structure to_step(build_model(c), 1);
    CHECK(to_step.stable_step().dt >= 2 * plain);
    CHECK(to_step.stable_step().dt < 2.3 * plain);
}

TEST_CASE("mass scaling is refused where it has no use") {
    BlockCase block;
    Case c = block.settings();
    c.time.max_step = 1e-4;
    c.fem.part[0].mass_factor = 2;
    c.fem.part[0].implicit = true;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("implicit part, which limits no step"));
    c.fem.part[0].mass_factor = 1;
    c.fem.mass_scaling = 1e-3;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("fem.mass_scaling has no use"));
    c.fem.part[0].implicit = false;
    c.fem.rigid = {{.name = "stone", .set = "block"}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("fem.mass_scaling has no use"));
    c.fem.mass_scaling.reset();
    c.fem.part[0].mass_factor = 2;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("rigid body, which limits no step"));
}

}  // namespace
}  // namespace undertow::fem
