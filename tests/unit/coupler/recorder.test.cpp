#include "coupler/recorder.hpp"

#include <unistd.h>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

using namespace undertow;
using namespace undertow::coupler;
using contact::PenaltyContact;
using contact::Points;

namespace {

/// Columns of a CSV by name; '#' lines are skipped.
std::map<std::string, std::vector<double>> read_csv(const std::string& path) {
    std::ifstream file(path);
    std::string line, cell;
    std::vector<std::string> names;
    std::map<std::string, std::vector<double>> columns;
    while (std::getline(file, line)) {
        if (line.empty() || line[0] == '#') continue;
        std::stringstream cells(line);
        std::size_t i = 0;
        const bool header = names.empty();
        while (std::getline(cells, cell, ',')) {
            if (header)
                names.push_back(cell);
            else
                columns[names[i++]].push_back(std::stod(cell));
        }
    }
    return columns;
}

}  // namespace

TEST_CASE("rows lose nothing: impulse, phases, patches and moments of a pressed plate") {
    const std::string folder =
        (std::filesystem::temp_directory_path() / ("recorder." + std::to_string(getpid())))
            .string();
    std::filesystem::create_directories(folder);
    Case input;
    input.time.end = 1;
    input.output.history_every = 0.01;  // ten steps per row
    PressurePatch patch;
    patch.name = "P1";
    patch.box = {{0, 0, -1}, {0.5, 1, 1}};  // holds the first particle only
    patch.area = 0.5;
    PressurePatch edge = patch;  // its edge cuts a quarter off the first particle's footprint
    edge.name = "P2";
    edge.box.max[0] = 0.3;
    PressurePatch above = patch;  // at the right place, but off the surface
    above.name = "P3";
    above.box.min[2] = 0.05;
    input.coupling.patch = {patch, edge, above};
    const JointSurface plate{
        {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {1e6, 1e6, 1e6, 1e6}, {0, 1, 2, 3}, {0}, {"plate"}};
    contact::LawSettings law;
    law.eta = 0;
    PenaltyContact contact(contact::Surface(plate.quad, plate.mass), law);
    const std::vector<double> x{0.25, 0.5, 0.09, 0.75, 0.5, 0.08}, v(6, 0), mass{1, 1},
        radius{0.1, 0.1}, stiffness{1e3, 1e3}, still(12, 0);
    const std::vector<std::uint64_t> id{1, 2};
    const std::vector<std::uint32_t> phase{1, 0};
    contact.rebuild(Points{x, v, mass, radius, stiffness, id}, 0.01, plate.x, still);

    {
        Recorder recorder(folder, input, plate, {"water", "slide"});
        double t = 0;
        for (int n = 0; n < 25; ++n) {
            if (n > 0) contact.update(x, v, plate.x, still);
            contact.compute_forces(1e-3);
            recorder.record({t, 1e-3}, contact, phase);
            t += 1e-3;
        }
        recorder.finish(contact);
        CHECK(recorder.total_force() == Approx(30));  // 1e3 N/m (0.01 + 0.02) m
        CHECK(recorder.contact_time() == Approx(0.025));
        CHECK(recorder.deepest() == Approx(0.2));
    }
    auto forces = read_csv(folder + "/forces.csv");
    CHECK(forces["t [s]"].size() == 4);  // t = 0, 0.01, 0.02 and the last step
    CHECK(forces["plate.fz [N]"].back() == Approx(-30));
    // 25 steps of 1 ms, the first kick is half a step.
    CHECK(forces["plate.jz [N s]"].back() == Approx(-30 * 0.0245));
    CHECK(forces["plate.water.fz [N]"].back() == Approx(-20));
    CHECK(forces["plate.slide.fz [N]"].back() == Approx(-10));
    CHECK(forces["plate.my [N m]"].back() == Approx(10 * 0.25 + 20 * 0.75));  // -x fz
    auto patches = read_csv(folder + "/patches.csv");
    CHECK(patches["P1 [Pa]"].back() == Approx(10 / 0.5));
    CHECK(patches["P2 [Pa]"].back() == Approx(0.75 * 10 / 0.5));
    CHECK(patches["P3 [Pa]"].back() == 0);
    CHECK(read_csv(folder + "/energy.interface.csv")["contacts"].back() == 2);
    std::filesystem::remove_all(folder);
}
