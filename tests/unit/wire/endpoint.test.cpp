// Where the coupler listens, and who else may.

#include "wire/endpoint.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "peers.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::wire;

namespace {

mode_t mode_of(const std::filesystem::path& path) {
    struct stat status {};
    REQUIRE(stat(path.c_str(), &status) == 0);
    return status.st_mode & 0777;
}

}  // namespace

TEST_CASE("addresses of other machines are refused") {
    for (const std::string endpoint :
         {"tcp://0.0.0.0:5555", "tcp://*:5555", "tcp://192.168.1.7:5555", "tcp://localhost:5555",
          "tcp://127.0.0.1.example.org:1"}) {
        INFO(endpoint);
        CHECK_THROWS_AS(Host(host_options(endpoint)), InputError);
        CHECK_THROWS_AS(Participant(surface_options(endpoint)), InputError);
        CHECK_THROWS_WITH(check_endpoint(endpoint), Catch::Contains("CURVE keys"));
    }
    CHECK_NOTHROW(check_endpoint("tcp://127.0.0.1:5555"));
}

TEST_CASE("an endpoint that is no address is refused") {
    for (const std::string endpoint :
         {"", "coupler.sock", "ipc://", "ipc://@abstract", "ipc:///tmp/", "pgm://127.0.0.1:5555"}) {
        INFO(endpoint);
        CHECK_THROWS_AS(check_endpoint(endpoint), InputError);
    }
    CHECK_THROWS_WITH(check_endpoint("ipc:///" + std::string(150, 'a')),
                      Catch::Contains("the system takes 107"));
}

TEST_CASE("a second coupler on the endpoint is told whose it is") {
    TemporaryFolder folder;
    const Host first(host_options(folder.endpoint()));
    try {
        const Host second(host_options(folder.endpoint()));
        FAIL("bound twice");
    } catch (const PeerError& error) {
        CHECK(error.code == "E_IO");
        CHECK(std::string(error.what()).find("in use by process " + std::to_string(getpid())) !=
              std::string::npos);
    }
    // The first is undisturbed.
    CHECK(std::filesystem::exists(folder.path / "coupler.sock"));
}

TEST_CASE("a busy tcp port is an error, not silence") {
    const Host first(host_options("tcp://127.0.0.1:0"));
    CHECK_THROWS_AS(Host(host_options(first.endpoint())), PeerError);
}

TEST_CASE("socket and lock of a killed run are replaced silently") {
    TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        const Host host(host_options(folder.endpoint()));
        raise(SIGKILL);
        _exit(1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFSIGNALED(status));
    REQUIRE(std::filesystem::exists(folder.path / "coupler.sock"));
    REQUIRE(std::filesystem::exists(folder.path / "coupler.sock.lock"));
    const Host host(host_options(folder.endpoint()));
    std::ifstream lock(folder.path / "coupler.sock.lock");
    pid_t owner = 0;
    lock >> owner;
    CHECK(owner == getpid());
}

TEST_CASE("nothing is left behind by a run that ends") {
    TemporaryFolder folder;
    { const Host host(host_options(folder.endpoint())); }
    CHECK(std::filesystem::is_empty(folder.path));
}

TEST_CASE("the socket and a folder made for it are the owner's alone") {
    TemporaryFolder folder;
    const auto inner = folder.path / "run";
    const Host host(host_options("ipc://" + (inner / "coupler.sock").string()));
    CHECK(mode_of(inner) == 0700);
    CHECK((mode_of(inner / "coupler.sock") & 077) == 0);
    CHECK((mode_of(inner / "coupler.sock.lock") & 077) == 0);
}

TEST_CASE("a folder that others can write to is refused") {
    TemporaryFolder folder;
    REQUIRE(chmod(folder.path.c_str(), 0777) == 0);
    CHECK_THROWS_WITH(Host(host_options(folder.endpoint())), Catch::Contains("chmod 700"));
}

TEST_CASE("a file that is not a socket is not removed") {
    TemporaryFolder folder;
    std::ofstream(folder.path / "coupler.sock") << "precious";
    CHECK_THROWS_AS(Host(host_options(folder.endpoint())), InputError);
    CHECK(std::filesystem::exists(folder.path / "coupler.sock"));
}
