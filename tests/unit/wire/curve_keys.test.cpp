// Keys: friends speak encrypted, others are refused soon and in words.

#include <sys/stat.h>
#include <zmq.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <future>

#include "peers.hpp"
#include "wire/curve_keys.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

void write_pair(const std::filesystem::path& folder, const std::string& name) {
    char open[41], secret[41];
    REQUIRE(zmq_curve_keypair(open, secret) == 0);
    const std::string file = folder / (name + ".key");
    std::ofstream(file) << "public " << open << "\nsecret " << secret << "\n";
    chmod(file.c_str(), 0600);
    std::ofstream(folder / (name + ".pub")) << "public " << open << "\n";
}

/// Keys of coupler and fem, and a coupler that waits for fem.
struct LockedRun {
    explicit LockedRun(double join_timeout = 10) {
        for (const char* name : {"coupler", "fem", "sph"}) write_pair(keys.path, name);
        HostOptions options = host_options("tcp://127.0.0.1:0", {"surface"});
        options.curve = keys.path;
        options.join_timeout = join_timeout;
        host = std::make_unique<Host>(options);
    }
    /// What a participant with the keys of `folder` reads when it knocks; empty when it gets in.
    std::string knock(const std::string& folder, const std::string& name = "fem") {
        ParticipantOptions options = surface_options(host->endpoint(), name);
        options.curve = folder;
        auto answer = std::async(std::launch::async, [options]() -> std::string {
            try {
                Participant link(options);
                return "";
            } catch (const PeerError& error) {
                return error.code + ": " + error.what();
            }
        });
        try {
            host->wait_join();
        } catch (const PeerError& error) {
            at_coupler = error.what();
        }
        return answer.get();
    }
    TemporaryFolder keys;
    std::unique_ptr<Host> host;
    std::string at_coupler;
};

}  // namespace

TEST_CASE("who has the coupler's key and whose key the coupler has gets in") {
    LockedRun run;
    CHECK(run.knock(run.keys.path) == "");
    CHECK(run.at_coupler == "");
}

TEST_CASE("a stranger's key is refused in words on both sides, soon") {
    LockedRun run(1.0);
    TemporaryFolder other;
    for (const char* name : {"coupler", "fem"}) write_pair(other.path, name);
    std::filesystem::copy_file(run.keys.path / "coupler.pub", other.path / "coupler.pub",
                               std::filesystem::copy_options::overwrite_existing);
    CHECK_THAT(run.knock(other.path), Catch::StartsWith("E_KEY: ") &&
                                          Catch::Contains("does not take the key"));
    CHECK_THAT(run.at_coupler, Catch::Contains("refused for their keys"));
}

TEST_CASE("a coupler that has another key than expected is not spoken to") {
    LockedRun run(1.0);
    TemporaryFolder other;
    write_pair(other.path, "coupler");
    for (const char* file : {"fem.key", "fem.pub"})
        std::filesystem::copy_file(run.keys.path / file, other.path / file);
    CHECK_THAT(run.knock(other.path), Catch::StartsWith("E_KEY: "));
}

TEST_CASE("without a key nobody gets in, and nobody sits on another one's chair") {
    LockedRun run(1.0);
    CHECK_THAT(run.knock(""), Catch::StartsWith("E_KEY: ") && Catch::Contains("--keys"));
    LockedRun second(1.0);
    std::filesystem::copy_file(second.keys.path / "sph.key", second.keys.path / "impostor.key");
    CHECK_THAT(second.knock(second.keys.path, "impostor"),
               Catch::StartsWith("E_KEY: ") && Catch::Contains("came with the key of 'sph'"));
}

TEST_CASE("keys that are missing, spoiled or readable by others are named") {
    TemporaryFolder folder;
    CHECK_THROWS_WITH(keys_of_participant(folder.path, "fem"), Catch::Contains("fem.key"));
    write_pair(folder.path, "coupler");
    CHECK_THROWS_WITH(keys_of_coupler(folder.path), Catch::Contains("nobody could join"));
    write_pair(folder.path, "fem");
    CHECK(keys_of_coupler(folder.path).friends.at(0).name == "fem");
    CHECK(keys_of_participant(folder.path, "fem").coupler ==
          keys_of_coupler(folder.path).own_public);
    chmod((folder.path / "fem.key").c_str(), 0644);
    CHECK_THROWS_WITH(keys_of_participant(folder.path, "fem"), Catch::Contains("chmod 600"));
    std::ofstream(folder.path / "fem.pub") << "public short\n";
    CHECK_THROWS_WITH(keys_of_coupler(folder.path), Catch::Contains("fem.pub"));
}
