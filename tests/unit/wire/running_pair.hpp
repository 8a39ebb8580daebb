#pragma once
// Two solvers played by hand, in a session with a real host.

#include "raw_peers.hpp"

namespace undertow::wire {

/// Two raw solvers in a running session, before their first PROBE. Both are particle solvers, whose
/// meshes are complete at once, so that one thread can play all parts.
struct RunningPair {
    explicit RunningPair(HostOptions options) : host(with_roles(options)) {
        for (RawPeer* peer : {&a, &b}) {
            peer->send(hello_of(peer == &a ? "alpha" : "beta", "particles"));
        }
        host.wait_join();
        for (RawPeer* peer : {&a, &b}) {
            session = peer->expect<Welcome>().session;
            Mesh mesh = particle_mesh();
            mesh.session = session;
            peer->send(mesh);
        }
        host.wait_meshes();
        for (std::size_t i : {0, 1}) host.send(i, Surface{});
        for (RawPeer* peer : {&a, &b}) {
            peer->expect<MeshAck>();
            peer->expect<Surface>();
        }
        // Seats are given in order of arrival, which differs from run to run.
        i_a = host.name(0) == "alpha" ? 0 : 1;
    }
    explicit RunningPair() : RunningPair(host_options("")) {}

    HostOptions with_roles(HostOptions options) const {
        options.endpoint = folder.endpoint();
        options.expected_roles = {"particles", "particles"};
        return options;
    }

    template <class M>
    M stamped(M message) const {
        message.session = session;
        return message;
    }

    /// One complete step 0 for both: PROBE, ACTIVE with no particle, FORCE.
    void step_zero() {
        for (RawPeer* peer : {&a, &b}) peer->send(stamped(probe_of(0, 0, 2)));
        for (int i = 0; i < 2; ++i) host.next();
        for (std::size_t i : {0, 1}) {
            host.send(i, Active{});
            host.send(i, force_of(0, 0, 0.5, 0));
        }
        for (RawPeer* peer : {&a, &b}) {
            peer->expect<Active>();
            CHECK(peer->expect<Force>().t1 == 0.5);
        }
    }

    TemporaryFolder folder;
    Host host;
    RawPeer a{Channel::End::solver, folder.endpoint()}, b{Channel::End::solver, folder.endpoint()};
    std::uint64_t session = 0;
    std::size_t i_a = 0;
};

}  // namespace undertow::wire
