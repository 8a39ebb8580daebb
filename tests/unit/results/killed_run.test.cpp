// A run that is killed (kill -9, power, out of memory) keeps every output step it had finished.

#include <signal.h>
#include <sys/wait.h>
#include <catch2/catch.hpp>

#include <thread>

#include "read_back.hpp"
#include "results/field_file.hpp"
#include "results/history.hpp"

using namespace undertow;

namespace {

/// Appends steps for ever and reports each finished one through the pipe.
[[noreturn]] void write_until_killed(const std::string& path, int report) {
    ParticleFile file(path);
    const std::size_t n = 2000;
    const std::vector<double> x(3 * n, 1.0);
    std::vector<double> p(n);
    const std::vector<std::int64_t> id(n);
    for (int step = 0;; ++step) {
        std::fill(p.begin(), p.end(), step);
        file.append(step, x, id, {{"pressure", "Pa", 1, p}});
        if (write(report, &step, sizeof step) != sizeof step) _exit(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the solver computes
    }
}

}  // namespace

TEST_CASE("kill -9 between outputs loses no finished step") {
    for (int repeat = 0; repeat < 5; ++repeat) {
        read_back::Folder folder;
        int ends[2];
        REQUIRE(pipe(ends) == 0);
        const pid_t child = fork();
        if (child == 0) write_until_killed(folder.file("sph"), ends[1]);
        int finished = -1;
        for (int i = 0; i < 4 + repeat; ++i)
            REQUIRE(read(ends[0], &finished, sizeof finished) == sizeof finished);
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        close(ends[0]);
        close(ends[1]);

        const std::string path = folder.file("sph.vtkhdf");
        const auto times = read_back::dataset(path, "/VTKHDF/Steps/Values");
        REQUIRE(times.values.size() >= static_cast<std::size_t>(finished) + 1);
        char view[64];
        std::snprintf(view, sizeof view, "/Views/%05d/PointData/pressure", finished);
        const auto pressure = read_back::dataset(path, view);
        REQUIRE(pressure.values.size() == 2000);
        CHECK(pressure.values.back() == finished);
        CHECK(read_back::text(folder.file("sph.xdmf")).find("</Xdmf>") != std::string::npos);
    }
}

TEST_CASE("kill -9 keeps the rows of a history that were flushed") {
    read_back::Folder folder;
    const std::string path = folder.file("forces.csv");
    const pid_t child = fork();
    if (child == 0) {
        History history(path, {"force on the wall"}, {"t [s]", "wall.fx [N]"});
        for (int i = 0; i < 100; ++i) history.row(std::vector<double>{0.1 * i, 2.0 * i});
        history.flush();
        kill(getpid(), SIGKILL);
    }
    waitpid(child, nullptr, 0);
    CHECK(read_back::text(path).find("9.9,198\n") != std::string::npos);
}
