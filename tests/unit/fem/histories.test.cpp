// [[fem.history]]: section forces against equilibrium, and the files.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "fem_solver/output.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

FemHistory section(const Vec3& point, std::optional<Vec3> normal, const char* set = "") {
    FemHistory h;
    h.name = "cut";
    h.kind = FemHistoryKind::section;
    h.point = point;
    h.normal = normal;
    h.set = set;
    return h;
}

TEST_CASE(
    "the force through a section is what accelerates and loads the side beyond it, at any time") {
    const ElementFormulation element =
        GENERATE(ElementFormulation::one_point, ElementFormulation::b_bar);
    const double at = GENERATE(0.7, 0.3);  // the side with fewer nodes is the one that is summed
    BlockCase block{{1, 0.2, 0.2}, {10, 3, 3}};
    block.element = element;
    Case c = block.settings();
    c.fem.bulk_viscosity_linear = 0.06;
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.traction = {{"xmax", {2e3, 0, -1e3}, 0.002}};
    c.fem.history = {section({at, 0.1, 0.1}, Vec3{1, 0, 0})};
    Model model = build_model(c);
    distort(model.mesh, block, 0.1);
    Structure s(std::move(model), 1);
    const double dt = s.stable_step().dt;
    march(s, dt, 300);
    // The free body beyond: nodes of its own, and the shared ones, whose mass beyond is not known
    // apart; so the sum over nodes of its own alone: force = -(sum of internal forces there)
    s.internal_forces();
    const Wrench cut = s.model().sections[0].force();
    double on[3] = {}, moment_y = 0;
    for (std::size_t n = 0; n < s.nodes().size(); ++n) {
        const double x0 = s.nodes().x0[n].c[0];
        if (x0 < at + 0.01) continue;
        const double* f = s.nodes().f[n].c;
        for (int d = 0; d < 3; ++d) on[d] -= f[d];
        moment_y -= (s.nodes().x[n].c[2] - 0.1) * f[0] - (s.nodes().x[n].c[0] - at) * f[2];
    }
    CHECK(cut.force[0] == Approx(on[0]).epsilon(1e-9));
    CHECK(cut.force[2] == Approx(on[2]).epsilon(1e-9));
    CHECK(cut.moment[1] == Approx(moment_y).epsilon(1e-9));
}

TEST_CASE("at rest a section carries the load beyond it and its moment") {
    BlockCase block{{1, 0.2, 0.2}, {10, 2, 2}};
    Case c = block.settings();
    c.info.gravity = {0, 0, -9.81};
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.traction = {{"xmax", {0, 0, -1e3}, 0.02}};
    c.fem.damping_alpha = 400;
    c.fem.history = {section({0.5, 0.1, 0.1}, Vec3{1, 0, 0}),
                     section({0.5, 0.1, 0.1}, Vec3{-1, 0, 0})};
    c.fem.history[1].name = "other";
    Structure s(build_model(c), 1);
    march(s, s.stable_step().dt, 8000);
    s.internal_forces();
    const Wrench& cut = s.model().sections[0].force();
    const Wrench& back = s.model().sections[1].force();
    // half of the beam, less the half elements whose mass hangs on the shared nodes
    const double weight = 1000 * 0.04 * 0.45 * 9.81;
    CHECK(cut.force[2] == Approx(-1e3 * 0.04 - weight).epsilon(1e-3));
    CHECK(cut.moment[1] == Approx(1e3 * 0.04 * 0.5 + 1000 * 0.04 * 9.81 * 0.125).epsilon(2e-3));
    // the shared nodes' own weight is carried by neither side alone
    const double shared = 1000 * 0.04 * 0.1 * 9.81;
    CHECK(back.force[2] + cut.force[2] == Approx(shared).epsilon(0.05).margin(1e-6));
}

TEST_CASE("histories are files of their own with what was asked for") {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("undertow-hist-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    BlockCase block{{1, 0.2, 0.2}, {10, 2, 2}};
    Case c = block.settings();
    c.info.gravity = {0, 0, -9.81};
    c.time.end = 1;
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    FemHistory tip, root;
    tip.name = "tip";
    tip.point = {1, 0.09, 0.1};
    tip.every = 0.25;
    root.name = "root";
    root.kind = FemHistoryKind::set;
    root.set = "xmin";
    c.fem.history = {tip, root, section({0.5, 0.1, 0.1}, Vec3{1, 0, 0})};
    Structure s(build_model(c), 1);
    {
        Output output(folder.string(), c, s);
        for (const double t : {0.0, 0.1, 0.25, 0.3}) {
            s.internal_forces();
            s.pressure_forces(t);
            s.kick(1e-5);
            output.history(t, s);
            s.drift(1e-5);
        }
        output.last_history(0.4, s);
    }
    const auto read = [&](const char* name) {
        std::ifstream file(folder / name);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const std::string text = read("fem.history.tip.csv");
    CHECK_THAT(text, Catch::Contains("node at (1, 0.1, 0.1) m, 0.01 m from the point"));
    CHECK_THAT(text, Catch::Contains("\n0.25,") && !Catch::Contains("\n0.1,") &&
                         Catch::Contains("\n0.4,"));
    CHECK_THAT(read("fem.history.root.csv"),
               Catch::Contains("9 nodes of \"xmin\"") && Catch::Contains("rz [N]"));
    CHECK_THAT(read("fem.history.cut.csv"),
               Catch::Contains("through 9 shared nodes") && Catch::Contains("my [N m]"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("a section that cuts nothing is refused") {
    BlockCase block{{1, 0.2, 0.2}, {10, 2, 2}};
    Case c = block.settings();
    c.fem.history = {section({2, 0.1, 0.1}, Vec3{1, 0, 0})};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("fem.history \"cut\"") &&
                                          Catch::Contains("cuts no elements apart"));
}

}  // namespace
}  // namespace undertow::fem
