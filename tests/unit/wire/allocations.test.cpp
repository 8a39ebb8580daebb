// After the first steps a running session allocates nothing: a step is a few microseconds, and memory
// stays what it is however many there are. A program of its own, as it replaces operator new.

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <thread>

#include "peers.hpp"
#include "wire/codec.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {
std::atomic<std::size_t> allocations = 0;
}
void* operator new(std::size_t size) {
    ++allocations;
    if (void* p = std::malloc(size)) return p;
    throw std::bad_alloc();
}
// the form that Catch uses: all must come from malloc, or sanitizers see two allocators mixed
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    ++allocations;
    return std::malloc(size);
}
void operator delete(void* p) noexcept {
    std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
    std::free(p);
}

namespace {

constexpr std::size_t n_nodes = 500;  // of each participant: 12 kB an array

/// A surface solver as they are: one State and one StepReply, used again each step.
void solve(const std::string& endpoint, const std::string& name) {
    Participant link(surface_options(endpoint, name));
    Mesh mesh = square_mesh(name);
    mesh.x.resize(3 * n_nodes);
    mesh.mass.resize(n_nodes, 1);
    link.announce(std::move(mesh));
    double t = link.welcome().t0;
    State state;
    StepReply reply;
    for (std::int64_t n = 0;; ++n) {
        state.n = n;
        state.t = t;
        state.dt_limit = 1e-3;
        state.limiter = "a limiter with a name beyond the short ones";
        state.x.assign(3 * n_nodes, double(n));
        state.v.assign(3 * n_nodes, 1.0);
        link.send(std::move(state));
        link.wait_reply(reply);
        if (reply.finish) return link.say_goodbye(n);
        t = reply.force->t1;
    }
}

double resident_kb() {
    std::ifstream file("/proc/self/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return 4 * resident;
}

struct Use {
    std::size_t allocations;
    double grown_kb;
};

/// Of `n_steps` steps after `n_warm`.
Use use_of_steps(const std::string& transport, std::int64_t n_warm, std::int64_t n_steps) {
    TemporaryFolder folder;
    Host host(options_for(transport, folder, {"surface", "surface"}));
    std::thread one(solve, host.endpoint(), "one"), two(solve, host.endpoint(), "two");
    host.wait_join();
    host.wait_meshes();
    REQUIRE(host.shares_memory() == (transport == "shm"));
    std::array<Message, 2> force{Force{}, Force{}};
    std::array<Received, 2> received;
    Use use{};
    double t = 0;
    const auto both = [&] {
        for (Received& any : received)
            while (!host.next_within(1.0, any)) {
            }
    };
    for (std::int64_t n = 0; n < n_warm + n_steps; ++n) {
        both();
        if (n == n_warm) {
            use.grown_kb = resident_kb();  // reading a file allocates
            use.allocations = allocations;
        }
        for (std::size_t i : {0, 1}) {
            Force& own = std::get<Force>(force[i]);
            own.n = n;
            own.dt = 0.125;
            own.t1 = t + 0.125;
            own.limiter = "another limiter with a long name";
            own.f.assign(3 * n_nodes, 0.25);
            host.send(i, std::move(force[i]));
        }
        t += 0.125;
    }
    use = {allocations - use.allocations, resident_kb() - use.grown_kb};
    both();
    host.finish(n_warm + n_steps, "done");
    one.join();
    two.join();
    return use;
}

}  // namespace

TEST_CASE("a step by shared memory allocates nothing, at either end") {
    CHECK(use_of_steps("shm", 20, 2000).allocations == 0);
}

TEST_CASE("a step by the socket allocates what the library needs for its frames, and gives it back") {
    const Use use = use_of_steps("ipc", 1000, 2000);
    // Two STATEs, two FORCEs. Above 16 kB of arrays a message moves into a parcel of its own.
    CHECK(double(use.allocations) / 2000 <= 12);
    CHECK(use.grown_kb < 1024);
}

TEST_CASE("decoding into a message of the same type allocates nothing") {
    Frames frames;
    const Message sent = state_of(3, 0.5, 200, 1.0);
    encode(sent, frames);
    Message message;
    const auto decode_it = [&] {
        decode(std::as_bytes(std::span(frames.header)),
               std::span(frames.arrays.data(), frames.n_arrays), message);
    };
    decode_it();
    const std::size_t before = allocations;
    for (int i = 0; i < 100; ++i) decode_it();
    CHECK(allocations == before);
}

TEST_CASE("a million steps by shared memory leave memory as it is", "[.long]") {
    const Use use = use_of_steps("shm", 1000, 1000000);
    std::printf("1,000,000 steps of two participants with 500 points each: %zu allocations, %+.0f kB\n",
                use.allocations, use.grown_kb);
    CHECK(use.allocations == 0);
    CHECK(use.grown_kb < 256);
}
