// The loop: alone against theory and files, coupled against a host that plays the coupler.

#include "fem_solver/solver.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "support.hpp"
#include "wire/errors.hpp"
#include "wire/host.hpp"

namespace undertow::fem {
namespace {

struct RunFolder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("undertow-fem-" + std::to_string(::getpid()));
    RunFolder() {
        std::filesystem::create_directories(path);
        std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    }
    ~RunFolder() { std::filesystem::remove_all(path); }
    std::string string() const { return path.string(); }
    std::string read(const char* name) const {
        std::ifstream file(path / name);
        return std::string(std::istreambuf_iterator<char>(file), {});
    }
};

Case falling_block() {
    BlockCase block{{0.1, 0.1, 0.1}, {2, 2, 2}};
    Case c = block.settings();
    c.info.name = "falling";
    c.info.gravity = {0, 0, -9.81};
    c.time.end = 0.02;
    c.output.fields_every = 0.005;
    c.fem.probe = {{"corner", {0.1, 0.1, 0.1}}};
    return c;
}

bool run(const Case& c, const RunFolder& folder, Structure& structure, Link& link) {
    Output output(folder.string(), c, structure);
    ProgressLine line(true, "");
    return Solver(c, structure, link, output, line).run();
}

TEST_CASE("a block that nothing holds falls g t^2/2, and the files say so") {
    const RunFolder folder;
    const Case c = falling_block();
    Structure structure(build_model(c), 1);
    const auto link = run_alone(c);
    CHECK(run(c, folder, structure, *link));
    // leapfrog is exact for constant acceleration
    CHECK(structure.displacement(0)[2] == Approx(-0.5 * 9.81 * 0.02 * 0.02).epsilon(1e-10));
    CHECK(structure.velocity(0)[2] == Approx(-9.81 * 0.02).epsilon(1e-10));
    // 1/2 m v^- v^+ begins at -m (g dt)^2/8 and not at 0: a constant offset of second order in dt
    const double dt = structure.stable_step().dt;
    CHECK(std::abs(structure.energies().balance_error()) < 1.01 / 8 * std::pow(9.81 * dt, 2));
    const std::string history = folder.read("fem.history.csv");
    CHECK(history.find("corner.uz [m]") != std::string::npos);
    CHECK(history.find("\n0.02,") != std::string::npos);  // the end is recorded
    CHECK(folder.read("energy.fem.csv").find("balance error [J]") != std::string::npos);
    CHECK(folder.read("summary.fem.json").find("\"complete\": true") != std::string::npos);
    CHECK(std::filesystem::exists(folder.path / "fem.vtkhdf"));
}

TEST_CASE("soil brings its columns and its field, a far field its energy; others have none of it") {
    const RunFolder folder;
    Case c = falling_block();
    c.time.end = 0.01;
    const bool soil = GENERATE(true, false);
    if (soil) {
        c.fem.material[0].kind = MaterialKind::tresca;
        c.fem.material[0].shear_strength = 1e3;
        c.fem.geostatic = FemGeostatic{"block", 0.1, 1};
        c.fem.absorbing = {{"zmin"}};
        c.fem.pressure = {{"zmax", 4e3, 0.001}};  // twice what it can bear
    }
    Structure structure(build_model(c), 1);
    const auto link = run_alone(c);
    CHECK(run(c, folder, structure, *link));
    CHECK((structure.yielding_elements() > 0) == soil);
    const std::string energy = folder.read("energy.fem.csv");
    CHECK((energy.find(",plastic [J],far field [J],external work [J]") != std::string::npos) ==
          soil);
    const std::string history = folder.read("fem.history.csv");
    CHECK((history.find("yielding elements") != std::string::npos) == soil);
    CHECK((folder.read("fem.xdmf").find("plastic_strain") != std::string::npos) == soil);
    const Energies e = structure.energies();
    CHECK((e.plastic > 0 && e.far_field > 0) == soil);
    CHECK(std::abs(e.balance_error()) < 0.01 * (e.kinetic + e.plastic + e.far_field));
}

TEST_CASE("a load far too large ends in a sentence that names element and time") {
    const RunFolder folder;
    Case c = falling_block();
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 1e12, 0}};
    Structure structure(build_model(c), 1);
    const auto link = run_alone(c);
    CHECK_THROWS_WITH(
        run(c, folder, structure, *link),
        Catch::Contains("t = ") && (Catch::Contains("hexahedron") || Catch::Contains("node")));
    CHECK(folder.read("summary.fem.json").find("\"complete\": false") != std::string::npos);
}

TEST_CASE("coupled, the solver takes the steps and forces it is given") {
    const RunFolder folder;
    Case c = falling_block();
    c.info.gravity = {0, 0, 0};
    c.fem.surface = {{"roof", "zmax"}};
    const int steps = 50;
    const double dt = 1e-6, force = 2.0;  // [N] per node of the roof
    double end = 0;
    wire::HostOptions options;
    options.endpoint = "ipc://" + folder.string() + "/host.sock";
    options.expected_roles = {"surface"};
    options.join_timeout = options.deadline = 20;
    options.welcome.contact_share = 0.45;
    options.welcome.deadline = 20;
    wire::Host host(options);
    std::string limiter, trouble;
    std::thread coupler([&] {
        try {
            host.wait_join();
            const auto meshes = host.wait_meshes();
            const std::size_t n_nodes = meshes.at(0).at(0).mass.size();
            for (int n = 0;; ++n) {
                const wire::Received received = host.next();
                const auto& state = std::get<wire::State>(received.message);
                limiter = state.limiter;
                if (n == steps) break;
                wire::Force answer;
                answer.n = n;
                answer.dt = dt;
                answer.t1 = (n + 1) * dt;
                answer.limiter = "test";
                answer.f.assign(3 * n_nodes, 0.0);
                for (std::size_t i = 0; i < n_nodes; ++i) answer.f[3 * i + 2] = force;
                host.send(0, answer);
            }
            host.finish(steps, "done");
        } catch (const std::exception& error) {
            trouble = error.what();
        }
    });
    Structure structure(build_model(c), 1);
    try {
        const auto link = join_coupler(c, host.endpoint());
        CHECK(run(c, folder, structure, *link));
    } catch (const std::exception& error) {
        FAIL_CHECK(error.what());
    }
    coupler.join();
    CHECK(trouble.empty());
    CHECK_THAT(limiter, Catch::Contains("hexahedron") && Catch::Contains("of block"));
    // momentum = impulse: v^{n+1/2} of the last, closing kick includes half a step beyond t_end
    double momentum = 0;
    const Nodes& nodes = structure.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) momentum += nodes.mass[n] * nodes.v[n].c[2];
    end = (steps + 0.5) * dt;
    CHECK(momentum == Approx(9 * force * end).epsilon(1e-9));
    CHECK(structure.energies().contact > 0);
    // Under a sudden load 1/2 m v^- v^+ begins at minus the energy of the first half kick, not at
    // 0: a constant offset of second order in dt.
    double offset = 0;
    for (std::int32_t n : structure.model().surface.node)
        offset += 0.5 * std::pow(0.5 * dt * force, 2) / nodes.mass[n];
    CHECK(structure.energies().balance_error() == Approx(-offset).epsilon(0.01));
}

TEST_CASE("a cfl that leaves no room for contact is refused before the first step") {
    const RunFolder folder;
    Case c = falling_block();
    c.fem.surface = {{"roof", "zmax"}};
    c.fem.cfl = 0.98;  // 2/3 of 4 (1 - 0.98^2) = 0.106 < 0.45
    wire::HostOptions options;
    options.endpoint = "ipc://" + folder.string() + "/host.sock";
    options.expected_roles = {"surface"};
    options.join_timeout = 20;
    options.welcome.contact_share = 0.45;
    wire::Host host(options);
    std::thread coupler([&] {
        try {
            host.wait_join();
        } catch (const std::exception&) {
        }
    });
    CHECK_THROWS_WITH(join_coupler(c, host.endpoint()),
                      Catch::Contains("fem.cfl = 0.98") && Catch::Contains("0.91"));
    coupler.join();
}

}  // namespace
}  // namespace undertow::fem
