#include <catch2/catch.hpp>
#include <set>

#include "scenes.hpp"

using namespace undertow;
using namespace undertow::sph;

TEST_CASE("the lists of a cluster hold every particle and image within the support") {
    const int dimension = GENERATE(2, 3);
    Case input = scenes::water_box(0.01, {0.12, 0.05, 0.09}, dimension);
    scenes::add_basin(input, {0.12, 0.05, 0.09});
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.3, 0, 0);
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    const auto& records = fluid.neighbors().records();
    const auto& lists = fluid.neighbors().fluid_lists();
    const double support = fluid.support() / fluid.neighbors().fixed().unit;
    int missing = 0, within = 0;
    for (int i = 0; i < fluid.neighbors().fluid_count(); ++i) {
        const std::set<int> listed(lists.begin(i / lanes), lists.end(i / lanes));
        for (int j = 0; j < int(records.size()); ++j) {
            const double dx = double(records[i].x) - records[j].x,
                         dy = double(records[i].y) - records[j].y,
                         dz = double(records[i].z) - records[j].z;
            if (dx * dx + dy * dy + dz * dz > support * support) continue;
            ++within;
            missing += listed.count(j) == 0;
        }
    }
    CHECK(within > 10 * fluid.neighbors().fluid_count());
    CHECK(missing == 0);
}

TEST_CASE("lists stay complete until a particle has moved half the skin") {
    Case input = scenes::water_box(0.01, {0.08, 0.08, 0.08});
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 1;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.1, 1, 0);
    double t = 0;
    CHECK(fluid.refresh_neighbors(t));
    int steps = 0;
    while (!fluid.refresh_neighbors(t)) {
        fluid.pack(t);
        fluid.kick_and_drift(1e-5, 0, 0, false);
        t += 1e-5;
        ++steps;
    }
    // fastest particle below sqrt(3) m/s, half the skin 1 mm: at least 57 steps; at least 1 m/s: 100
    CHECK(steps >= 57);
    CHECK(steps <= 102);
}

TEST_CASE("particles keep their identity when they are sorted") {
    Case input = scenes::water_box(0.01, {0.1, 0.04, 0.07});
    FluidSystem fluid(input, 0.2);
    std::vector<Vec3> before(fluid.particles.size());
    for (std::size_t i = 0; i < before.size(); ++i)
        before[fluid.particles.id[i]] = {fluid.particles.x[i], fluid.particles.y[i],
                                         fluid.particles.z[i]};
    fluid.refresh_neighbors(0);
    for (std::size_t id = 0; id < before.size(); ++id) {
        const int i = fluid.index_of(static_cast<std::int64_t>(id));
        REQUIRE(i >= 0);
        CHECK(fluid.particles.x[i] == before[id][0]);
        CHECK(fluid.particles.z[i] == before[id][2]);
    }
}

TEST_CASE("a few particles thrown far do not cost memory, and one that leaves the domain is counted") {
    Case input = scenes::water_box(0.01, {0.05, 0.05, 0.05});
    input.sph.domain = Box{{-1e3, -1e3, -1e3}, {1e3, 1e3, 1e3}};
    FluidSystem fluid(input, 0.2);
    fluid.particles.x[3] = 900;
    const std::int64_t thrown = fluid.particles.id[7];
    fluid.particles.z[7] = 1500;
    CHECK(fluid.refresh_neighbors(0));
    CHECK(fluid.neighbors().grid().cells() < 100000);
    CHECK(fluid.particles.size() == 124);
    REQUIRE(fluid.removed().size() == 1);
    CHECK(fluid.removed()[0].id == thrown);
    CHECK(fluid.index_of(thrown) == -1);
}
