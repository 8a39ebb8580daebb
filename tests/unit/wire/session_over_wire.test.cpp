// Two solvers and a coupler, each in its thread, run a short session over a real socket.

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>

#include "peers.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

struct SolverRecord {
    std::vector<double> times;      // t1 of each step
    std::vector<double> forces;     // first number of each f
    std::vector<std::size_t> rows;  // of each f
    std::size_t surfaces = 0;
    std::string reason;
};

SolverRecord run_surface_solver(const std::string& endpoint) {
    Participant link(surface_options(endpoint));
    link.announce(square_mesh());
    SolverRecord record;
    double t = link.welcome().t0;
    StepReply reply;
    for (std::int64_t n = link.welcome().first_step;; ++n) {
        link.send(state_of(n, t, 4));
        link.wait_reply(reply);
        if (reply.finish) {
            record.reason = reply.finish->reason;
            link.say_goodbye(n);
            return record;
        }
        t = reply.force->t1;
        record.times.push_back(t);
        record.forces.push_back(reply.force->f.at(0));
        record.rows.push_back(reply.force->f.size() / 3);
    }
}

SolverRecord run_particle_solver(const std::string& endpoint) {
    Participant link(particle_options(endpoint));
    link.announce(particle_mesh());
    SolverRecord record;
    REQUIRE(link.wait_surface().boxes.size() == 6);
    double t = link.welcome().t0;
    bool probe = true;
    std::size_t n_active = 0;
    for (std::int64_t n = link.welcome().first_step;; ++n) {
        if (probe)
            link.send(probe_of(n, t, 10));
        else
            link.send(state_of(n, t, n_active));
        const StepReply reply = link.wait_reply();
        record.surfaces += reply.surface.has_value();
        if (reply.finish) {
            record.reason = reply.finish->reason;
            link.say_goodbye(n);
            return record;
        }
        if (reply.active) n_active = reply.active->row.size();
        t = reply.force->t1;
        probe = (reply.force->flags & force_probe) != 0;
        record.times.push_back(t);
        record.rows.push_back(reply.force->f.size() / 3);
    }
}

/// 2000 nodes, nothing recorded.
void run_surface_solver_quietly(const std::string& endpoint) {
    Participant link(surface_options(endpoint));
    Mesh mesh = square_mesh();
    mesh.x.resize(6000);
    mesh.mass.resize(2000, 1);
    link.announce(std::move(mesh));
    double t = 0;
    StepReply reply;
    for (std::int64_t n = 0;; ++n) {
        link.send(state_of(n, t, 2000));
        link.wait_reply(reply);
        if (reply.finish) return link.say_goodbye(n);
        t = reply.force->t1;
    }
}

enum class BySocket { probes, surfaces, nothing };

/// Every third step asks for a PROBE, which is then answered with n % 5 active particles; or none does, but
/// the surface is shown at every other step, or never.
void run_coupler(Host& host, std::int64_t n_steps, BySocket what = BySocket::probes) {
    host.wait_join();
    const auto meshes = host.wait_meshes();
    REQUIRE(meshes.at(0).at(0).mesh == "fluid");
    REQUIRE(meshes.at(1).at(0).mass.size() == 4);
    Surface surface;
    surface.range = 0.01;
    surface.x = meshes[1][0].x;
    surface.quad = meshes[1][0].quad;
    surface.boxes = {0, 0, 0, 1, 1, 1};
    host.send(0, surface);
    double t = 0;
    std::size_t n_active = 0;
    for (std::int64_t n = 0;; ++n) {
        double dt = 1;
        bool probed = false;
        for (int i = 0; i < 2; ++i) {
            const Received received = host.next();
            if (const auto* probe = std::get_if<Probe>(&received.message)) {
                REQUIRE(received.participant == 0);
                REQUIRE(probe->id.at(9) == 109);
                dt = std::min(dt, probe->dt_limit);
                probed = true;
            } else {
                const State& state = std::get<State>(received.message);
                REQUIRE(state.n == n);
                dt = std::min(dt, state.dt_limit);
            }
        }
        if (n == n_steps) return host.finish(n, "done");
        const std::uint32_t flags = what == BySocket::probes && n % 3 == 2 ? std::uint32_t{force_probe} : 0;
        if (probed) {
            Active active{0, n, {}};
            n_active = static_cast<std::size_t>(n % 5);
            for (std::size_t i = 0; i < n_active; ++i) active.row.push_back(std::uint32_t(2 * i));
            host.send(0, active);
        }
        if (flags || (what == BySocket::surfaces && n % 2 == 1)) {
            surface.n = n;
            host.send(0, surface);
        }
        host.send(0, force_of(n, t, dt, n_active, 0, flags));
        host.send(1, force_of(n, t, dt, 4, double(n)));
        t = t + dt;
    }
}

}  // namespace

TEST_CASE("a full session: two peers advance by the smaller step and end in good order") {
    const std::string transport = GENERATE("shm", "ipc", "tcp");
    const TemporaryFolder folder;
    Host host(options_for(transport, folder));
    const std::string endpoint = host.endpoint();
    auto surface = std::async(std::launch::async, run_surface_solver, endpoint);
    auto particles = std::async(std::launch::async, run_particle_solver, endpoint);
    run_coupler(host, 20);
    CHECK(host.shares_memory() == (transport == "shm"));
    const SolverRecord fem = surface.get();
    const SolverRecord sph = particles.get();
    CHECK(fem.reason == "done");
    CHECK(sph.reason == "done");
    REQUIRE(fem.times.size() == 20);
    CHECK(fem.times == sph.times);
    CHECK(fem.times[0] == 1e-3);
    CHECK(fem.forces[19] == 19);
    CHECK(sph.surfaces == 6);  // steps 2, 5, ..., 17
    CHECK(sph.rows[0] == 0);
    CHECK(sph.rows[3] == 3);  // probed at step 3
    CHECK(sph.rows[5] == 3);
    CHECK(sph.rows[6] == 1);
    CHECK(host.name(0) == "sph");
    CHECK(host.bytes_sent() > 0);
}

TEST_CASE("messages by the socket wake who waits at the segment") {
    // Every third step has a PROBE one way and a SURFACE the other, both by the socket. Without
    // the bell each would lie there for the 50 ms of a sleep: 120 times in 180 steps.
    const TemporaryFolder folder;
    Host host(options_for("shm", folder));
    auto surface = std::async(std::launch::async, run_surface_solver, folder.endpoint());
    auto particles = std::async(std::launch::async, run_particle_solver, folder.endpoint());
    const auto start = std::chrono::steady_clock::now();
    run_coupler(host, 180);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(2));  // 0.1 s when idle
    CHECK(host.shares_memory());
    surface.get();
    particles.get();
}

TEST_CASE("after messages by the socket nobody goes on waiting for more of them") {
    // A bell that is heard after its message had been read let the next turn look for 10 ms at the
    // socket, while its answer came by the segment: 2 to 5 s in 1000 steps that take 0.03 s.
    const auto seconds = [](BySocket what) {
        const TemporaryFolder folder;
        Host host(options_for("shm", folder));
        auto surface = std::async(std::launch::async, run_surface_solver, folder.endpoint());
        auto particles = std::async(std::launch::async, run_particle_solver, folder.endpoint());
        const auto start = std::chrono::steady_clock::now();
        run_coupler(host, 1000, what);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        CHECK(host.shares_memory());
        surface.get();
        CHECK(particles.get().surfaces == (what == BySocket::surfaces ? 500 : 0));
        return took.count();
    };
    const double plain = seconds(BySocket::nothing), shown = seconds(BySocket::surfaces);
    CHECK(shown < 3 * plain + 1);   // a busy machine slows both
}

TEST_CASE("200000 steps neither grow the memory nor open files", "[.][soak]") {
    // Resident pages and descriptors of this process, which holds both ends.
    const auto resident = [] {
        std::ifstream file("/proc/self/statm");
        long total = 0, pages = 0;
        file >> total >> pages;
        return pages * 4096;
    };
    const auto descriptors = [] {
        return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
    };
    const TemporaryFolder folder;
    Host host(host_options(folder.endpoint(), {"surface"}));
    auto solver = std::async(std::launch::async, run_surface_solver_quietly, folder.endpoint());
    host.wait_join();
    host.wait_meshes();
    long resident_before = 0, descriptors_before = 0;
    double t = 0;
    Received received;
    for (std::int64_t n = 0;; ++n) {
        while (!host.next_within(1, received)) {
        }
        if (n == 1000) {
            resident_before = resident();
            descriptors_before = descriptors();
        }
        if (n == 200000) break;
        host.send(0, force_of(n, t, 1e-6, 2000));
        t = t + 1e-6;
    }
    CHECK(resident() - resident_before < 1 << 20);
    CHECK(descriptors() == descriptors_before);
    host.finish(200000, "done");
    solver.get();
}
