#pragma once
// Small peers for the tests: a coupler without contact, solvers without physics.

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "wire/host.hpp"
#include "wire/participant.hpp"

namespace undertow::wire {

/// A private folder (0700) that goes when the test ends.
struct TemporaryFolder {
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "undertow-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path); }
    std::string endpoint() const { return "ipc://" + (path / "coupler.sock").string(); }
    std::filesystem::path path;
};

/// One square of four nodes, 1 kg each.
inline Mesh square_mesh(const std::string& name = "wall") {
    Mesh mesh;
    mesh.mesh = name;
    mesh.kind = "surface";
    mesh.groups = {name};
    mesh.x = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    mesh.mass = {1, 1, 1, 1};
    mesh.quad = {0, 1, 2, 3};
    mesh.group = {0};
    return mesh;
}

inline Mesh particle_mesh() {
    Mesh mesh;
    mesh.mesh = "fluid";
    mesh.kind = "particles";
    mesh.groups = {"water"};
    mesh.radius = 0.005;
    return mesh;
}

inline State state_of(std::int64_t n, double t, std::size_t n_points, double value = 0) {
    State state;
    state.n = n;
    state.t = t;
    state.dt_limit = 1e-3;
    state.limiter = "test";
    state.x.assign(3 * n_points, value);
    state.v.assign(3 * n_points, value);
    return state;
}

inline Probe probe_of(std::int64_t n, double t, std::size_t n_particles) {
    Probe probe;
    probe.n = n;
    probe.t = t;
    probe.dt_limit = 2e-3;
    probe.limiter = "sound";
    probe.x.assign(3 * n_particles, 0.5);
    probe.v.assign(3 * n_particles, 0.0);
    probe.mass.assign(n_particles, 0.001);
    probe.radius.assign(n_particles, 0.005);
    probe.stiffness.assign(n_particles, 1e6);
    probe.phase.assign(n_particles, 0);
    for (std::size_t i = 0; i < n_particles; ++i) probe.id.push_back(100 + i);
    return probe;
}

inline Force force_of(std::int64_t n, double t, double dt, std::size_t n_points, double value = 0,
                      std::uint32_t flags = 0) {
    Force force;
    force.n = n;
    force.dt = dt;
    force.t1 = t + dt;
    force.flags = flags;
    force.limiter = "test";
    force.f.assign(3 * n_points, value);
    return force;
}

inline ParticipantOptions surface_options(const std::string& endpoint,
                                          const std::string& name = "fem") {
    return {endpoint, name, "surface", {}, "test", 10};
}

inline ParticipantOptions particle_options(const std::string& endpoint,
                                           const std::string& name = "sph") {
    return {endpoint, name, "particles", {}, "test", 10};
}

inline HostOptions host_options(const std::string& endpoint,
                                std::vector<std::string> roles = {"particles", "surface"}) {
    HostOptions options;
    options.endpoint = endpoint;
    options.expected_roles = std::move(roles);
    options.join_timeout = 10;
    options.deadline = 10;
    options.welcome.t_end = 1;
    return options;
}

/// "shm", "ipc" or "tcp".
inline HostOptions options_for(const std::string& transport, const TemporaryFolder& folder,
                               std::vector<std::string> roles = {"particles", "surface"}) {
    HostOptions options = host_options(
        transport == "tcp" ? "tcp://127.0.0.1:0" : folder.endpoint(), std::move(roles));
    options.shared_memory = transport == "shm";
    return options;
}

}  // namespace undertow::wire
