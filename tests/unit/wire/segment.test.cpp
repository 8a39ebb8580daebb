// The data plane in shared memory: what it carries, who may open it, what happens when the other
// end dies, lies, or has none.

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstring>
#include <future>
#include <thread>

#include "peers.hpp"
#include "wire/errors.hpp"
#include "wire/segment.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

/// An id of this process's own, so that tests running beside it do not meet.
std::uint64_t fresh_session() {
    static std::uint64_t count = 0;
    return std::uint64_t(getpid()) << 32 | 0x5e000000 | ++count;
}

std::string name_of(std::uint64_t session, const std::string& participant) {
    char text[40];
    std::snprintf(text, sizeof text, "/undertow-%016llx-",
                  static_cast<unsigned long long>(session));
    return text + participant;
}

bool exists(const std::string& name) {
    return std::filesystem::exists("/dev/shm" + name);
}

struct Ends {
    std::unique_ptr<Segment> coupler, solver;
};

Ends make_ends() {
    const std::uint64_t session = fresh_session();
    Ends ends;
    ends.coupler = Segment::create(session, "fem");
    ends.solver = Segment::open(session, "fem");
    REQUIRE(ends.coupler);
    REQUIRE(ends.solver);
    return ends;
}

/// A surface solver of four nodes until FINISH; dies by SIGKILL in step `die_at`.
void run_solver(const std::string& endpoint, const std::string& name, bool shared_memory,
                std::int64_t die_at = -1) {
    ParticipantOptions options = surface_options(endpoint, name);
    options.shared_memory = shared_memory;
    Participant link(options);
    link.announce(square_mesh(name));
    double t = 0;
    StepReply reply;
    for (std::int64_t n = 0;; ++n) {
        if (n == die_at) std::raise(SIGKILL);
        link.send(state_of(n, t, 4));
        link.wait_reply(reply);
        if (reply.finish) return link.say_goodbye(n);
        t = reply.force->t1;
    }
}

/// Grants n_steps steps to all participants.
void grant(Host& host, std::size_t n_participants, std::int64_t n_steps) {
    double t = 0;
    for (std::int64_t n = 0;; ++n) {
        for (std::size_t i = 0; i < n_participants; ++i) host.next();
        if (n == n_steps) return host.finish(n, "done");
        for (std::size_t i = 0; i < n_participants; ++i) host.send(i, force_of(n, t, 1e-3, 4));
        t = t + 1e-3;
    }
}

}  // namespace

TEST_CASE("a message crosses the segment with the bytes it has on the socket, whatever its size") {
    const Ends ends = make_ends();
    Frames frames;
    Message arrived;
    for (const std::size_t rows : {0, 1, 7, 2000, 3, 50000}) {
        REQUIRE(ends.coupler->reserve(state_bytes(rows), force_bytes(rows)));
        State state = state_of(3, 0.5, rows, 1.25);
        if (rows) state.v.back() = -7;
        const Message sent = state;
        encode(sent, frames);
        const std::string header = frames.header;
        CHECK_FALSE(ends.coupler->has_message());
        REQUIRE(ends.solver->write(frames));
        REQUIRE(ends.coupler->has_message());
        CHECK(ends.coupler->read(arrived) == header.size() + 48 * rows);
        CHECK_FALSE(ends.coupler->has_message());
        encode(arrived, frames);
        CHECK(frames.header == header);
        CHECK(std::get<State>(arrived).v == state.v);

        const Message force = force_of(3, 0.5, 1, rows, 2.5);
        encode(force, frames);
        REQUIRE(ends.coupler->write(frames));
        ends.solver->read(arrived);
        CHECK(std::get<Force>(arrived).f == std::vector<double>(3 * rows, 2.5));
    }
}

TEST_CASE("what does not fit the block is not written") {
    const Ends ends = make_ends();
    Frames frames;
    const Message state = state_of(0, 0, 10000);
    encode(state, frames);
    CHECK_FALSE(ends.solver->write(frames));  // no room has been made at all
    REQUIRE(ends.coupler->reserve(state_bytes(100), force_bytes(100)));
    CHECK_FALSE(ends.solver->write(frames));
    CHECK_FALSE(ends.coupler->has_message());
}

TEST_CASE("the name is gone as soon as both have mapped the segment") {
    const std::uint64_t session = fresh_session();
    const auto coupler = Segment::create(session, "fem");
    REQUIRE(coupler);
    CHECK(exists(name_of(session, "fem")));
    CHECK_FALSE(coupler->joined());
    const auto solver = Segment::open(session, "fem");
    REQUIRE(solver);
    CHECK(coupler->joined());
    CHECK_FALSE(exists(name_of(session, "fem")));
    CHECK(Segment::open(session, "fem") == nullptr);
}

TEST_CASE("a segment that nobody joined goes with the coupler") {
    const std::uint64_t session = fresh_session();
    Segment::create(session, "fem").reset();
    CHECK_FALSE(exists(name_of(session, "fem")));
}

TEST_CASE("a segment that is there already, open to others or of another session is not used") {
    const std::uint64_t session = fresh_session();
    const std::string name = name_of(session, "fem");
    const int descriptor = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    REQUIRE(descriptor >= 0);
    CHECK(Segment::create(session, "fem") == nullptr);
    REQUIRE(ftruncate(descriptor, 4096) == 0);
    REQUIRE(fchmod(descriptor, 0666) == 0);
    CHECK(Segment::open(session, "fem") == nullptr);
    CHECK(exists(name));  // not ours to remove
    REQUIRE(fchmod(descriptor, 0600) == 0);
    REQUIRE(ftruncate(descriptor, 8192) == 0);
    CHECK(Segment::open(session, "fem") == nullptr);
    REQUIRE(ftruncate(descriptor, 4096) == 0);
    CHECK(Segment::open(session, "fem") == nullptr);  // no magic, session 0
    close(descriptor);
    shm_unlink(name.c_str());
}

TEST_CASE("sizes in the segment are checked before they are believed") {
    const std::uint64_t session = fresh_session();
    const auto coupler = Segment::create(session, "fem");
    REQUIRE(coupler);
    const int descriptor = shm_open(name_of(session, "fem").c_str(), O_RDWR, 0);
    auto* words = static_cast<std::byte*>(
        mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0));
    close(descriptor);
    const auto solver = Segment::open(session, "fem");
    REQUIRE(coupler->reserve(state_bytes(4), force_bytes(4)));
    Frames frames;
    const Message state = state_of(0, 0, 4);
    encode(state, frames);
    REQUIRE(solver->write(frames));

    std::string whose = "shared memory: ";  // found here, before anything is read
    // Places in the page as docs/protocol.md has them, direction up.
    const auto poke = [&](std::size_t place, auto value) {
        std::memcpy(words + place, &value, sizeof value);
    };
    SECTION("header") {
        poke(64 + 12, std::uint32_t(70000));
    }
    SECTION("header beyond the block") {
        poke(64 + 12, std::uint32_t(60000));
    }
    SECTION("number of arrays") {
        poke(64 + 16, std::uint32_t(17));
    }
    SECTION("array") {
        poke(64 + 24, std::uint64_t(1) << 40);
    }
    SECTION("array, wrapping around") {
        poke(64 + 24, ~std::uint64_t(0) - 63);
    }
    SECTION("array that its shape does not give") {
        poke(64 + 24, std::uint64_t(90));
        whose = "STATE(0): the frame of array x has 90 bytes";  // found by the codec
    }
    Message message;
    try {
        coupler->read(message);
        FAIL("a wrong size was believed");
    } catch (const PeerError& error) {
        CHECK(error.code == "E_SHAPE");
        CHECK_THAT(error.what(), Catch::StartsWith(whose));
    }
    munmap(words, 4096);
}

TEST_CASE("a bell wakes who waits for any of several") {
    const Ends one = make_ends(), two = make_ends();
    const std::vector<Segment::Ring> rings{{one.coupler.get(), one.coupler->bell()},
                                           {two.coupler.get(), two.coupler->bell()}};
    CHECK(Segment::wait(rings, 0.01));  // nobody rang
    auto later = std::async(std::launch::async, [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        two.solver->ring();
    });
    CHECK_FALSE(Segment::wait(rings, 10));
    later.get();
    CHECK_FALSE(one.coupler->heard_of_socket());
    CHECK(two.coupler->heard_of_socket());
    CHECK_FALSE(two.coupler->heard_of_socket());
    CHECK_FALSE(Segment::wait(rings, 10));  // rang before the wait began
}

TEST_CASE("a participant without shared memory: everybody stays on the socket") {
    const bool first = GENERATE(true, false);
    const TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface", "surface"});
    options.welcome.session = fresh_session();
    Host host(options);
    auto one = std::async(std::launch::async, run_solver, folder.endpoint(), "one", first, -1);
    auto two = std::async(std::launch::async, run_solver, folder.endpoint(), "two", false, -1);
    host.wait_join();
    host.wait_meshes();
    CHECK_FALSE(host.shares_memory());
    grant(host, 2, 50);
    one.get();
    two.get();
}

TEST_CASE("no room for a name in shared memory: the run goes on by the socket") {
    const TemporaryFolder folder;
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.welcome.session = fresh_session();
    const std::string name = name_of(options.welcome.session, "one");
    const int descriptor = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    REQUIRE(descriptor >= 0);
    Host host(options);
    auto one = std::async(std::launch::async, run_solver, folder.endpoint(), "one", true, -1);
    host.wait_join();
    host.wait_meshes();
    CHECK_FALSE(host.shares_memory());
    grant(host, 1, 20);
    one.get();
    close(descriptor);
    shm_unlink(name.c_str());
}

TEST_CASE("a participant that dies at the segment is missed at once and leaves nothing behind") {
    const TemporaryFolder folder;
    const std::uint64_t session = fresh_session();
    const pid_t child = fork();
    if (child == 0) {
        run_solver(folder.endpoint(), "one", true, 20);
        _exit(0);
    }
    HostOptions options = host_options(folder.endpoint(), {"surface"});
    options.welcome.session = session;
    Host host(options);
    host.wait_join();
    host.wait_meshes();
    CHECK(host.shares_memory());
    auto last = std::chrono::steady_clock::now();
    try {
        double t = 0;
        for (std::int64_t n = 0;; ++n) {
            host.next();
            last = std::chrono::steady_clock::now();
            host.send(0, force_of(n, t, 1e-3, 4));
            t = t + 1e-3;
        }
    } catch (const PeerError& error) {
        CHECK(error.code == "E_PEER_LOST");
        CHECK(std::string(error.what()) == "one vanished in step 20; see its log");
    }
    // 50 ms of sleep at the bell; the rest is a busy machine
    CHECK(std::chrono::steady_clock::now() - last < std::chrono::seconds(2));
    waitpid(child, nullptr, 0);
    CHECK_FALSE(exists(name_of(session, "one")));
}

TEST_CASE("a coupler that dies at the segment is missed at once") {
    const TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        Host host(host_options(folder.endpoint(), {"surface"}));
        host.wait_join();
        host.wait_meshes();
        double t = 0;
        for (std::int64_t n = 0; n < 20; ++n, t = t + 1e-3) {
            host.next();
            host.send(0, force_of(n, t, 1e-3, 4));
        }
        host.next();
        std::raise(SIGKILL);
    }
    const auto start = std::chrono::steady_clock::now();
    CHECK_THROWS_WITH(run_solver(folder.endpoint(), "one", true),
                      Catch::Contains("vanished in step 20"));
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
    waitpid(child, nullptr, 0);
}

TEST_CASE("an error crosses the socket while the other end waits at the segment") {
    const TemporaryFolder folder;
    Host host(host_options(folder.endpoint(), {"surface"}));
    auto one = std::async(std::launch::async, [&] { run_solver(folder.endpoint(), "one", true); });
    host.wait_join();
    host.wait_meshes();
    double t = 0;
    for (std::int64_t n = 0; n < 5; ++n, t = t + 1e-3) {
        host.next();
        host.send(0, force_of(n, t, 1e-3, 4));
    }
    host.next();
    const auto start = std::chrono::steady_clock::now();
    host.broadcast_error("E_PHYSICS", "the contact broke", "");
    CHECK_THROWS_WITH(one.get(), "coupler: the contact broke");
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(2));
}

TEST_CASE("what dead couplers left in shared memory goes, what living ones hold stays") {
    const std::uint64_t session = 0x5eed0000dead;
    const auto path = [&](const std::string& name) {
        return std::filesystem::path("/dev/shm/undertow-00005eed0000dead-" + name);
    };
    const auto make_old = [&](const std::string& name) {
        const timespec long_ago[2] = {{1000, 0}, {1000, 0}};
        REQUIRE(utimensat(AT_FDCWD, path(name).c_str(), long_ago, 0) == 0);
    };
    // A coupler that is killed together with its participant, before either has removed the name.
    const pid_t child = fork();
    if (child == 0) {
        const auto segment = Segment::create(session, "dead");
        raise(SIGKILL);
    }
    waitpid(child, nullptr, 0);
    REQUIRE(std::filesystem::exists(path("dead")));
    const auto living = Segment::create(session, "living");
    Segment::sweep();
    CHECK(std::filesystem::exists(path("dead")));  // too young to be judged
    make_old("dead");
    make_old("living");
    CHECK(Segment::sweep() >= 1);
    CHECK(!std::filesystem::exists(path("dead")));
    CHECK(std::filesystem::exists(path("living")));
}
