// What one coupled step costs on the wire: two participants and a coupler as three processes, no
// physics. Each step two STATEs of N points go up and two FORCEs come down.
//
//     bench_wire_latency [--transport shm|ipc|tcp]... [--json] [N ...]
//
// --json prints {"coupling.us_per_step.shm.1000": ..., "coupling.cpu_us_per_step.shm.1000": ...}
// instead of the table: medians of the wall time, and CPU of all three processes.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "wire/host.hpp"
#include "wire/participant.hpp"

using namespace undertow::wire;

namespace {

constexpr int n_warm_up = 200;  // steps until buffers and caches have settled

double cpu_seconds(int who) {
    rusage usage{};
    getrusage(who, &usage);
    return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/// A surface solver of n points (one facet) that fills a new STATE each step, as a solver does.
void run_solver(const std::string& endpoint, const std::string& name, std::size_t n_points) {
    Participant link({endpoint, name, "surface", {}, "bench", 20});
    Mesh mesh;
    mesh.mesh = name;
    mesh.kind = "surface";
    mesh.groups = {name};
    mesh.mass.assign(std::max<std::size_t>(n_points, 4), 1);
    mesh.x.assign(3 * mesh.mass.size(), 0);
    mesh.x[3] = mesh.x[6] = mesh.x[7] = mesh.x[10] = 1;  // one facet of 1 m x 1 m, all other points at a corner
    mesh.quad = {0, 1, 2, 3};
    mesh.group = {0};
    const std::size_t n_nodes = mesh.mass.size();
    link.announce(std::move(mesh));
    std::vector<double> x(3 * n_nodes, 1), v(3 * n_nodes, 1);
    double t = 0;
    StepReply reply;
    State state;
    for (std::int64_t n = 0;; ++n) {
        state.n = n;
        state.t = t;
        state.dt_limit = 1e-6;
        state.x = x;
        state.v = v;
        link.send(std::move(state));
        link.wait_reply(reply);
        if (reply.finish) return link.say_goodbye(n);
        for (std::size_t i = 0; i < x.size(); ++i) {
            v[i] += 1e-9 * reply.force->f[i];
            x[i] += 1e-9 * v[i];
        }
        t = reply.force->t1;
    }
}

struct Figures {
    std::size_t n_points;
    double median, fastest, slowest_percent, cpu;  // [us] per step
};

Figures measure(const std::string& transport, const std::string& folder, std::size_t n_points) {
    const int n_steps = n_points > 20000 ? 400 : 2000;
    int pipe_of_port[2][2];
    std::vector<pid_t> children;
    for (int i = 0; i < 2; ++i) {
        if (pipe(pipe_of_port[i]) != 0) std::exit(1);
        const pid_t child = fork();  // before any socket exists in this process
        if (child == 0) {
            char endpoint[256] = {};
            if (read(pipe_of_port[i][0], endpoint, sizeof endpoint - 1) <= 0) _exit(1);
            run_solver(endpoint, i == 0 ? "one" : "two", n_points);
            _exit(0);
        }
        children.push_back(child);
    }
    std::vector<double> times;
    double own_cpu = 0;
    {
        HostOptions options;
        options.endpoint =
            transport == "tcp" ? "tcp://127.0.0.1:0" : "ipc://" + folder + "/coupler.sock";
        options.shared_memory = transport == "shm";
        options.expected_roles = {"surface", "surface"};
        options.deadline = 20;
        Host host(options);
        for (int i = 0; i < 2; ++i) {
            const std::string& endpoint = host.endpoint();
            if (write(pipe_of_port[i][1], endpoint.data(), endpoint.size()) < 0) std::exit(1);
        }
        host.wait_join();
        host.wait_meshes();
        if (host.shares_memory() != (transport == "shm")) {
            std::fprintf(stderr, "this system offers no shared memory\n");
            std::exit(1);
        }
        const std::size_t n_rows = std::max<std::size_t>(n_points, 4);
        std::vector<Received> received(2);
        std::vector<Message> forces(2, Message(Force{}));
        double t = 0;
        auto last = std::chrono::steady_clock::now();
        for (int n = 0; n < n_steps + n_warm_up; ++n) {
            if (n == n_warm_up) own_cpu = -cpu_seconds(RUSAGE_SELF);
            for (Received& one : received) {
                while (!host.next_within(1, one)) {
                }
            }
            for (const Received& one : received) {
                const State& state = std::get<State>(one.message);
                Force& force = std::get<Force>(forces[one.participant]);
                force.n = n;
                force.dt = 1e-6;
                force.t1 = t + 1e-6;
                force.f.resize(3 * n_rows);
                for (std::size_t i = 0; i < force.f.size(); ++i)
                    force.f[i] = state.x[i] - state.v[i];
                host.send(one.participant, std::move(forces[one.participant]));
            }
            t += 1e-6;
            const auto now = std::chrono::steady_clock::now();
            if (n >= n_warm_up) {
                times.push_back(std::chrono::duration<double, std::micro>(now - last).count());
            }
            last = now;
        }
        own_cpu += cpu_seconds(RUSAGE_SELF);
        for (Received& one : received) {
            while (!host.next_within(1, one)) {
            }
        }
        host.finish(n_steps + n_warm_up, "done");
    }
    const double children_before = cpu_seconds(RUSAGE_CHILDREN);
    for (const pid_t child : children) waitpid(child, nullptr, 0);
    const double children_cpu = cpu_seconds(RUSAGE_CHILDREN) - children_before;
    for (auto& ends : pipe_of_port) {
        close(ends[0]);
        close(ends[1]);
    }
    std::sort(times.begin(), times.end());
    const double cpu = own_cpu / n_steps + children_cpu / (n_steps + n_warm_up);
    return {n_points, times[times.size() / 2], times.front(), times[times.size() * 99 / 100],
            1e6 * cpu};
}

}  // namespace

int main(int argc, char** argv) {
    bool json = false;
    std::vector<std::string> transports;
    std::vector<std::size_t> sizes;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--json")
            json = true;
        else if (argument == "--transport" && i + 1 < argc)
            transports.push_back(argv[++i]);
        else
            sizes.push_back(std::stoul(argument));
    }
    if (sizes.empty()) sizes = {0, 1000, 10000, 100000};
    if (transports.empty()) transports = {"shm", "ipc", "tcp"};
    std::string name = (std::filesystem::temp_directory_path() / "undertow-XXXXXX").string();
    const std::filesystem::path folder = mkdtemp(name.data());
    if (!json) std::printf("us per step:  N    median  fastest     99 %%   CPU of all three\n");
    std::string entries;
    for (const std::string& transport : transports) {
        for (const std::size_t size : sizes) {
            const Figures figures = measure(transport, folder.string(), size);
            char line[200];
            if (json) {
                const std::string key = transport + "." + std::to_string(size);
                std::snprintf(line, sizeof line,
                              "%s  \"coupling.us_per_step.%s\": %.1f,\n"
                              "  \"coupling.cpu_us_per_step.%s\": %.1f",
                              entries.empty() ? "" : ",\n", key.c_str(), figures.median,
                              key.c_str(), figures.cpu);
                entries += line;
                continue;
            }
            std::printf("%s %11zu %9.1f %8.1f %8.1f %8.1f\n", transport.c_str(), figures.n_points,
                        figures.median, figures.fastest, figures.slowest_percent, figures.cpu);
            std::fflush(stdout);
        }
    }
    std::filesystem::remove_all(folder);
    if (json) std::printf("{\n%s\n}\n", entries.c_str());
}
