// Who comes to a run: seats, refusals, meshes, and ends before the first step.

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "running_pair.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {
std::atomic<bool> user_stops = false;
double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

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
    const double start = seconds_now();
    std::string code;
    try {
        host.wait_join();
    } catch (const PeerError& error) {
        code = error.code;
    }
    user.join();
    user_stops = false;
    CHECK(code == "E_STOP");
    CHECK(seconds_now() - start < 3);  // a wait of the system ends after a second
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
    const double start = seconds_now();
    CHECK_THROWS_WITH(host.wait_join(), Catch::Contains("the user stopped sph"));
    solver.join();
    user.join();
    user_stops = false;
    CHECK(code == "E_STOP");
    CHECK(seconds_now() - start < 3);
}

TEST_CASE("a program that will never come is not waited for") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint());
    options.loss = [] { return true; };  // the launcher says that a program of the run has ended
    options.join_timeout = 60;
    Host host(options);
    RawPeer early(Channel::End::solver, host.endpoint());
    early.send(hello_of("early", "particles"));
    early.channel().wait(0.1);
    std::string code, text;
    try {
        host.wait_join();
    } catch (const PeerError& error) {
        code = error.code, text = error.what();
    }
    CHECK(code == "E_PEER_LOST");
    CHECK(text.find("a program of this run ended before it joined: nobody joined as") == 0);
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
    CHECK(version.text.find("1.1") != std::string::npos);
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

TEST_CASE("who has another case is refused with the reason, and may come again") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.objection = [](const Hello& hello) {
        return hello.case_keys.front() == "sph.spacing = 0.1" ? std::string() : "other spacing";
    };
    Host host(options);
    std::thread waiting([&] { host.wait_join(); });
    Hello hello = hello_of("fem", "surface");
    hello.case_keys = {"sph.spacing = 0.2"};
    RawPeer wrong(Channel::End::solver, folder.endpoint());
    wrong.send(hello);
    const Error error = wrong.expect<Error>();
    hello.case_keys = {"sph.spacing = 0.1"};
    RawPeer right(Channel::End::solver, folder.endpoint());
    right.send(hello);
    waiting.join();
    CHECK(error.code == "E_INPUT");
    CHECK(error.text == "other spacing");
    CHECK(right.expect<Welcome>().version == std::array<int, 2>{1, 1});
}

TEST_CASE("who does not tell its case is not asked") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.objection = [](const Hello&) { return std::string("never"); };
    Host host(options);
    RawPeer fem(Channel::End::solver, folder.endpoint());
    Hello hello = hello_of("fem", "surface");
    hello.version = {1, 0};
    fem.send(hello);
    host.wait_join();
    CHECK(fem.expect<Welcome>().version == std::array<int, 2>{1, 0});
}

TEST_CASE("a refusal for another case stands in the sentence of the time-out") {
    TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.objection = [](const Hello&) { return std::string("other"); };
    options.join_timeout = 0.5;
    Host host(options);
    RawPeer fem(Channel::End::solver, folder.endpoint());
    Hello hello = hello_of("fem", "surface");
    hello.case_keys = {"a = 1"};
    fem.send(hello);
    CHECK_THROWS_WITH(
        host.wait_join(),
        Catch::Contains("nobody joined as surface, fem was refused for another case,"));
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
