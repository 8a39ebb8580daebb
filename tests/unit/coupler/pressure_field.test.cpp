#include "coupler/pressure_field.hpp"

#include <unistd.h>
#include <catch2/catch.hpp>
#include <filesystem>

using namespace undertow;
using namespace undertow::coupler;
using contact::PenaltyContact;

TEST_CASE("facet pressure is impulse over time and area, its peak the largest of any step") {
    const auto folder =
        std::filesystem::temp_directory_path() / ("pressure." + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    // A quad of 2 m2 and a triangle of 1 m2; three particles on the first, one on the second.
    const JointSurface plate{{0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 4, 0, 0},
                             std::vector<double>(5, 1e6),
                             {0, 1, 2, 3, 1, 4, 2, 2},
                             {0, 0},
                             {"plate"}};
    const double l0 = 0.1, k = 1e5;
    std::vector<double> x{0.5, 0.5, 0.09, 1.2, 0.5, 0.09, 1.6, 0.4, 0.12, 2.5, 0.3, 0.08}, v(12, 0),
        at_rest(15, 0);
    const std::vector<double> mass(4, 1), radius(4, l0), stiffness(4, k);
    const std::vector<std::uint64_t> id{1, 2, 3, 4};
    contact::LawSettings law;
    law.eta = 0;
    PenaltyContact contact(contact::Surface(plate.quad, plate.mass), law);
    contact.rebuild({x, v, mass, radius, stiffness, id}, 0.1, plate.x, at_rest);
    PressureField field(folder.string(), plate);
    field.write(0, plate.x);
    CHECK(field.mean() == std::vector<double>{0, 0});  // nothing has pressed yet

    // Kicks of 0.5, 1 and 1 ms; the first particle is off during the last step.
    for (int n = 0; n < 3; ++n) {
        x[2] = n < 2 ? 0.09 : 0.2;
        x[11] = n == 1 ? 0.07 : 0.08;
        contact.update(x, v, plate.x, at_rest);
        contact.compute_forces(1e-3);
        contact.settle();
        field.count(contact);
    }
    field.write(3e-3, plate.x);
    CHECK(field.mean()[0] == Approx((0.5 * 2000 + 1 * 2000 + 1 * 1000) / 2.5 / 2));
    CHECK(field.peak()[0] == Approx(2000.0 / 2));
    CHECK(field.mean()[1] == Approx((0.5 * 2000 + 1 * 3000 + 1 * 2000) / 2.5 / 1));
    CHECK(field.peak()[1] == Approx(3000.0));

    field.write(3e-3, plate.x);  // a time that is there already
    CHECK(field.peak()[1] == Approx(3000.0));
    field.write(4e-3, plate.x);  // nothing has happened since
    CHECK(field.peak() == std::vector<double>{0, 0});
    CHECK(std::filesystem::exists(folder / "contact.xdmf"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("an interval of its own is met by the first step that reaches a multiple of it") {
    const auto folder =
        std::filesystem::temp_directory_path() / ("pressure.due." + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const JointSurface plate{
        {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0}, std::vector<double>(4, 1e6), {0, 1, 2, 3}, {0}, {"plate"}};
    PressureField own(folder.string(), plate, 0.01);
    std::vector<double> written;
    for (double t = 0; t < 0.0451; t += 0.003) {  // 0.012 is the first behind 0.01, 0.03 meets its multiple
        if (!own.due(t, false)) continue;
        own.write(t, plate.x);
        written.push_back(t);
    }
    REQUIRE(written.size() == 5);
    const double expected[] = {0, 0.012, 0.021, 0.03, 0.042};
    for (std::size_t k = 0; k < 5; ++k) CHECK(written[k] == Approx(expected[k]));
    CHECK_FALSE(own.due(0.0421, true));  // a common output time is none of its own

    const PressureField common(folder.string(), plate);
    CHECK(common.due(0.0421, true));
    CHECK_FALSE(common.due(1, false));
    std::filesystem::remove_all(folder);
}
