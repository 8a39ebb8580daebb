#include <omp.h>
#include <catch2/catch.hpp>

#include <numeric>

#include "scenes.hpp"
#include "sph_solver/gauges.hpp"

using namespace undertow;
using namespace undertow::sph;

namespace {

constexpr double dx = 0.01;
const Vec3 size{0.08, 0.08, 0.05};   // of the upper water, which stands at z = 0
constexpr double thickness = 0.001;  // of the plate under it

struct Mesh {
    std::vector<std::int32_t> quad;
    std::vector<double> x;  // (N, 3) [m]
};

/// A plate from x = from to x = to, its faces at z = 0 (looking up) and z = -thickness (down), n by
/// n quads each.
Mesh plate(double from, double to, int n, double thick = thickness, double bent = 0) {
    Mesh m;
    for (const bool upper : {true, false}) {
        const auto first = static_cast<std::int32_t>(m.x.size() / 3);
        for (int iy = 0; iy <= n; ++iy)
            for (int ix = 0; ix <= n; ++ix) {
                const double x = from + ix * (to - from) / n, y = -0.02 + iy * 0.12 / n;
                m.x.insert(m.x.end(), {x, y, (upper ? 0 : -thick) + bent * x * (x - 0.08)});
            }
        for (int iy = 0; iy < n; ++iy)
            for (int ix = 0; ix < n; ++ix) {
                const std::int32_t a = first + iy * (n + 1) + ix, b = a + 1, c = b + n + 1,
                                   d = a + n + 1;
                if (upper)
                    m.quad.insert(m.quad.end(), {a, b, c, d});
                else
                    m.quad.insert(m.quad.end(), {a, d, c, b});
            }
    }
    return m;
}

/// The upper water, and more fills below it if `below`.
Case waters(bool below) {
    Case input = scenes::water_box(dx, size);
    input.sph.max_speed = 3;
    input.sph.precision = Precision::float64;
    input.sph.artificial_viscosity = 0.1;
    scenes::add_basin(input, size);
    input.sph.plane.erase(input.sph.plane.begin());
    if (below) {
        Fill lower = input.sph.fill[0];
        lower.box = {{0, 0, -0.05 - thickness}, {size[0], size[1], -thickness}};
        input.sph.fill.push_back(lower);
    }
    return input;
}

FluidSystem disturbed(const Case& input, const Mesh& mesh) {
    FluidSystem fluid(input, 0.2);
    fluid.place_surface(mesh.quad, mesh.x);
    scenes::disturb(fluid, 0.05, 0.5, 2000);  // in the order of identities
    return fluid;
}

/// Contact as it would be: the layers at the plate are pushed off.
void push(FluidSystem& fluid) {
    Particles& p = fluid.particles;
    for (std::size_t i = 0; i < p.size(); ++i)
        p.fz[i] = std::abs(p.z[i] + 0.5 * thickness) < dx ? (p.z[i] > 0 ? 20.0 : -20.0) : 0.0;
}

/// Some steps, contact included.
void run(FluidSystem& fluid, int steps) {
    double t = 0;
    const double dt = 0.1 * dx / fluid.largest_sound_speed();
    for (int n = 0; n < steps; ++n) {
        push(fluid);
        scenes::two_pass_step(fluid, t, dt, n == 0 ? 0 : dt);
    }
}

/// The largest difference of the upper water's state to that of the one that has it alone, over the
/// largest change of that.
struct Difference {
    double x = 0, v = 0, rho = 0;
};
Difference between_upper_waters(const FluidSystem& both, const FluidSystem& alone) {
    Difference of;
    double v = 0, rho = 0;
    const Particles &a = both.particles, &b = alone.particles;
    for (std::size_t id = 0; id < b.size(); ++id) {
        const int i = both.index_of(std::int64_t(id)), k = alone.index_of(std::int64_t(id));
        of.x = std::max(of.x, std::hypot(a.x[i] - b.x[k], a.y[i] - b.y[k], a.z[i] - b.z[k]) / dx);
        of.v = std::max(of.v, std::hypot(a.vx[i] - b.vx[k], a.vy[i] - b.vy[k], a.vz[i] - b.vz[k]));
        of.rho = std::max(of.rho, std::abs(a.drho[i] - b.drho[k]));
        v = std::max(v, std::hypot(b.vx[k], b.vy[k], b.vz[k]));
        rho = std::max(rho, std::abs(b.drho[k]));
    }
    of.v /= v, of.rho /= rho;
    return of;
}

}  // namespace

TEST_CASE("water on one side of a thin plate does not know of water on the other") {
    Case upper = waters(false), both = waters(true);
    double tolerance = 1e-10;  // sums in another order, and positions of other fixed-point units
    const auto in_both = [&](auto&& set) { set(upper), set(both); };
    SECTION("one fluid") {}
    SECTION("float sums") {
        in_both([](Case& c) { c.sph.precision = Precision::float32; });
        tolerance = 3e-5;
    }
    SECTION("viscous") {
        in_both([](Case& c) { c.sph.fluid[0].viscosity = 1; });
    }
    SECTION("viscous forces along pairs") {
        in_both([](Case& c) {
            c.sph.fluid[0].viscosity = 1, c.sph.viscous_form = ViscousForm::strain;
        });
    }
    SECTION("implicit viscosity") {
        in_both([](Case& c) {
            c.sph.fluid[0].viscosity = 50;
            c.sph.viscosity_solver = ViscositySolver::implicit;
            c.sph.viscosity_tolerance = 1e-6;
            c.sph.precision = Precision::float32;
        });
        tolerance = 1e-5;  // in float, and to a tolerance of the whole fluid
    }
    SECTION("viscoplastic") {
        in_both([](Case& c) {
            Fluid& f = c.sph.fluid[0];
            f.viscosity = 0, f.yield_stress = 7.3, f.consistency = 3, f.flow_index = 0.35;
            f.max_viscosity = 5;
        });
    }
    SECTION("another fluid below") {
        in_both([](Case& c) { c.sph.fluid[0].viscosity = 0.1; });
        Fluid slide;
        slide.name = "slide";
        slide.density = 1681, slide.viscosity = 2;
        in_both([&](Case& c) { c.sph.fluid.push_back(slide); });
        both.sph.fill[1].fluid = "slide";
    }
    SECTION("shifting and switched tension") {
        in_both(
            [](Case& c) { c.sph.shifting = 10, c.sph.tension_control = TensionControl::switched; });
    }
    SECTION("corrected gradients, without images") {
        in_both([](Case& c) { c.sph.gradient_correction = true, c.sph.surface_images = false; });
    }
    SECTION("smoothing lengths that follow from density") {
        in_both([](Case& c) {
            c.sph.variable_smoothing = true, c.sph.surface_images = false;
            c.sph.precision = Precision::float32;
        });
        tolerance = 3e-5;
    }
    SECTION("walls that hold the fluid") {
        in_both([](Case& c) {
            c.sph.fluid[0].viscosity = 1;
            for (PlaneWall& plane : c.sph.plane) plane.slip = Slip::no_slip;
        });
    }
    SECTION("a fluid that friction heats") {
        in_both([](Case& c) {
            c.sph.fluid[0].viscosity = 1;
            c.sph.fluid[0].hugoniot_slope = 1.75, c.sph.fluid[0].gruneisen = 0.28;
        });
    }
    const Mesh mesh = plate(-0.02, 0.10, 6);
    FluidSystem of_both = disturbed(both, mesh), alone = disturbed(upper, mesh);
    REQUIRE(of_both.plates().facets() == 72);
    run(of_both, 12);
    run(alone, 12);
    REQUIRE(of_both.neighbors().fluid_lists().cut());
    const Difference of = between_upper_waters(of_both, alone);
    CHECK(of.x < tolerance);
    CHECK(of.v < tolerance);
    CHECK(of.rho < tolerance);

    FluidSystem through = disturbed(both, {});  // and without the plate it does
    run(through, 12);
    CHECK(between_upper_waters(through, alone).v > 1e-3);
}

TEST_CASE("the lists lack exactly the pairs whose segment crosses the plate") {
    // half of the box's width, or bent; facets finer and coarser than particles
    const int n = GENERATE(2, 6, 40);
    const double bent = GENERATE(0.0, 1.5);  // [1/m] less than half a spacing
    const Mesh mesh = plate(-0.02, 0.043, n, thickness, bent);
    Case input = waters(true);
    input.sph.fill[1].box.max[2] = -thickness;
    FluidSystem fluid(input, 0.2);
    scenes::disturb(fluid, 0.2, 0, 0);
    fluid.place_surface(mesh.quad, mesh.x);
    fluid.refresh_neighbors(0);
    const Neighborhood& near = fluid.neighbors();
    const Particles& p = fluid.particles;
    const int count = near.fluid_count();
    const double range = near.support() + near.skin();
    // crosses z = -thickness/2 + bent x (x - 0.08) before x = 0.043: by 200 points along the
    // segment
    const auto crosses = [&](const Vec3& a, const Vec3& b) {
        const auto above = [&](const Vec3& at) {
            return at[2] + 0.5 * thickness - bent * at[0] * (at[0] - 0.08);
        };
        if (bent == 0) {
            if (above(a) * above(b) >= 0) return 0;
            const double share = above(a) / (above(a) - above(b));
            const double rim = 0.043 - (a[0] + share * (b[0] - a[0]));
            return std::abs(rim) < 0.1 * dx ? -1 : int(rim > 0);  // near the rim: not told
        }
        Vec3 last = a;
        for (int s = 1; s <= 200; ++s) {
            Vec3 at;
            for (int c = 0; c < 3; ++c) at[c] = a[c] + (b[c] - a[c]) * s / 200;
            if (above(last) * above(at) < 0)
                return std::abs(at[0] - 0.043) < 0.15 * dx ? -1 : int(at[0] < 0.043);
            last = at;
        }
        return 0;
    };
    std::vector<std::vector<char>> seen(count, std::vector<char>(count, 0));
    for (int i = 0; i < count; ++i)
        near.fluid_lists().for_each_seen(i, [&](int j) {
            if (j < count) seen[i][j] = 1;
        });
    int wrong = 0, cut = 0, lopsided = 0;
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) {
            const Vec3 a{p.x[i], p.y[i], p.z[i]}, b{p.x[j], p.y[j], p.z[j]};
            if (std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) > range * 0.999) continue;
            lopsided += seen[i][j] != seen[j][i];
            const int apart = crosses(a, b);
            // a coarse mesh has its own bend
            if (apart < 0 || (bent != 0 && n < 40)) continue;
            cut += apart;
            wrong += seen[i][j] == apart;
        }
    CHECK(lopsided == 0);
    if (bent != 0 && n < 40) return;
    REQUIRE(cut > 1000);
    CHECK(wrong == 0);
}

TEST_CASE("momentum is conserved with pairs cut, and results do not depend on the threads") {
    // past the free edge of a plate, no walls
    const Mesh mesh = plate(-0.02, 0.043, 6);
    Case input = waters(true);
    input.sph.plane.clear();
    input.info.gravity = {0, 0, 0};
    const auto sums = [&](int threads) {
        omp_set_num_threads(threads);
        FluidSystem fluid = disturbed(input, mesh);
        run(fluid, 3);
        fluid.refresh_neighbors(0);
        fluid.pack(0);
        fluid.sum_over_neighbors(Terms::both);
        return fluid;
    };
    const FluidSystem one = sums(1), two = sums(2);
    omp_set_num_threads(1);
    REQUIRE(one.neighbors().fluid_lists().cut());
    const Particles &p = one.particles, &q = two.particles;
    double sum[3] = {0, 0, 0}, all = 0;
    int differ = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        sum[0] += p.ax[i], sum[1] += p.ay[i], sum[2] += p.az[i];
        all += std::hypot(p.ax[i], p.ay[i], p.az[i]);
        differ += p.ax[i] != q.ax[i] || p.az[i] != q.az[i] || p.drho_dt[i] != q.drho_dt[i];
    }
    for (const double component : sum) CHECK(std::abs(component) < 1e-13 * all);
    CHECK(differ == 0);
}

TEST_CASE("a plate hides what is behind it: a floor that mirrors, a body of dummies") {
    // 1 dx below the plate: the upper water would see its own images in it, or the body
    const Mesh mesh = plate(-0.02, 0.10, 6);
    Case open = waters(false), floor = waters(false);
    if (GENERATE(true, false)) {
        floor.sph.plane.push_back(scenes::plane("floor", {0, 0, -0.01}, {0, 0, 1}));
    } else {
        Body body;
        body.name = "floor";
        body.shape.box = Box{{-0.04, -0.04, -0.06}, {0.12, 0.12, -0.01}};
        floor.sph.body = {body};
    }
    FluidSystem with = disturbed(floor, mesh), without = disturbed(open, mesh);
    run(with, 5);
    run(without, 5);
    const Difference of = between_upper_waters(with, without);
    CHECK(of.v < 1e-10);
    CHECK(of.rho < 1e-10);
}

TEST_CASE("a thin plate that is wet on one side only changes no bit") {
    const Mesh thin = plate(-0.02, 0.10, 6);
    Mesh face = thin;
    face.quad.resize(face.quad.size() / 2);
    FluidSystem one = disturbed(waters(false), face), two = disturbed(waters(false), thin);
    REQUIRE(one.plates().facets() == 0);
    REQUIRE(two.plates().facets() == 72);
    for (FluidSystem* fluid : {&one, &two}) {
        run(*fluid, 5);
        // as the coupler does
        fluid->place_surface(fluid == &one ? face.quad : thin.quad, thin.x);
        run(*fluid, 5);
    }
    CHECK(one.rebuilds() == two.rebuilds());
    int differ = 0;
    for (std::size_t i = 0; i < one.particles.size(); ++i)
        differ += one.particles.x[i] != two.particles.x[i] ||
                  one.particles.drho[i] != two.particles.drho[i];
    CHECK(differ == 0);
}

TEST_CASE("a wall as thick as the support is no thin plate") {
    Case input = waters(false);
    FluidSystem fluid(input, 0.2);
    const double support = fluid.support();
    const Mesh thick = plate(-0.02, 0.10, 6, 1.6 * support), thin = plate(-0.02, 0.10, 6, support);
    fluid.place_surface(thick.quad, thick.x);
    CHECK(fluid.plates().facets() == 0);
    fluid.place_surface(thin.quad, thin.x);
    CHECK(fluid.plates().facets() == 72);
}

TEST_CASE("pairs come back when the plate has gone, and leave when it comes") {
    const Mesh mesh = plate(-0.02, 0.10, 6);
    Mesh away = mesh;
    for (std::size_t k = 0; k < away.x.size(); k += 3) away.x[k] += 1;
    FluidSystem fluid(waters(true), 0.2);
    const auto entries = [&](const Mesh& m) {
        fluid.place_surface(m.quad, m.x);
        fluid.refresh_neighbors(0);
        const Particles& p = fluid.particles;
        std::int64_t seen = 0;  // within the support: skins differ
        for (int i = 0; i < fluid.neighbors().fluid_count(); ++i)
            fluid.neighbors().fluid_lists().for_each_seen(i, [&](int j) {
                if (j >= fluid.neighbors().fluid_count()) return;
                seen += std::hypot(p.x[i] - p.x[j], p.y[i] - p.y[j], p.z[i] - p.z[j]) <
                        0.999 * fluid.support();
            });
        return seen;
    };
    const std::int64_t all = entries(away), cut = entries(mesh);
    CHECK(cut < all);
    CHECK(entries(away) == all);
    CHECK(entries(mesh) == cut);
}

TEST_CASE("a pressure gauge beside a thin plate shows its own side") {
    Case input = waters(true);
    FluidSystem fluid(input, 0.2);
    const Mesh mesh = plate(-0.02, 0.10, 6);
    fluid.place_surface(mesh.quad, mesh.x);
    for (std::size_t i = 0; i < fluid.particles.size(); ++i)
        fluid.particles.drho[i] = fluid.particles.z[i] > 0 ? 1 : 0;
    fluid.refresh_neighbors(0);
    fluid.pack(0);
    CHECK(interpolate(fluid, {0.041, 0.039, -0.006}).p == 0);
    CHECK(interpolate(fluid, {0.041, 0.039, 0.005}).p > 0);
}
