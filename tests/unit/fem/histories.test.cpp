// [[fem.history]]: section forces against equilibrium, and the files.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "fem_solver/output.hpp"
#include "support.hpp"
#include "two_solids.hpp"
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

TEST_CASE("materials in other units are doubted under the earth's gravity, and no real one is") {
    BlockCase block{{1, 0.2, 0.2}, {2, 1, 1}};
    Case c = block.settings();
    c.info.gravity = {0, 0, -9.81};
    FemMaterial& m = c.fem.material[0];
    const auto remarks = [&](double density, double young_modulus) {
        m.density = density, m.young_modulus = young_modulus;
        return build_model(c).mesh.remarks;
    };
    CHECK(remarks(7850, 2.1e11).empty());
    CHECK(remarks(15, 1e3).empty());           // foam
    CHECK(remarks(7.85, 2.1e11).size() == 1);  // g/cm3
    REQUIRE(remarks(1.1, 1.2e7).size() == 1);
    CHECK_THAT(remarks(1.1, 1.2e7)[0], Catch::Contains("density = 1.1 is that of a gas"));
    REQUIRE(remarks(1100, 12).size() == 1);
    CHECK_THAT(remarks(1100, 12)[0], Catch::Contains("young_modulus = 12 is less than any solid"));
    CHECK(remarks(7850, 2.1e14).size() == 1);
    c.info.gravity = {0, 0, -1};
    CHECK(remarks(1.1, 12).empty());
}

TEST_CASE("a probe outside of the mesh is told, one on its border or within is not") {
    BlockCase block{{1, 0.2, 0.2}, {10, 3, 3}};
    Case c = block.settings();
    c.fem.probe = {
        {"edge", {1, 0.2, 0.2}}, {"within", {0.51, 0.1, 0.1}}, {"rounded", {1.001, 0, 0}}};
    CHECK(build_model(c).mesh.remarks.empty());
    c.fem.probe.push_back({"millimeters", {1000, 100, 100}});
    const std::vector<std::string> remarks = build_model(c).mesh.remarks;
    REQUIRE(remarks.size() == 1);
    CHECK_THAT(remarks[0], Catch::Contains("\"millimeters\" lies 1.01e+03 m outside of the mesh") &&
                               Catch::Contains("(1, 0.2, 0.2) m"));
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

/// Columns of the rows of a history file.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<std::vector<double>> rows;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || (!std::isdigit(static_cast<unsigned char>(line[0])))) continue;
        std::vector<double>& row = rows.emplace_back();
        std::istringstream fields(line);
        for (std::string field; std::getline(fields, field, ',');)
            row.push_back(std::stod(field));
    }
    return rows;
}

TEST_CASE("a contact's history is its normal force, its friction and how many nodes touch and slip") {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("undertow-sole-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    Case c = two_solids(1e7, 2000);
    Mesh mesh;
    add_block(mesh, "floor", {{-2, -1, -0.2}, {2, 1, -0.01}}, {2, 1, 1});
    add_block(mesh, "block", {{-0.2, -0.2, 0}, {0.2, 0.2, 0.2}}, {2, 2, 1});
    c.fem.part = {{"floor", "steel"}, {"block", "soil"}};
    c.fem.rigid = {{"floor", "floor", {}, 0, {}}};
    c.fem.contact = {{"sole", "block.zmin", "floor.zmax", 0.3, 0, 0, 0.01}};
    FemHistory sole;
    sole.name = "sole";
    sole.kind = FemHistoryKind::contact;
    sole.contact = "sole";
    c.fem.history = {sole};
    c.info.gravity = {0, 0, -10};
    c.time.end = 1;
    Structure s(build_model(c, mesh), 1);
    settle(s, {1e-6, 20000});
    for (std::size_t n = 0; n < s.nodes().size(); ++n)  // slides as a whole
        if (s.nodes().inverse_mass[n].c[0] > 0) s.nodes().v[n].c[0] = 1;
    {
        Output output(folder.string(), c, s);
        const double dt = 0.5 * s.stable_step().dt;
        for (int n = 0; n < 20; ++n) {
            s.internal_forces();
            s.kick(dt);
            output.history(n * dt, s);
            s.drift(dt);
        }
        output.last_history(20 * dt, s);
    }
    const auto rows = rows_of(folder / "fem.history.sole.csv");
    REQUIRE(rows.size() >= 2);
    REQUIRE(rows.back().size() == 10);  // t, normal, f, t, touching, slipping
    const std::vector<double>& row = rows.back();
    const double weight = 2000 * 0.4 * 0.4 * 0.2 * 10;
    CHECK(row[1] == Approx(weight).epsilon(0.02));
    CHECK(row[4] == Approx(weight).epsilon(0.02));  // of the floor on the block, upward
    CHECK(row[2] == Approx(-0.3 * row[1]).epsilon(1e-6));
    CHECK(row[5] == Approx(row[2]).epsilon(1e-9));  // friction is all there is along x
    CHECK(row[8] == 9);
    CHECK(row[9] == 1);
    std::filesystem::remove_all(folder);
}

TEST_CASE("sections are measured only when a row is due, and those rows are the same") {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("undertow-due-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    BlockCase block{{1, 0.2, 0.2}, {10, 2, 2}};
    Case c = block.settings();
    c.time.end = 1;
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.traction = {{"xmax", {0, 0, -1e3}, 0}};
    c.fem.history = {section({0.5, 0.1, 0.1}, Vec3{1, 0, 0})};
    c.fem.history[0].every = 0.01;
    std::vector<std::vector<double>> rows[2];
    int measured = 0;
    for (const bool always : {true, false}) {
        Structure s(build_model(c), 1);
        {
            Output output(folder.string(), c, s);
            const double dt = 2e-5;
            for (int n = 0; n < 1200; ++n) {
                const double t = n * dt;
                s.measure_sections(always || output.section_due(t));
                measured += s.sections_are_measured() && !always;
                s.internal_forces();
                s.pressure_forces(t);
                s.kick(dt);
                output.history(t, s);
                s.drift(dt);
            }
            s.measure_sections(always);
            output.last_history(1200 * dt, s);
        }
        rows[always] = rows_of(folder / "fem.history.cut.csv");
    }
    CHECK(measured == 3);
    REQUIRE(rows[0].size() == 3);
    REQUIRE(rows[1].size() == 4);  // the last one was not measured when nothing was due
    for (int r = 0; r < 3; ++r) CHECK(rows[0][r] == rows[1][r]);
    CHECK(rows[0][2][3] != 0);
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
