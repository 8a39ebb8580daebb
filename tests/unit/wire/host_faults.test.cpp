// What a coupler does when a solver misbehaves: the culprit and the others learn the cause.

#include <signal.h>
#include <sys/wait.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "raw_peers.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

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

struct Failure {
    std::string code, text;
};

Failure failure_of_next(Host& host) {
    try {
        host.next();
    } catch (const PeerError& error) {
        return {error.code, error.what()};
    }
    return {"", "next() returned"};
}

/// next() fails with `code`, names alpha, and both solvers get that ERROR.
void check_failure(RunningPair& run, const std::string& code) {
    const Failure failure = failure_of_next(run.host);
    INFO(failure.text);
    CHECK(failure.code == code);
    CHECK(failure.text.find("alpha") != std::string::npos);
    const Error to_culprit = run.a.expect<Error>();
    CHECK(to_culprit.code == code);
    const Error to_other = run.b.expect<Error>();
    CHECK(to_other.code == code);
    CHECK(to_other.who == "alpha");
    CHECK(to_other.text == failure.text);
}

}  // namespace

TEST_CASE("a wrong message ends the run: culprit and bystander get the cause") {
    RunningPair run;
    SECTION("a non-finite coordinate") {
        Probe probe = run.stamped(probe_of(0, 0, 2));
        probe.x[4] = std::numeric_limits<double>::quiet_NaN();
        run.a.send(probe);
        check_failure(run, "E_NONFINITE");
    }
    SECTION("arrays that do not fit together") {
        Probe probe = run.stamped(probe_of(0, 0, 2));
        probe.mass.pop_back();
        run.a.send(probe);
        check_failure(run, "E_SHAPE");
    }
    SECTION("a particle without mass") {
        Probe probe = run.stamped(probe_of(0, 0, 2));
        probe.mass[1] = 0;
        run.a.send(probe);
        check_failure(run, "E_NONFINITE");
    }
    SECTION("a particle larger than announced") {
        Probe probe = run.stamped(probe_of(0, 0, 2));
        probe.radius[1] = 0.00501;
        run.a.send(probe);
        check_failure(run, "E_MESH");
    }
    SECTION("a phase that was not announced") {
        Probe probe = run.stamped(probe_of(0, 0, 2));
        probe.phase[1] = 1;
        run.a.send(probe);
        check_failure(run, "E_MESH");
    }
    SECTION("a skipped step") {
        run.a.send(run.stamped(probe_of(1, 0, 2)));
        check_failure(run, "E_SEQUENCE");
    }
    SECTION("a stale session") {
        Probe probe = run.stamped(probe_of(0, 0, 2));
        ++probe.session;
        run.a.send(probe);
        check_failure(run, "E_SEQUENCE");
    }
    SECTION("a message out of order") {
        run.a.send(run.stamped(Bye{}));
        check_failure(run, "E_STATE");
    }
    SECTION("a mesh in mid-run") {
        run.a.send(run.stamped(particle_mesh()));
        check_failure(run, "E_STATE");
    }
    SECTION("a time that was not agreed") {
        run.step_zero();
        run.a.send(run.stamped(state_of(1, 0.25, 0)));
        check_failure(run, "E_TIME");
    }
    SECTION("a duplicate") {
        run.a.send(run.stamped(probe_of(0, 0, 2)));
        run.a.send(run.stamped(probe_of(0, 0, 2)));
        CHECK(run.host.next().participant == run.i_a);
        check_failure(run, "E_SEQUENCE");
    }
    SECTION("more rows than agreed") {
        run.step_zero();
        run.a.send(run.stamped(state_of(1, 0.5, 1)));
        check_failure(run, "E_SHAPE");
    }
    SECTION("a HELLO in mid-run") {
        run.a.send(hello_of("alpha", "particles"));
        check_failure(run, "E_STATE");
    }
}

TEST_CASE("the error of one solver reaches the other with its cause") {
    RunningPair run;
    run.a.send(run.stamped(Error{0, 0, "E_PHYSICS", "element 17 of wall is inverted", "alpha"}));
    const Failure failure = failure_of_next(run.host);
    CHECK(failure.code == "E_PHYSICS");
    CHECK(failure.text == "alpha: element 17 of wall is inverted");
    const Error error = run.b.expect<Error>();
    CHECK(error.code == "E_PHYSICS");
    CHECK(error.who == "alpha");
    CHECK(error.text.find("element 17 of wall is inverted") != std::string::npos);
    run.host.broadcast_error("E_PHYSICS", "told already", "alpha");  // as main does: says it once
    CHECK_THROWS_AS(run.a.receive(0.1), std::runtime_error);
    CHECK_THROWS_AS(run.b.receive(0.1), std::runtime_error);
}

TEST_CASE("a silent solver is given up at the deadline, while the other is told to wait") {
    HostOptions options = host_options("");
    options.deadline = 0.6;
    RunningPair run(options);
    run.b.send(run.stamped(probe_of(0, 0, 2)));
    CHECK(run.host.next().participant != run.i_a);
    const double start = now();
    check_failure(run, "E_TIMEOUT");
    CHECK(now() - start > 0.5);
    CHECK(now() - start < 3);
    CHECK(run.b.n_progress >= 1);
}

namespace {
std::atomic<bool> user_stops = false;
bool stop_flag() {
    return user_stops;
}
}  // namespace

TEST_CASE("a user who stops the run while somebody is still awaited need not wait with it") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint());
    options.stop = stop_flag;
    options.join_timeout = 60;
    Host host(options);
    RawPeer early(Channel::End::solver, host.endpoint());
    early.send(hello_of("early", "particles"));
    std::thread user([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        user_stops = true;
    });
    const double start = now();
    std::string code;
    try {
        host.wait_join();
    } catch (const PeerError& error) {
        code = error.code;
    }
    user.join();
    user_stops = false;
    CHECK(code == "E_STOP");
    CHECK(now() - start < 3);  // a wait of the system ends after a second
    early.expect<Welcome>();
    CHECK(early.expect<Error>().code == "E_STOP");
}

TEST_CASE("a participant stopped by its user before the first step ends the run") {
    TemporaryFolder folder;
    Host host(host_options(folder.endpoint()));
    std::string code;
    std::thread solver([&] {
        ParticipantOptions options = particle_options(host.endpoint());
        options.stop = stop_flag;
        try {
            Participant link(options);
            link.announce(particle_mesh());
            link.wait_surface();  // comes when all have joined
        } catch (const PeerError& error) {
            code = error.code;
        }
    });
    std::thread user([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        user_stops = true;
    });
    const double start = now();
    CHECK_THROWS_WITH(host.wait_join(), Catch::Contains("the user stopped sph"));
    solver.join();
    user.join();
    user_stops = false;
    CHECK(code == "E_STOP");
    CHECK(now() - start < 3);
}

TEST_CASE("PROGRESS restarts the deadline of a slow solver") {
    HostOptions options = host_options("");
    options.deadline = 0.5;
    RunningPair run(options);
    std::thread slow([&] {
        for (int i = 0; i < 4; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(250));
            run.a.send(run.stamped(Progress{0, 0, 0.25 * i, "rebuilding"}));
            run.b.send(run.stamped(Progress{0, 0, 0.25 * i, "rebuilding"}));
        }
        run.a.send(run.stamped(probe_of(0, 0, 2)));
    });
    const Received received = run.host.next();  // after a second, twice the deadline
    slow.join();
    CHECK(received.participant == run.i_a);
}

TEST_CASE("a vanished solver is noticed at once") {
    TemporaryFolder folder;
    const std::string transport = GENERATE("ipc", "tcp");
    Host host(host_options(transport == "ipc" ? folder.endpoint() : "tcp://127.0.0.1:0",
                           {"particles", "particles"}));
    RawPeer stays(Channel::End::solver, host.endpoint());
    auto goes = std::make_unique<RawPeer>(Channel::End::solver, host.endpoint());
    stays.send(hello_of("stays", "particles"));
    goes->send(hello_of("goes", "particles"));
    host.wait_join();
    stays.expect<Welcome>();
    goes->expect<Welcome>();
    const double start = now();
    goes.reset();
    const Failure failure = failure_of_next(host);
    CHECK(now() - start < 0.5);  // measured: a few milliseconds; the rest is for a busy machine
    CHECK(failure.code == "E_PEER_LOST");
    CHECK(failure.text.find("goes") != std::string::npos);
    CHECK(stays.expect<Error>().who == "goes");
}

TEST_CASE("a solver killed with signal 9 is noticed at once") {
    TemporaryFolder folder;
    const std::string endpoint = folder.endpoint();
    const pid_t child = fork();
    if (child == 0) {
        try {
            Participant link(surface_options(endpoint));
            link.announce(square_mesh());
            link.send(state_of(0, 0, 4));
            link.wait_reply();
            raise(SIGKILL);
        } catch (...) {
        }
        _exit(1);
    }
    Host host(host_options(endpoint, {"surface"}));
    host.wait_join();
    host.wait_meshes();
    CHECK(std::holds_alternative<State>(host.next().message));
    const double start = now();
    host.send(0, force_of(0, 0, 0.1, 4));
    CHECK(failure_of_next(host).code == "E_PEER_LOST");
    const double noticed = now() - start;
    CHECK(noticed < 0.5);
    int status = 0;
    waitpid(child, &status, 0);
    CHECK(WIFSIGNALED(status));
}

TEST_CASE("the last words of a solver that leaves are heard") {
    TemporaryFolder folder;
    Host host(host_options(folder.endpoint(), {"particles"}));
    {
        RawPeer leaving(Channel::End::solver, host.endpoint());
        leaving.channel().linger(5);
        leaving.send(hello_of("alpha", "particles"));
        host.wait_join();
        const std::uint64_t session = leaving.expect<Welcome>().session;
        leaving.send(Error{session, 0, "E_INPUT", "the mesh file is missing", "alpha"});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // the connection is broken by now
    const Failure failure = failure_of_next(host);
    CHECK(failure.code == "E_INPUT");
    CHECK(failure.text == "alpha: the mesh file is missing");
}

TEST_CASE("strangers are refused with the reason and do not disturb the run") {
    RunningPair run;
    const auto answer_to = [&](const RawFrames& frames) {
        ByteSender stranger(run.folder.endpoint());
        stranger.send(frames);
        Received received;
        for (int i = 0; i < 100 && !stranger.has_answer(); ++i) {
            run.host.next_within(0.05, received);
        }
        return std::get<Error>(stranger.receive());
    };
    CHECK(answer_to(raw_frames(hello_of("alpha", "particles"))).code == "E_NAME_TAKEN");
    CHECK(answer_to(raw_frames(hello_of("gamma", "particles"))).code == "E_LATE");
    CHECK(answer_to(raw_frames(hello_of("gamma", "observer"))).code == "E_INPUT");
    CHECK(answer_to(raw_frames(hello_of("../gamma", "particles"))).code == "E_INPUT");
    Hello old = hello_of("gamma", "particles");
    old.version = {2, 0};
    const Error version = answer_to(raw_frames(old));
    CHECK(version.code == "E_VERSION");
    CHECK(version.text.find("1.0") != std::string::npos);
    CHECK(version.text.find("2.0") != std::string::npos);
    Hello other = hello_of("gamma", "particles");
    other.protocol = "sfc";
    CHECK(answer_to(raw_frames(other)).code == "E_VERSION");
    CHECK(answer_to(raw_frames(run.stamped(probe_of(0, 0, 1)))).code == "E_STATE");
    CHECK(answer_to({"garbage"}).code == "E_MALFORMED");
    CHECK(answer_to({""}).code == "E_MALFORMED");
    CHECK(answer_to(RawFrames(40, "x")).code == "E_MALFORMED");
    run.step_zero();
}

TEST_CASE("a frame beyond the limit closes the connection and is never resumed") {
    HostOptions options = host_options("");
    options.welcome.max_message = 10000;
    RunningPair run(options);
    run.a.send(run.stamped(probe_of(0, 0, 1000)));  // 24000 bytes of x
    CHECK(failure_of_next(run.host).code == "E_PEER_LOST");
}

TEST_CASE("who is missing is named when the time to join is up") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint());
    options.join_timeout = 0.3;
    Host host(options);
    RawPeer fem(Channel::End::solver, folder.endpoint());
    fem.send(hello_of("fem", "surface"));
    try {
        host.wait_join();
        FAIL("joined");
    } catch (const PeerError& error) {
        CHECK(error.code == "E_TIMEOUT");
        CHECK(std::string(error.what()).find("nobody joined as particles (joined: fem)") !=
              std::string::npos);
    }
    fem.expect<Welcome>();
    CHECK(fem.expect<Error>().code == "E_TIMEOUT");
}

TEST_CASE("an unusable mesh is refused with facet, node or group") {
    struct Row {
        std::string code, part;
        void (*spoil)(Mesh&);
    };
    const std::vector<Row> rows{
        {"E_MESH", "facet 0 names node 4", [](Mesh& m) { m.quad[2] = 4; }},
        {"E_MESH", "facet 0 names node -1", [](Mesh& m) { m.quad[0] = -1; }},
        {"E_MESH", "group 1", [](Mesh& m) { m.group[0] = 1; }},
        {"E_MESH", "0 facets", [](Mesh& m) { m.quad.clear(), m.group.clear(); }},
        {"E_MESH", "kind", [](Mesh& m) { m.kind = "particles"; }},
        {"E_MESH", "revision 1", [](Mesh& m) { m.revision = 1; }},
        {"E_NONFINITE", "mass of node 3", [](Mesh& m) { m.mass[3] = 0; }},
        {"E_SHAPE", "mass has 5", [](Mesh& m) { m.mass.push_back(1); }},
    };
    for (const Row& row : rows) {
        TemporaryFolder folder;
        Host host(host_options(folder.endpoint(), {"surface"}));
        RawPeer fem(Channel::End::solver, folder.endpoint());
        fem.send(hello_of("fem", "surface"));
        host.wait_join();
        Mesh mesh = square_mesh();
        mesh.session = fem.expect<Welcome>().session;
        row.spoil(mesh);
        fem.send(mesh);
        try {
            host.wait_meshes();
            FAIL_CHECK("accepted");
        } catch (const PeerError& error) {
            INFO(error.what());
            CHECK(error.code == row.code);
            CHECK(std::string(error.what()).find(row.part) != std::string::npos);
            CHECK(std::string(error.what()).find("fem") == 0);
        }
    }
}

TEST_CASE("capabilities are those both sides have") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.welcome.capabilities = {"checkpoint", "other"};
    Host host(options);
    RawPeer fem(Channel::End::solver, folder.endpoint());
    Hello hello = hello_of("fem", "surface");
    hello.capabilities = {"future", "checkpoint"};
    fem.send(hello);
    host.wait_join();
    CHECK(fem.expect<Welcome>().capabilities == std::vector<std::string>{"checkpoint"});
    CHECK(host.can(0, "checkpoint"));
    CHECK_FALSE(host.can(0, "other"));
    CHECK_FALSE(host.can(0, "future"));
}

TEST_CASE("the coupler's own mistakes are found before they are sent") {
    RunningPair run;
    CHECK_THROWS_AS(run.host.send(0, force_of(0, 0, 0.5, 0)), std::logic_error);
    run.a.send(run.stamped(probe_of(0, 0, 2)));
    run.b.send(run.stamped(probe_of(0, 0, 2)));
    for (int i = 0; i < 2; ++i) run.host.next();
    CHECK_THROWS_AS(run.host.next(), std::logic_error);  // everybody waits for an answer
    CHECK_THROWS_AS(run.host.send(0, Active{0, 0, {7}}), std::logic_error);
    CHECK_THROWS_AS(run.host.send(0, Checkpoint{0, 0, "k"}), std::logic_error);  // no capability
}

TEST_CASE("a chattering solver does not starve the other") {
    RunningPair run;
    std::atomic<bool> stop{false};
    std::thread chatter([&] {
        while (!stop) run.a.send(run.stamped(Progress{0, 0, 0.5, "chatter"}));
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    run.b.send(run.stamped(probe_of(0, 0, 2)));
    const Received received = run.host.next();
    CHECK(received.participant != run.i_a);
    stop = true;
    Received none;
    while (run.host.next_within(0.05, none)) {
    }
    chatter.join();
}
