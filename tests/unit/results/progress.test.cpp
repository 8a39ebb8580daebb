#include "results/progress.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "read_back.hpp"
#include "results/terminal_line.hpp"

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

TEST_CASE("a terminal of 80 columns shows when a coupled run will end, and cuts no part in two") {
    ProgressFigures figures{.t = 0.03462,
                            .t_end = 0.2,
                            .n = 2653,
                            .dt = 1.3e-5,
                            .limiter = "fem: hexahedron 62 of block",
                            .particle_steps = 2.3e6,
                            .element_steps = 1.7e5,
                            .force = 615,
                            .waiting = "waits for sph 76 %, fem 1 %, both 13 %"};
    const std::string text = line_text(figures, 4.4e5, 3.4e4, 4830, "  kept t 0.03 s, 12 s ago");
    const std::string shown(whole_parts(text, 79));
    CHECK(shown == "[###-----------------]  17 %  t 0.03462/0.2 s  ETA 80:30 min  step 2653");
    CHECK(whole_parts(text, text.size()) == text);
    // two spaces that begin right behind the last column part it there
    CHECK(whole_parts("one  two  three", 8) == "one  two");
    CHECK(whole_parts("one  two  three", 7) == "one");
    CHECK(whole_parts("without a gap", 5) == "witho");
    // what holds the steps up is seen as well
    figures.doing = "writing step_000002653";
    CHECK(whole_parts(line_text(figures, 4.4e5, 3.4e4, 4830, ""), 120).find(figures.doing) !=
          std::string_view::npos);
}
