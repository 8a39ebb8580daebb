#include "results/progress.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "read_back.hpp"

using namespace undertow;

TEST_CASE("the status file tells where a run stands and when it will end") {
    read_back::Folder folder;
    const std::string path = folder.file("status.json");
    ProgressLine line(true, path);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ProgressFigures figures{.t = 0.25,
                            .t_end = 1,
                            .n = 100,
                            .dt = 2.5e-3,
                            .limiter = "sph: sound",
                            .particle_steps = 1e6,
                            .element_steps = 0,
                            .force = 12,
                            .waiting = ""};
    line.update(figures);
    const auto running = nlohmann::json::parse(read_back::text(path));
    CHECK(running["state"] == "running");
    CHECK(running["step"] == 100);
    CHECK(running["limiter"] == "sph: sound");
    // A quarter took the time since the start, so three times that is left.
    CHECK(running["eta_s"].get<double>() ==
          Approx(3 * running["wall_s"].get<double>()).epsilon(1e-6));

    line.finish(figures);
    CHECK(nlohmann::json::parse(read_back::text(path))["state"] == "interrupted");

    figures.t = 1;
    line.finish(figures);
    const auto finished = nlohmann::json::parse(read_back::text(path));
    CHECK(finished["state"] == "finished");
    CHECK(finished["eta_s"] == 0);
}

TEST_CASE("the status tells what holds the steps up, and the last checkpoint from then on") {
    read_back::Folder folder;
    const std::string path = folder.file("status.json");
    ProgressLine line(true, path);
    ProgressFigures figures;
    line.update(figures);
    CHECK_FALSE(line.due());  // once a second
    figures.doing = "writing step_000000047";
    line.update_now(figures);
    const auto writing = nlohmann::json::parse(read_back::text(path));
    CHECK(writing["doing"] == "writing step_000000047");
    CHECK_FALSE(writing.contains("checkpoint"));

    line.kept("checkpoints/step_000000047", 0.25);
    figures.doing.clear();
    line.finish(figures);
    const auto finished = nlohmann::json::parse(read_back::text(path));
    CHECK_FALSE(finished.contains("doing"));
    CHECK(finished["checkpoint"]["folder"] == "checkpoints/step_000000047");
    CHECK(finished["checkpoint"]["t"] == 0.25);
}
