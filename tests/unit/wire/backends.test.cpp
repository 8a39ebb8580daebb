// The example backends, as processes, against this coupler's end.

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "peers.hpp"

using namespace undertow::wire;

namespace {

pid_t start(const std::vector<std::string>& command) {
    const pid_t child = fork();
    if (child == 0) {
        std::vector<char*> arguments;
        for (const std::string& argument : command) {
            arguments.push_back(const_cast<char*>(argument.c_str()));
        }
        arguments.push_back(nullptr);
        execv(arguments[0], arguments.data());
        _exit(127);
    }
    return child;
}

int exit_code(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Pushes every node with `f` [N] along `axis` in n_steps steps; returns the largest displacement
/// of node 0 along it [m].
double push(Host& host, std::int64_t n_steps, double f, int axis) {
    host.wait_join();
    const std::vector<double> x0 = host.wait_meshes().at(0).at(0).x;
    double t = 0, largest = 0;
    for (std::int64_t n = 0;; ++n) {
        const State state = std::get<State>(host.next().message);
        largest = std::max(largest, state.x[axis] - x0[axis]);
        if (n == n_steps) {
            host.finish(n, "done");
            return largest;
        }
        const double dt = state.dt_limit / 20;
        Force force = force_of(n, t, dt, x0.size() / 3);
        for (std::size_t i = axis; i < x0.size(); i += 3) force.f[i] = f;
        t = force.t1;
        host.send(0, std::move(force));
    }
}

}  // namespace

TEST_CASE("the minimal backend swings to twice the static deflection") {
    const std::string transport = GENERATE("shm", "ipc", "tcp");
    TemporaryFolder folder;
    Host host(options_for(transport, folder, {"surface"}));
    const pid_t child = start({MINIMAL_BACKEND, host.endpoint()});
    // F/k = 2 N / 2e4 N/m; undamped, a step load overshoots to twice that. dt is 0.09/omega, so the
    // sampled peak and the leapfrog are within (omega dt)^2/8 = 0.1 %.
    CHECK(push(host, 200, 2, 2) == Approx(2e-4).epsilon(0.001));
    CHECK(host.shares_memory() == (transport == "shm"));
    CHECK(exit_code(child) == 0);
}

TEST_CASE("the Python spring wall runs with this coupler") {
    TemporaryFolder folder;
    std::ofstream(folder.path / "case.toml")
        << "[backend.spring_wall]\norigin = [0, 0, 0]\nu = [1, 0, 0]\nv = [0, 1, 0]\n"
           "divisions = [1, 1]\nmass = 8.0\nstiffness = 8e6\n";
    const pid_t child =
        start({SPRING_WALL, folder.path.string(), "--out", (folder.path / "out").string(),
               "--coupler", folder.endpoint(), "--quiet"});
    Host host(host_options(folder.endpoint(), {"surface"}));
    CHECK(push(host, 200, 2e3, 2) == Approx(2 * 8e3 / 8e6).epsilon(0.001));
    CHECK_FALSE(host.shares_memory());  // it knows ipc only, which is as good
    CHECK(exit_code(child) == 0);
    std::ifstream file(folder.path / "out" / "summary.fem.json");
    const nlohmann::json summary = nlohmann::json::parse(file);
    CHECK(summary.at("steps") == 200);
    CHECK(summary.at("complete") == true);
}
