#include "contact/candidates.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "scene.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;

TEST_CASE("the search finds exactly the facets within radius + skin (brute force)") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> any(0, 1);
    for (double facet_size : {0.02, 0.1, 0.5}) {  // particles larger and smaller than facets
        Nodes plate = flat_plate(int(1 / facet_size), int(1 / facet_size), facet_size, 1);
        for (std::size_t n = 0; n < plate.mass.size(); ++n)
            plate.x[3 * n + 2] = 0.3 * std::sin(3 * plate.x[3 * n]) + 0.2 * plate.x[3 * n + 1] - 5;
        Surface surface = plate.surface();
        surface.move(plate.x, plate.v);
        Particles particles;
        for (int i = 0; i < 600; ++i)
            particles.add({1.2 * any(random) - 0.1, 1.2 * any(random) - 0.1, any(random) - 5.2},
                          {0, 0, 0}, 1, 0.02 + 0.03 * any(random), 1);
        const double skin = 0.015;
        FacetCells cells;
        CandidateList found;
        cells.search(particles.points(), surface, skin, found);

        std::size_t a = 0, pairs = 0;
        for (std::uint32_t i = 0; i < particles.size(); ++i) {
            std::vector<std::uint32_t> expected;
            for (std::uint32_t f = 0; f < surface.facets(); ++f)
                if (closest_point(Vec::Map(&particles.x[3 * i]), surface.shape(f)).distance <=
                    particles.radius[i] + skin)
                    expected.push_back(f);
            pairs += expected.size();
            if (expected.empty()) continue;
            REQUIRE(a < found.row.size());
            REQUIRE(found.row[a] == i);
            const std::vector<std::uint32_t> got(found.facet.begin() + found.start[a],
                                                 found.facet.begin() + found.start[a + 1]);
            REQUIRE(got == expected);
            ++a;
        }
        CHECK(a == found.row.size());
        CHECK(pairs == found.facet.size());
        CHECK(pairs > 30);  // the comparison is not about nothing
    }
}

TEST_CASE("a search far from the origin and an empty search work") {
    Nodes plate = flat_plate(3, 3, 0.1, 1);
    for (std::size_t n = 0; n < plate.mass.size(); ++n) plate.x[3 * n] -= 4000;
    Surface surface = plate.surface();
    surface.move(plate.x, plate.v);
    Particles particles;
    FacetCells cells;
    CandidateList found;
    cells.search(particles.points(), surface, 0.01, found);
    CHECK(found.row.empty());
    particles.add({-3999.85, 0.15, 0.03}, {0, 0, 0}, 1, 0.05, 1);
    particles.add({-7000, 0.15, 0.03}, {0, 0, 0}, 1, 0.05, 1);
    cells.search(particles.points(), surface, 0.01, found);
    CHECK(found.row == std::vector<std::uint32_t>{0});
}
