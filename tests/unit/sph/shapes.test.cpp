// Signed distances, STL files, laws of motion, flux.

#include "sph_solver/shapes/solid.hpp"

#include <stdlib.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "scenes.hpp"
#include "sph_solver/boundary/rigid_motion.hpp"
#include "sph_solver/flux_meter.hpp"
#include "sph_solver/shapes/stl_file.hpp"
#include "sph_solver/shapes/vectors.hpp"
#include "wire/errors.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

using Facets = std::vector<std::array<Vec3, 3>>;

/// A box of twelve facets, normals outward.
Facets box_facets(const Vec3& lo, const Vec3& hi) {
    const auto at = [&](int k) {
        return Vec3{k & 1 ? hi[0] : lo[0], k & 2 ? hi[1] : lo[1], k & 4 ? hi[2] : lo[2]};
    };
    const int quad[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                            {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    Facets facets;
    for (const auto& q : quad) {
        facets.push_back({at(q[0]), at(q[1]), at(q[2])});
        facets.push_back({at(q[0]), at(q[2]), at(q[3])});
    }
    return facets;
}

class StlFile {
 public:
    StlFile() {
        std::string name =
            (std::filesystem::temp_directory_path() / "undertow-stl-XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~StlFile() { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "body.stl").string(); }
    void write_text(const Facets& facets, const char* end = "endsolid\n") const {
        std::ofstream out(path());
        out << "solid body\n";
        for (const auto& f : facets) {
            out << "facet normal 0 0 0\nouter loop\n";
            for (const Vec3& x : f) out << "vertex " << x[0] << " " << x[1] << " " << x[2] << "\n";
            out << "endloop\nendfacet\n";
        }
        out << end;
    }
    void write_binary(const Facets& facets) const {
        std::ofstream out(path(), std::ios::binary);
        std::string head(80, ' ');
        head.replace(0, 5, "solid");  // as some programs do, although it is binary
        out.write(head.data(), 80);
        const auto n = static_cast<std::uint32_t>(facets.size());
        out.write(reinterpret_cast<const char*>(&n), 4);
        for (const auto& f : facets) {
            float values[12] = {};
            for (int k = 0; k < 9; ++k) values[3 + k] = static_cast<float>(f[k / 3][k % 3]);
            out.write(reinterpret_cast<const char*>(values), 48);
            out.write("\0\0", 2);
        }
    }
    std::string mistake() const {
        try {
            read_stl(path(), 1, {}, "case.toml: sph.body \"b\"");
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

 private:
    std::filesystem::path folder_;
};

}  // namespace

TEST_CASE("an STL box has the distances of the box, ASCII and binary, moved and scaled") {
    const StlFile file;
    const Facets facets = box_facets({0, 0, 0}, {1000, 500, 250});  // mm
    if (GENERATE(false, true))
        file.write_binary(facets);
    else
        file.write_text(facets);
    const Solid from_file({.stl = file.path(), .scale = 1e-3, .at = {1, 2, 3}}, false, "", "b");
    const Solid box({.box = Box{{1, 2, 3}, {2, 2.5, 3.25}}}, false, "", "b");
    CHECK(from_file.surface()->volume() == Approx(0.125));
    for (double x = 0.7; x < 2.4; x += 0.17)
        for (double y = 1.8; y < 2.8; y += 0.13)
            for (double z = 2.8; z < 3.5; z += 0.11) {
                const FromSurface a = from_file({x, y, z}), b = box({x, y, z});
                REQUIRE(a.distance == Approx(b.distance).margin(1e-6));
            }
}

TEST_CASE("a disc, a cylinder and a prism know their distance") {
    const Solid disc({.from = {1, -1, 2}, .to = {1, 1, 2}, .radius = 0.5}, true, "", "d");
    CHECK(disc({1, 0, 3}).distance == Approx(0.5));
    CHECK(disc({1.2, 0, 2}).distance == Approx(-0.3));
    CHECK(disc({1.2, 0, 2}).away[0] == Approx(1));
    const Solid pile({.from = {0, 0, 0}, .to = {0, 0, 1}, .radius = 0.5}, false, "", "p");
    CHECK(pile({0.8, 0, 1.4}).distance == Approx(0.5));  // off the rim: 0.3, 0.4
    CHECK(pile({0.1, 0, 0.95}).distance == Approx(-0.05));
    // corners either way round
    for (const bool turned : {false, true}) {
        std::vector<std::array<double, 2>> corner{{0, 0}, {4, 0}, {4, 3}};
        if (turned) std::reverse(corner.begin(), corner.end());
        const Solid wedge({.profile = corner}, true, "", "w");
        CHECK(wedge({2, 0, 1.5}).distance == Approx(0).margin(1e-12));  // on the slope
        CHECK(wedge({2, 0, 1.5}).away[2] == Approx(0.8));
        CHECK(wedge({2 - 0.6, 0, 1.5 + 0.8}).distance == Approx(1));
        CHECK(wedge({3, 0, 0.1}).distance == Approx(-0.1));
    }
}

TEST_CASE("what is wrong with an STL file is told in one sentence") {
    const StlFile file;
    Facets facets = box_facets({0, 0, 0}, {1, 1, 1});
    facets.pop_back();
    file.write_text(facets);
    CHECK_THAT(file.mistake(), Catch::Contains("the surface is open: 3 of its"));
    facets = box_facets({0, 0, 0}, {1, 1, 1});
    for (auto& f : facets) std::swap(f[1], f[2]);
    file.write_binary(facets);
    CHECK_THAT(file.mistake(), Catch::Contains("inside out") && Catch::Contains("-1 m3"));
    std::swap(facets[3][1], facets[3][2]);
    file.write_text(facets);
    CHECK_THAT(file.mistake(), Catch::Contains("turned over"));
    file.write_text(box_facets({0, 0, 0}, {1, 1, 1}), "");
    CHECK_THAT(file.mistake(), Catch::Contains("cut off"));
    std::ofstream(file.path()) << "ply\n";
    CHECK_THAT(file.mistake(), Catch::Contains("is not an STL file"));
    std::filesystem::remove(file.path());
    CHECK_THAT(file.mistake(), Catch::Contains("could not be opened"));
}

TEST_CASE("a table of positions is followed smoothly: accelerations stay bounded") {
    const StlFile folder;
    const std::string path = folder.path();
    {
        std::ofstream out(path);
        out << "t, x, y, z\n# a wave maker\n";
        for (int k = 0; k <= 80; ++k)  // sin(pi t), 20 rows a half wave
            out << 0.05 * k << ", " << 0.1 * std::sin(M_PI * 0.05 * k) << ", 0, 0\n";
    }
    const MotionTable table(path, 3, "b");
    for (double t = 0.2; t < 3; t += 0.0137) {
        const auto now = table(0, t);
        CHECK(now.x == Approx(0.1 * std::sin(M_PI * t)).margin(1e-6));
        CHECK(now.rate == Approx(0.1 * M_PI * std::cos(M_PI * t)).margin(1e-4));
        CHECK(now.second_rate == Approx(-0.1 * M_PI * M_PI * std::sin(M_PI * t)).margin(0.005));
    }
    std::ofstream(path) << "0, 0, 0, 0\n0, 1, 0, 0\n";
    CHECK_THROWS_WITH(MotionTable(path, 1, "b"), Catch::Contains("times must rise"));
    std::ofstream(path) << "0, 0, 0\n";
    CHECK_THROWS_WITH(MotionTable(path, 1, "b"), Catch::Contains("is not a row of t"));
}

TEST_CASE("formulas move and turn a body, and its points have the velocity of that") {
    Case input;
    input.time.end = 10;
    Body flap;
    flap.name = "flap";
    flap.angle = Expression("0.3*sin(2*t)", "t", "angle");
    flap.axis = {0, 1, 0}, flap.center = {1, 0, 2};
    for (const char* text : {"0.1*t^2", "0", "0"}) flap.displacement.emplace_back(text, "t", "d");
    const RigidMotion motion(flap, input);
    const Vec3 rest{1.5, 0, 2.7};
    const double t = 1.3, e = 1e-4;
    const Pose pose = motion(t);
    const Vec3 x = pose.to_space(rest), before = motion(t - e).to_space(rest),
               after = motion(t + e).to_space(rest);
    const Vec3 v = pose.velocity_at(x), a = pose.acceleration_at(x), back = pose.to_rest(x);
    for (int k = 0; k < 3; ++k) {
        CHECK(v[k] == Approx((after[k] - before[k]) / (2 * e)).margin(1e-6));
        CHECK(a[k] == Approx((after[k] - 2 * x[k] + before[k]) / (e * e)).margin(1e-4));
        CHECK(back[k] == Approx(rest[k]).margin(1e-12));
    }
}

TEST_CASE("a flux gauge counts the volume that went through, and nothing beside it") {
    Case input = scenes::water_box(0.01, {0.2, 0.1, 0.1});
    input.info.gravity = {0, 0, 0};
    input.sph.max_speed = 2;
    input.sph.fill[0].velocity = {1, 0, 0};
    FluidSystem fluid(input, 0.4);
    SphGauge gauge;
    gauge.box = {{0.25, 0, 0}, {0.25, 0.1, 0.05}};  // the lower half
    FluxMeter with(gauge);
    gauge.direction = {-1, 0, 0};
    FluxMeter against(gauge);
    for (int n = 0; n < 101; ++n) {
        with.count(fluid), against.count(fluid);
        for (double& x : fluid.particles.x) x += 1e-3;
    }
    // 0.1 m went by, of which 0.05 m is water, 0.1 m x 0.05 m in section
    CHECK(with.total() == Approx(0.05 * 0.1 * 0.05).epsilon(1e-9));
    CHECK(against.total() == -with.total());
    CHECK(with.rate(fluid) == Approx(0.1 * 0.05 * 1).epsilon(0.25));  // 2.4 layers in the mean
}
