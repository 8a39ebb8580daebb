#include "results/history.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "read_back.hpp"
#include "results/summary.hpp"
#include "wire/errors.hpp"

using namespace undertow;

TEST_CASE("a history has notes, a column line and rows") {
    read_back::Folder folder;
    const std::string path = folder.file("gauges.csv");
    {
        History history(path, {"water levels", "no filter"}, {"t [s]", "H1 [m]"});
        history.row(std::vector<double>{0.001, 0.3});
        History moved = std::move(history);
        moved.row(std::vector<double>{0.002, 1.0 / 3});
        CHECK_THROWS_AS(moved.row(std::vector<double>{1}), std::logic_error);
    }
    CHECK(read_back::text(path) ==
          "# water levels\n# no filter\nt [s],H1 [m]\n0.001,0.3\n0.002,0.333333333\n");
}

TEST_CASE("a history in a missing folder is the user's error") {
    CHECK_THROWS_AS(History("/nonexistent-folder/a.csv", {}, {"t [s]"}), InputError);
}

TEST_CASE("a summary nests by dots, keeps types and is valid JSON even for NaN") {
    read_back::Folder folder;
    Summary summary;
    summary.set("steps", std::int64_t{9007199254740993});  // 2^53 + 1: no detour through double
    summary.set("sph.particles", std::int64_t{27000});
    summary.set("sph.particle_steps_per_s", 1.4e7);
    summary.set("ok", true);
    summary.set("limiter", "sph: \"sound\"");
    summary.set("residual", std::nan(""));
    summary.write(folder.file("summary.sph.json"));
    const auto read = nlohmann::json::parse(read_back::text(folder.file("summary.sph.json")));
    CHECK(read["steps"].get<std::int64_t>() == 9007199254740993);
    CHECK(read["sph"]["particles"] == 27000);
    CHECK(read["sph"]["particle_steps_per_s"] == 1.4e7);
    CHECK(read["ok"] == true);
    CHECK(read["limiter"] == "sph: \"sound\"");
    CHECK(read["residual"].is_null());
    CHECK_FALSE(std::filesystem::exists(folder.file("summary.sph.json.tmp")));
}

TEST_CASE("rows are due once per multiple of the interval, whatever the steps") {
    undertow::HistoryTimes every_tenth(0.1, 1);
    int rows = 0;
    for (int n = 0; n <= 1000; ++n) rows += every_tenth.due(n * 0.001);
    CHECK(rows == 11);  // 0, 0.1, ... 1: a multiple missed by round-off is not put off by a step

    undertow::HistoryTimes long_steps(0.1, 1);
    CHECK(long_steps.due(0));
    CHECK(long_steps.due(0.55));  // five multiples passed: one row
    CHECK_FALSE(long_steps.due(0.59));
    CHECK(long_steps.due(0.6));

    undertow::HistoryTimes by_default(0, 2000);
    CHECK(by_default.due(0));
    CHECK_FALSE(by_default.due(0.5));
    CHECK(by_default.due(1));
}
