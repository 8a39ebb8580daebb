// What a coupler does when a solver misbehaves: the culprit and the others learn the cause.

#include <signal.h>
#include <sys/wait.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "running_pair.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

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

TEST_CASE("a frame beyond the limit closes the connection and is never resumed") {
    HostOptions options = host_options("");
    options.welcome.max_message = 10000;
    RunningPair run(options);
    run.a.send(run.stamped(probe_of(0, 0, 1000)));  // 24000 bytes of x
    CHECK(failure_of_next(run.host).code == "E_PEER_LOST");
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
