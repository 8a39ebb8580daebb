// What a solver does when the coupler misbehaves, is late, or goes.

#include <signal.h>
#include <sys/time.h>

#include <catch2/catch.hpp>
#include <future>
#include <thread>

#include "raw_peers.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

struct Failure {
    std::string code, text;
};

/// A surface solver that sends STATE(0) and waits for its answer.
Failure run_solver(const std::string& endpoint) {
    try {
        Participant link(surface_options(endpoint));
        link.announce(square_mesh());
        link.send(state_of(0, 0, 4));
        link.wait_reply();
    } catch (const PeerError& error) {
        return {error.code, error.what()};
    }
    return {"", "wait_reply() returned"};
}

struct RawCoupler : RawPeer {
    explicit RawCoupler(const std::string& endpoint) : RawPeer(Channel::End::coupler, endpoint) {}

    void welcome(double deadline = 5, int major = version_major) {
        CHECK(expect<Hello>().name == "fem");
        Welcome welcome;
        welcome.session = 77;
        welcome.version[0] = major;
        welcome.deadline = deadline;
        welcome.max_message = default_max_message;
        send(welcome);
    }
    void until_first_state(double deadline = 5) {
        welcome(deadline);
        const Mesh mesh = expect<Mesh>();
        send(MeshAck{77, mesh.mesh, 0, checksum(mesh)});
        CHECK(expect<State>().n == 0);
    }
    Force force() const {
        Force force = force_of(0, 0, 0.1, 4);
        force.session = 77;
        return force;
    }
};

}  // namespace

TEST_CASE("a wrong answer stops the solver, which tells the coupler why") {
    TemporaryFolder folder;
    RawCoupler coupler(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    coupler.until_first_state();
    Force force = coupler.force();
    std::string expected;
    SECTION("wrong step") {
        force.n = 1;
        expected = "E_SEQUENCE";
    }
    SECTION("wrong session") {
        force.session = 78;
        expected = "E_SEQUENCE";
    }
    SECTION("wrong rows") {
        force.f.resize(9);
        expected = "E_SHAPE";
    }
    SECTION("a force that is not a number") {
        force.f[5] = std::numeric_limits<double>::quiet_NaN();
        expected = "E_NONFINITE";
    }
    SECTION("no time granted") {
        force.dt = 0;
        expected = "E_TIME";
    }
    coupler.send(force);
    const Error told = coupler.expect<Error>();
    CHECK(told.code == expected);
    CHECK(told.who == "fem");
    const Failure failure = solver.get();
    INFO(failure.text);
    CHECK(failure.code == expected);
}

TEST_CASE("a message type that is not due stops the solver") {
    TemporaryFolder folder;
    RawCoupler coupler(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    coupler.until_first_state();
    coupler.send(Active{77, 0, {}});  // a surface has no active list
    CHECK(coupler.expect<Error>().code == "E_STATE");
    CHECK(solver.get().code == "E_STATE");
}

TEST_CASE("the coupler's error is the solver's error, with the one at fault") {
    TemporaryFolder folder;
    RawCoupler coupler(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    coupler.until_first_state();
    coupler.send(Error{77, 0, "E_DT", "the step fell below 1e-10 s", "sph"});
    const Failure failure = solver.get();
    CHECK(failure.code == "E_DT");
    CHECK(failure.text == "sph: the step fell below 1e-10 s");
    CHECK_THROWS_AS(coupler.receive(0.1), std::runtime_error);  // it does not answer an error
}

TEST_CASE("a coupler that vanishes is noticed at once, whatever the solver waits for") {
    TemporaryFolder folder;
    auto coupler = std::make_unique<RawCoupler>(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    SECTION("in mid-step") {
        coupler->until_first_state();
    }
    SECTION("before WELCOME") {
        coupler->expect<Hello>();
    }
    const auto start = std::chrono::steady_clock::now();
    coupler.reset();
    CHECK(solver.get().code == "E_PEER_LOST");
    const std::chrono::duration<double> noticed = std::chrono::steady_clock::now() - start;
    CHECK(noticed.count() < 0.5);
}

TEST_CASE("a silent coupler is given up at the deadline; its PROGRESS prolongs it") {
    TemporaryFolder folder;
    RawCoupler coupler(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    coupler.until_first_state(0.3);
    const auto start = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    coupler.send(Progress{77, 0, 0, "waiting for sph"});
    CHECK(coupler.expect<Error>().code == "E_TIMEOUT");
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
    CHECK(waited.count() > 0.45);
    CHECK(solver.get().code == "E_TIMEOUT");
}

TEST_CASE("no coupler at the endpoint: the solver says so when its time is up") {
    TemporaryFolder folder;
    ParticipantOptions options = surface_options(folder.endpoint());
    options.join_timeout = 0.2;
    try {
        Participant link(options);
        FAIL("joined");
    } catch (const PeerError& error) {
        CHECK(error.code == "E_TIMEOUT");
        CHECK(std::string(error.what()).find("no coupler appeared at ipc://") != std::string::npos);
    }
}

TEST_CASE("a coupler that starts after the solver is found") {
    TemporaryFolder folder;
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    RawCoupler coupler(folder.endpoint());
    coupler.until_first_state();
    coupler.send(coupler.force());
    CHECK(solver.get().text == "wait_reply() returned");
}

TEST_CASE("a coupler of another major version is refused") {
    TemporaryFolder folder;
    RawCoupler coupler(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    coupler.welcome(5, 2);
    CHECK(coupler.expect<Error>().code == "E_VERSION");
    CHECK(solver.get().code == "E_VERSION");
}

TEST_CASE("a refusal names the reason: a taken name, a late joiner") {
    TemporaryFolder folder;
    Host host(host_options(folder.endpoint(), {"surface"}));
    const auto join = [&](const std::string& name) -> Failure {
        try {
            Participant link(surface_options(folder.endpoint(), name));
            return {"", "joined"};
        } catch (const PeerError& error) {
            return {error.code, error.what()};
        }
    };
    RawPeer first(Channel::End::solver, folder.endpoint());
    first.send(hello_of("fem", "surface"));
    host.wait_join();
    for (const auto& [name, code] : {std::pair{"fem", "E_NAME_TAKEN"}, {"fem2", "E_LATE"}}) {
        auto joiner = std::async(std::launch::async, join, name);
        Received received;
        while (joiner.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
            host.next_within(0.05, received);
        }
        CHECK(joiner.get().code == code);
    }
}

TEST_CASE("this program's own mistakes are found before they are sent") {
    TemporaryFolder folder;
    auto partner = std::async(std::launch::async, [&] {
        RawCoupler coupler(folder.endpoint());
        coupler.welcome();
        const Mesh mesh = coupler.expect<Mesh>();
        coupler.send(MeshAck{77, mesh.mesh, 0, checksum(mesh)});
        return coupler.expect<Error>().code;
    });
    Participant link(surface_options(folder.endpoint()));
    CHECK_THROWS_AS(link.send(state_of(0, 0, 0)), std::logic_error);
    link.announce(square_mesh());
    CHECK_THROWS_AS(link.send(state_of(0, 0, 3)), std::logic_error);
    CHECK_THROWS_AS(link.send(probe_of(0, 0, 3)), std::logic_error);
    CHECK_THROWS_AS(link.say_goodbye(0), std::logic_error);
    link.report_error("E_PHYSICS", "as main does");
    CHECK(partner.get() == "E_PHYSICS");
}

TEST_CASE("an array larger than the coupler takes is refused here, not by a broken connection") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.welcome.max_message = 95;  // x of square_mesh() has 96 bytes
    Host host(options);
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    host.wait_join();
    const Failure failure = solver.get();
    CHECK(failure.code == "E_SHAPE");
    CHECK(failure.text == "MESH has an array of 96 bytes; the other end takes 95");
}

TEST_CASE("a mesh that changed on its way is refused") {
    TemporaryFolder folder;
    RawCoupler coupler(folder.endpoint());
    auto solver = std::async(std::launch::async, run_solver, folder.endpoint());
    coupler.welcome();
    coupler.expect<Mesh>();
    coupler.send(MeshAck{77, "wall", 0, "0123456789abcdef"});
    CHECK(coupler.expect<Error>().code == "E_MESH");
    CHECK(solver.get().code == "E_MESH");
}

namespace {

void ignore_signal(int) {}

}  // namespace

TEST_CASE("signals while the coupler is awaited do not end the wait") {
    struct sigaction action {
    }, before{};
    action.sa_handler = ignore_signal;
    sigaction(SIGALRM, &action, &before);
    const itimerval often{{0, 200}, {0, 200}}, never{};
    TemporaryFolder folder;
    auto late = std::async(std::launch::async, [&] {
        sigset_t alarm;  // the signals go to the thread of the participant
        sigemptyset(&alarm);
        sigaddset(&alarm, SIGALRM);
        pthread_sigmask(SIG_BLOCK, &alarm, nullptr);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        RawCoupler coupler(folder.endpoint());
        coupler.until_first_state();
        coupler.send(coupler.force());
        CHECK_THROWS_AS(coupler.receive(0.2), std::runtime_error);
    });
    setitimer(ITIMER_REAL, &often, nullptr);
    CHECK(run_solver(folder.endpoint()).text == "wait_reply() returned");
    setitimer(ITIMER_REAL, &never, nullptr);
    sigaction(SIGALRM, &before, nullptr);
    late.get();
}

TEST_CASE("signals during waits and sends lose no message") {
    // A timer signal every 200 microseconds without SA_RESTART: system calls end with EINTR.
    struct sigaction action {
    }, before{};
    action.sa_handler = ignore_signal;
    sigaction(SIGALRM, &action, &before);
    const itimerval often{{0, 200}, {0, 200}}, never{};
    TemporaryFolder folder;
    Host host(host_options(folder.endpoint(), {"surface"}));
    auto solver = std::async(std::launch::async, [&] {
        Participant link(surface_options(folder.endpoint()));
        link.announce(square_mesh());
        double t = 0;
        for (std::int64_t n = 0;; ++n) {
            link.send(state_of(n, t, 4));
            const StepReply reply = link.wait_reply();
            if (reply.finish) {
                link.say_goodbye(n);
                return n;
            }
            t = reply.force->t1;
        }
    });
    setitimer(ITIMER_REAL, &often, nullptr);
    host.wait_join();
    host.wait_meshes();
    double t = 0;
    for (std::int64_t n = 0; n <= 1000; ++n) {
        const State state = std::get<State>(host.next().message);
        CHECK(state.n == n);
        if (n == 1000) {
            host.finish(n, "done");
            break;
        }
        host.send(0, force_of(n, t, 0.1, 4));
        t = t + 0.1;
    }
    setitimer(ITIMER_REAL, &never, nullptr);
    sigaction(SIGALRM, &before, nullptr);
    CHECK(solver.get() == 1000);
}

TEST_CASE("why the coupler left is known however late a solver reads it") {
    // On a busy machine the connection has long been broken when the solver comes to look.
    const std::string transport = GENERATE("shm", "ipc", "tcp");
    const TemporaryFolder folder;
    auto host = std::make_unique<Host>(options_for(transport, folder, {"surface"}));
    std::promise<void> gone;
    auto solver = std::async(std::launch::async, [&, endpoint = host->endpoint()] {
        Participant link(surface_options(endpoint));
        link.announce(square_mesh());
        link.send(state_of(0, 0, 4));
        gone.get_future().wait();
        link.send(Progress{0, 0, 0.5, "a long step"});
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        link.wait_reply();
    });
    host->wait_join();
    host->wait_meshes();
    host->next();
    host->broadcast_error("E_PHYSICS", "the contact broke", "");
    host.reset();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    gone.set_value();
    CHECK_THROWS_WITH(solver.get(), "coupler: the contact broke");
}
