// Motion that is told: where nodes and bodies are, the force it takes, its work.

#include <catch2/catch.hpp>
#include <cmath>

#include "fem_solver/settle.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

FemMotion displaced(const char* set, std::array<const char*, 3> formulas, double ramp = 0) {
    FemMotion motion;
    motion.name = "drive";
    motion.set = set;
    motion.ramp = ramp;
    for (const char* formula : formulas) motion.displacement.emplace_back(formula, "t", "test");
    return motion;
}

/// As march(), with steps that vary by 20 %.
void march_unevenly(Structure& s, double dt, int steps, double& t) {
    for (int n = 0; n < steps; ++n) {
        const double step = dt * (0.9 + 0.1 * std::sin(1.7 * n));
        s.internal_forces();
        s.pressure_forces(t);
        s.kick(step);
        s.drift(step);
        t += step;
    }
}

TEST_CASE("a block that is pressed by a told displacement answers with E A u/L, on both ends") {
    BlockCase block{{0.5, 0.4, 1}, {2, 2, 4}};
    block.poisson_ratio = 0;
    Case c = block.settings();
    c.time.end = 1;
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    c.fem.motion = {displaced("zmax", {"0", "0", "-1e-5"}, 0.05)};
    c.fem.motion[0].directions = {"z"};
    c.fem.damping_alpha = 1500;
    Structure s(build_model(c), 1);
    const double dt = s.stable_step().dt;
    march(s, dt, int(0.1 / dt));
    const PrescribedMotion& motion = s.motions()[0];
    CHECK(motion.place().shift[2] == -1e-5);
    const double exact = -block.young_modulus * 0.2 * 1e-5;  // log strain is 5e-6 larger
    CHECK(motion.force().force[2] == Approx(exact).epsilon(1e-5));
    s.internal_forces();
    CHECK(s.reaction(s.model().supports[0])[2] == Approx(-exact).epsilon(1e-5));
}

TEST_CASE(
    "told nodes and a told body follow the law to round-off, whatever the steps, and feel m a - "
    "W") {
    const bool rigid = GENERATE(false, true);
    BlockCase block{{0.1, 0.2, 0.3}, {1, 2, 2}};
    Case c = block.settings();
    c.time.end = 1;
    c.info.gravity = {0, 0, -9.81};
    c.fem.damping_alpha = 20;  // not of what is told
    c.fem.motion = {displaced("block", {"1.5*t^2", "0", "-0.2*t^2"})};
    if (rigid) {
        c.fem.rigid = {{"brick", "block", {}, 0, {}}};
        c.fem.motion[0].set.clear();
        c.fem.motion[0].rigid = "brick";
    }
    Structure s(build_model(c), 1);
    double t = 0;
    march_unevenly(s, 1e-4, 1000, t);
    const Vec3 u = s.displacement(5);
    CHECK(std::abs(u[0] - 1.5 * t * t) < 1e-14);
    CHECK(std::abs(u[2] + 0.2 * t * t) < 1e-14);
    const double mass = 1000 * 0.006;
    CHECK(s.motions()[0].force().force[0] == Approx(3 * mass).epsilon(1e-9));
    CHECK(s.motions()[0].force().force[1] == Approx(0).margin(1e-9));
    CHECK(s.motions()[0].force().force[2] == Approx((9.81 - 0.4) * mass).epsilon(1e-9));
    s.internal_forces();
    s.pressure_forces(t);
    s.finish();
    // work = what it moves with and what it was lifted by; the scheme's own offset is of order dt^2
    const Energies e = s.energies();
    CHECK(std::abs(e.balance_error()) < 1e-6 * e.kinetic);
    CHECK(e.kinetic > 0.2);
}

TEST_CASE("a velocity that begins at once takes the kinetic energy that it gives, no more") {
    const bool rigid = GENERATE(false, true);
    BlockCase block{{0.1, 0.2, 0.3}, {1, 2, 2}};
    Case c = block.settings();
    c.time.end = 1;
    FemMotion blow;
    blow.name = "blow";
    blow.velocity = {1, 0, 2};
    blow.set = "block";
    if (rigid) {
        c.fem.rigid = {{"brick", "block", {}, 0, {}}};
        blow.set.clear();
        blow.rigid = "brick";
    }
    c.fem.motion = {blow};
    Structure s(build_model(c), 1);
    double t = 0;
    march_unevenly(s, 1e-5, 20, t);
    s.internal_forces();
    s.pressure_forces(t);
    s.finish();
    const Energies e = s.energies();
    CHECK(e.kinetic == Approx(0.5 * 6 * 5));
    CHECK(std::abs(e.balance_error()) < 1e-9 * e.kinetic);
}

TEST_CASE("a body that is told to turn turns, and its moment is I times the angular acceleration") {
    const bool rigid = GENERATE(true, false);
    BlockCase block{{0.3, 0.1, 0.2}, {3, 1, 2}};
    Case c = block.settings();
    c.time.end = 1;
    FemMotion turn;
    turn.name = "turn";
    turn.angle = Expression("pi/2*t^2", "t", "test");
    turn.axis = {0, 1, 0};
    turn.center = {0.15, 0.05, 0.1};  // of the block
    turn.set = "block";
    if (rigid) {
        c.fem.rigid = {{"brick", "block", {"x", "y", "z", "rx", "ry", "rz"}, 0, {}}};
        turn.set.clear();
        turn.rigid = "brick";
    }
    c.fem.motion = {turn};
    Structure s(build_model(c), 1);
    const double dt = rigid ? 1e-3 : 1e-5;  // elements must not feel a step beyond theirs
    const int steps = rigid ? 1000 : 2000;
    march(s, dt, steps);
    const double t = steps * dt, angle = std::acos(-1.0) / 2 * t * t;
    // the corner (0, 0, 0): about y, z to x
    const double rx = -0.15, rz = -0.1;
    const Vec3 u = s.displacement(0);
    CHECK(u[0] == Approx(rx * std::cos(angle) + rz * std::sin(angle) - rx).epsilon(1e-9));
    CHECK(u[2] == Approx(-rx * std::sin(angle) + rz * std::cos(angle) - rz).epsilon(1e-9));
    double inertia = 0;
    for (std::size_t n = 0; n < s.nodes().size(); ++n)
        inertia += s.nodes().mass[n] * (std::pow(s.nodes().x0[n].c[0] - 0.15, 2) +
                                        std::pow(s.nodes().x0[n].c[2] - 0.1, 2));
    CHECK(s.motions()[0].force().moment[1] ==
          Approx(inertia * std::acos(-1.0)).epsilon(rigid ? 1e-6 : 1e-4));
}

TEST_CASE("the energy of a beam that is shaken at its root is the work of the motion") {
    BlockCase block{{1, 0.1, 0.1}, {20, 2, 2}};
    Case c = block.settings();
    c.time.end = 1;
    c.info.gravity = {0, 0, -9.81};
    c.fem.motion = {displaced("xmin", {"0", "0", "0.02*sin(2*pi*10*t)"}, 0.05)};
    c.fem.damping_alpha = 5;
    Structure s(build_model(c), 1);
    double peak = 0, worst = 0, work = 0;
    const double dt = s.stable_step().dt;
    march(s, dt, int(0.3 / dt), [&](int n) {
        if (n % 20 != 0) return;
        const Energies e = s.energies();
        peak = std::max({peak, e.kinetic, e.internal});
        worst = std::max(worst, std::abs(e.balance_error()));
        work = std::max(work, s.motions()[0].work());
    });
    WARN("shaken beam: peak energy " << peak << " J, work of the motion up to " << work
                                     << " J, balance error over peak " << worst / peak);
    CHECK(work > 0.1);
    CHECK(worst / peak < 1e-4);
}

TEST_CASE("a velocity rises and falls smoothly, and goes as far as without a ramp") {
    FemMotion m;
    m.velocity = {0, 0, 2};
    m.start = 0.1;
    m.stop = 0.6;
    m.ramp = 0.05;
    const MotionLaw law(m, 1, "", "test");
    CHECK(law(0.1).shift[2] == 0);
    CHECK(law(1).shift[2] == Approx(1.0));
    CHECK((law(0.4 + 1e-6).shift[2] - law(0.4).shift[2]) / 1e-6 == Approx(2));
    double last = 0, jump = 0;
    for (double t = 0; t < 0.8; t += 1e-3) {
        const double v = (law(t + 1e-6).shift[2] - law(t).shift[2]) / 1e-6;
        jump = std::max(jump, std::abs(v - last));
        last = v;
    }
    CHECK(jump < 2 * 1.5 / 0.05 * 1.1e-3);  // the steepest slope of s^2 (3 - 2 s) is 1.5
    CHECK(last == Approx(0).margin(1e-9));
}

TEST_CASE("motions wait while the structure settles") {
    BlockCase block{{1, 1, 1}, {2, 2, 2}};
    Case c = block.settings();
    c.time.end = 1;
    c.info.gravity = {0, 0, -9.81};
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    FemMotion push;
    push.name = "push";
    push.set = "zmax";
    push.directions = {"x"};
    push.velocity = {1, 0, 0};
    c.fem.motion = {push};
    Structure s(build_model(c), 1);
    const std::int32_t top = std::int32_t(s.nodes().size()) - 1;
    settle(s, {1e-6, 20000});
    CHECK(s.displacement(top)[0] == 0);
    march(s, 1e-5, 10);
    CHECK(s.displacement(top)[0] == Approx(1e-4).epsilon(1e-9));
}

TEST_CASE("motions that cannot be are refused in words") {
    BlockCase block{{1, 1, 1}, {2, 2, 2}};
    Case c = block.settings();
    c.time.end = 1;
    c.fem.motion = {displaced("zmax", {"0", "0", "t"})};
    c.fem.support = {{"zmax", {"z"}}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("held in z by a support as well"));
    c.fem.support = {};
    c.fem.motion.push_back(c.fem.motion[0]);
    c.fem.motion[1].name = "second";
    c.fem.motion[1].set = "xmax";
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("told in") &&
                                          Catch::Contains("by another fem.motion as well"));
    c.fem.motion.pop_back();
    c.fem.absorbing = {{"xmax"}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("on an absorbing boundary"));
    c.fem.absorbing = {};
    c.start.settle = 0.5;
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("moves before t = 0.5 s"));
    c.start.settle = 0;
    c.fem.rigid = {{"brick", "block", {"x"}, 0, {}}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("tell the body, by rigid = \"brick\""));
}

}  // namespace
}  // namespace undertow::fem
