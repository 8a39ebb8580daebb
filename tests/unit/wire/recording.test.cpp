// A recorded session plays the coupler's part again, and knows whether the solver still says the
// same.

#include <catch2/catch.hpp>
#include <fstream>
#include <future>

#include "peers.hpp"
#include "wire/errors.hpp"
#include "wire/recording.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

constexpr std::int64_t n_steps = 5;

struct Played {
    std::vector<double> forces, times;
    std::string verdict;
};

/// A surface solver whose velocities are moved by `odd` in step 3.
Played play_surface(const std::string& endpoint, double odd = 0, std::int64_t patience = 100) {
    ParticipantOptions options = surface_options(endpoint);
    Participant link(options);
    link.announce(square_mesh());
    Played played;
    double t = link.welcome().t0;
    StepReply reply;
    for (std::int64_t n = 0; n < patience; ++n) {
        State state = state_of(n, t, 4, 0.1 * double(n));
        if (n == 3) state.v[4] += odd;
        state.wait = link.waited();
        link.send(std::move(state));
        link.wait_reply(reply);
        if (reply.finish) {
            link.say_goodbye(n);
            break;
        }
        played.forces.push_back(reply.force->f.at(2));
        played.times.push_back(t = reply.force->t1);
    }
    played.verdict = link.replay_verdict();
    return played;
}

Played record(const TemporaryFolder& folder, const std::string& transport) {
    HostOptions options = options_for(transport, folder, {"surface"});
    options.record_in = folder.path;
    Host host(options);
    auto solver = std::async(std::launch::async, [&] { return play_surface(host.endpoint()); });
    host.wait_join();
    host.wait_meshes();
    double t = 0;
    for (std::int64_t n = 0;; ++n) {
        host.next();
        if (n == n_steps) break;
        host.send(0, force_of(n, t, 0.25, 4, double(n) + 0.5));
        t += 0.25;
    }
    host.finish(n_steps, "done");
    return solver.get();
}

std::string code_of(const auto& action) {
    try {
        action();
    } catch (const PeerError& error) {
        return error.code;
    }
    return "";
}

}  // namespace

TEST_CASE("a recorded session plays the coupler's part again, in every bit") {
    TemporaryFolder folder;
    const std::string transport = GENERATE("shm", "ipc", "tcp");
    const Played live = record(folder, transport);
    CHECK(live.forces.size() == n_steps);
    CHECK(live.verdict.empty());
    const std::string recording = "replay://" + recording_of(folder.path, "fem");
    const Played again = play_surface(recording);
    CHECK(again.forces == live.forces);
    CHECK(again.times == live.times);
    CHECK(again.verdict == "replay: every message is the recorded one, bit by bit");
    const Played other = play_surface(recording, 1e-16);  // two bits
    CHECK(other.forces == live.forces);
    CHECK(other.verdict ==
          "replay: STATE(3) was the first message that differs from the recording");
}

TEST_CASE("a solver that leaves the recorded course is told so") {
    TemporaryFolder folder;
    record(folder, "ipc");
    const std::string path = recording_of(folder.path, "fem"), endpoint = "replay://" + path;
    CHECK(code_of([&] {  // a particle solver waits for a SURFACE after its mesh
              Participant link(particle_options(endpoint));
              link.announce(particle_mesh());
          }) == "E_MESH");
    CHECK(code_of([&] {
              Participant link(surface_options(endpoint));
              link.announce(square_mesh());
              link.announce(square_mesh("another"));
          }) == "E_STATE");
    CHECK_THROWS_AS(play_surface(endpoint + "x"), InputError);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    CHECK(code_of([&] { play_surface(endpoint); }) == "E_IO");
    std::ofstream(path) << "some text, which is no recording";
    CHECK_THROWS_WITH(play_surface(endpoint), Catch::Contains("is no recording"));
}

TEST_CASE("a fingerprint changes with any bit of any array") {
    Message message = state_of(1, 0, 3, 0.5);
    Frames frames;
    encode(message, frames);
    const std::uint64_t before = fingerprint(frames);
    for (double& number : std::get<State>(message).v) {
        number += 1e-16;
        encode(message, frames);
        CHECK(fingerprint(frames) != before);
        number = 0.5;
    }
    encode(message, frames);
    CHECK(fingerprint(frames) == before);
}
