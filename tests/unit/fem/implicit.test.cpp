// Linearly implicit parts: the scheme's own theory, its limits, its books, and what it refuses.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "case/case_file.hpp"
#include "fem_solver/elements/hexahedra.hpp"
#include "fem_solver/implicit/inertia_factor.hpp"
#include "fem_solver/setup/block_mesh.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);
constexpr double margin = 0.25;  // 4 kappa/dt^2 - 1, see implicit_parts.cpp

Case implicit_case(const BlockCase& block, double dt) {
    Case c = block.settings();
    c.fem.part[0].implicit = true;
    c.time.max_step = dt;
    return c;
}

/// [s] largest step of the same block with explicit parts.
double explicit_step(const Case& c) {
    Case e = c;
    e.fem.part[0].implicit = false;
    return Structure(build_model(e), 1).stable_step().dt;
}

class Random {
 public:
    double operator()() {  // [-1, 1]
        state_ = state_ * 1664525u + 1013904223u;
        return 2.0 * state_ / 4294967296.0 - 1;
    }

 private:
    std::uint32_t state_ = 1;
};

void shake(Structure& s, double speed) {
    Random random;
    for (std::size_t n = 0; n < s.nodes().size(); ++n)
        for (int d = 0; d < 3; ++d)
            s.nodes().v[n].c[d] = s.nodes().inverse_mass[n].c[d] > 0 ? speed * random() : 0;
}

TEST_CASE("the assembled stiffness is what the elements answer, in any shape") {
    BlockCase block{{1, 0.8, 1.2}, {4, 3, 5}, 1e9, 0.3};
    Case c = implicit_case(block, 1);
    c.fem.support = {{"zmin", {"x", "y", "z"}}, {"xmin", {"x"}}};
    Model model = build_model(c);
    distort(model.mesh, block, 0.1);
    Structure s(std::move(model), 1);
    Nodes& nodes = s.nodes();
    for (NodeRow& x : nodes.x) {  // turned by 30 degrees about y
        const double a = x.c[0], b = x.c[2], co = std::cos(pi / 6), si = std::sin(pi / 6);
        x.c[0] = co * a + si * b;
        x.c[2] = co * b - si * a;
    }
    StiffnessMatrix stiffness(s.model().mesh, s.model().parts[0].elements, nodes);
    stiffness.assemble(*s.elements().implicit(), nodes);
    const BlockMatrix& k = stiffness.matrix();
    REQUIRE(k.rows() == 5 * 4 * 5);  // zmin is held

    Random random;
    NodeRows u(nodes.size()), f(nodes.size());
    std::vector<double> x(3 * k.rows()), y(3 * k.rows());
    for (std::size_t i = 0; i < k.rows(); ++i)
        for (int d = 0; d < 3; ++d)
            x[3 * i + d] = u[k.node[i]].c[d] =
                nodes.inverse_mass[k.node[i]].c[d] > 0 ? 1e-20 * random() : 0;
    s.elements().implicit()->subtract_tangent_forces(nodes.x, u, f);
    k.multiply(x, y);
    double largest = 0, worst = 0;
    for (std::size_t i = 0; i < k.rows(); ++i)
        for (int d = 0; d < 3; ++d) {
            const double force = nodes.inverse_mass[k.node[i]].c[d] > 0 ? -f[k.node[i]].c[d] : 0;
            largest = std::max(largest, std::abs(force));
            worst = std::max(worst, std::abs(y[3 * i + d] - force));
        }
    CHECK(worst < 1e-12 * largest);  // round-off

    std::vector<double> mass;
    for (std::int32_t n : k.node) mass.push_back(nodes.mass[n]);
    const double kappa = 1e-6;
    InertiaFactor factor(k);
    REQUIRE(factor.factorize(k, mass, kappa));
    std::vector<double> b(x.size()), sum(x.size());
    for (double& v : b) v = random();
    std::vector<double> a = b;
    factor.solve(a);
    const std::vector<double> again = [&] {
        std::vector<double> c = b;
        factor.solve(c);
        return c;
    }();
    CHECK(a == again);
    k.multiply(a, sum);
    for (std::size_t i = 0; i < b.size(); ++i)
        CHECK(mass[i / 3] * a[i] + kappa * sum[i] == Approx(b[i]).margin(1e-11));
}

TEST_CASE("a mode moves with the frequency that the scheme's theory gives it, at any step") {
    // a bar of N elements, fixed and free: omega = (2 c/h) sin((2k-1) pi/(4N)), exactly
    const int N = 20;
    BlockCase block{{1, 0.05, 0.05}, {N, 1, 1}};
    const int k = GENERATE(1, 8);
    const double z = GENERATE(0.1, 0.5, 2.0, 20.0);  // omega dt
    const LinearElastic e = LinearElastic::from_young(block.young_modulus, block.poisson_ratio);
    const double speed = std::sqrt((e.lambda + 2 * e.mu) / block.density);
    const double wave = (2 * k - 1) * pi / 2;
    const double omega = 2 * speed * N * std::sin(wave / (2 * N));
    const double dt = z / omega;
    Case c = implicit_case(block, dt);
    c.fem.implicit_damping = 0;
    c.fem.support = {{"xmin", {"x"}}, {"block", {"y", "z"}}};
    Structure s(build_model(c), 1);
    const double phi = 2 * std::asin(0.5 * z / std::sqrt(1 + 0.25 * (1 + margin) * z * z));
    const double amplitude = 1e-8, tip_share = std::sin(wave);
    for (std::size_t n = 0; n < s.nodes().size(); ++n)
        s.nodes().v[n].c[0] =
            amplitude * std::sin(phi) / dt * std::sin(wave * s.nodes().x0[n].c[0]);
    const std::int32_t tip = std::int32_t(s.nodes().size()) - 1;
    double worst = 0;
    march(s, dt, 200, [&](int n) {
        worst = std::max(
            worst, std::abs(s.displacement(tip)[0] - amplitude * tip_share * std::sin(n * phi)));
    });
    INFO("mode " << k << ", omega dt " << z << ", error over amplitude " << worst / amplitude);
    // what finite strain adds: it falls with the amplitude, down to round-off at 1e-10 m
    CHECK(worst < 1e-5 * amplitude);
    CHECK(s.implicit()->factorizations() == 1);
    CHECK(dt > (z > 1 && k == 1 ? 10 : 0) * explicit_step(c));
}

TEST_CASE("a cantilever swings as it does with explicit steps a thirtieth as long") {
    BlockCase block{{1, 0.1, 0.1}, {20, 2, 2}};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    const double small = explicit_step(c), H = block.size[2];
    const double omega = first_cantilever_root * first_cantilever_root *
                         std::sqrt(block.young_modulus / block.density * H * H / 12);
    const auto period = [&](bool implicit, double dt) {
        c.fem.part[0].implicit = implicit;
        c.time.max_step = dt;
        Structure s(build_model(c), 1);
        for (std::size_t n = 0; n < s.nodes().size(); ++n) {
            const double x = s.nodes().x0[n].c[0];
            s.nodes().v[n].c[2] = s.nodes().inverse_mass[n].c[2] > 0 ? 1e-4 * x * x : 0;
        }
        const std::int32_t tip = std::int32_t(s.nodes().size()) - 1;
        double before = 0, first = 0, last = 0;
        int crossings = 0;
        march(s, dt, int(8.2 * 2 * pi / omega / dt), [&](int n) {
            const double u = s.displacement(tip)[2];
            if (before < 0 && u >= 0)
                (crossings++ == 0 ? first : last) = (n - u / (u - before)) * dt;
            before = u;
        });
        return (last - first) / (crossings - 1);
    };
    const double exact = period(false, small);
    for (double factor : {10.0, 30.0}) {
        const double dt = factor * small, z = 2 * pi / exact * dt;
        const double ratio = period(true, dt) / exact;
        const double theory =
            0.5 * z / std::asin(0.5 * z / std::sqrt(1 + 0.25 * (1 + margin) * z * z));
        WARN("cantilever, " << factor << " explicit steps in one (omega dt " << z
                            << "): period over explicit " << ratio << ", theory " << theory);
        CHECK(ratio == Approx(theory).epsilon(2e-3));  // zero crossings carry higher modes
    }
}

TEST_CASE("a strip that bends by many degrees comes to rest where the explicit one does") {
    BlockCase block{{1, 0.1, 0.05}, {20, 2, 1}};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 1e4, 0.05}};
    const double H = block.size[2],
                 omega = first_cantilever_root * first_cantilever_root *
                         std::sqrt(block.young_modulus / block.density * H * H / 12);
    c.fem.damping_alpha = 2 * omega;  // critical
    const double small = explicit_step(c);
    const auto tip_at_rest = [&](bool implicit, std::int64_t* assemblies) {
        c.fem.part[0].implicit = implicit;
        c.time.max_step = implicit ? 20 * small : small;
        Structure s(build_model(c), 1);
        double t = 0;
        while (t < 14 / omega + 0.05) {
            const double dt = std::min(c.time.max_step, s.stable_step().dt);
            s.internal_forces();
            s.pressure_forces(t);
            s.kick(dt);
            s.drift(dt);
            t += dt;
        }
        if (assemblies) *assemblies = s.implicit()->assemblies();
        return s.displacement(std::int32_t(s.nodes().size()) - 1);
    };
    std::int64_t assemblies = 0;
    const Vec3 exact = tip_at_rest(false, nullptr), u = tip_at_rest(true, &assemblies);
    WARN("strip of 1 m bent by " << -exact[2] << " m: implicit tip off by " << u[2] - exact[2]
                                 << " m, " << assemblies << " assemblies");
    CHECK(std::abs(exact[2]) > 0.1);
    CHECK(assemblies > 1);
    CHECK(u[2] == Approx(exact[2]).epsilon(1e-3));
    CHECK(u[0] == Approx(exact[0]).epsilon(1e-2));
}

TEST_CASE("energy of a beam under a pressure pulse closes over 10,000 implicit steps") {
    BlockCase block{{1, 0.1, 0.1}, {20, 2, 2}};
    const bool damped = GENERATE(false, true);
    Case c = block.settings();
    if (!damped) c.fem.implicit_damping = 0;
    c.info.gravity = {0, 0, -9.81};
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.pressure = {{"zmax", 2e3, 0.005}};  // bends it by half a degree
    if (damped) {
        c.fem.damping_alpha = 10;
        c.fem.bulk_viscosity_linear = 0.06;
        c.fem.bulk_viscosity_quadratic = 1.2;
    }
    c.fem.part[0].implicit = true;
    const double dt = c.time.max_step = 20 * explicit_step(c);
    Structure s(build_model(c), 1);
    double peak = 0, worst = 0, reach = 0;
    march(s, dt, 10000, [&](int n) {
        if (n % 20 != 0) return;
        const Energies e = s.energies();
        peak = std::max({peak, e.kinetic, e.internal + e.hourglass});
        worst = std::max(worst, std::abs(e.balance_error()));
        reach = std::max(reach, s.largest_displacement());
    });
    const Energies e = s.energies();
    WARN((damped ? "damped" : "undamped")
         << " beam at 20 explicit steps in one, deflection " << reach
         << " m, balance error over peak energy " << worst / peak << ", implicit inertia "
         << e.implicit / peak << ", its changes " << e.implicit_change / peak << ", "
         << s.implicit()->factorizations() << " factorizations");
    CHECK(worst / peak < 1e-3);
}

TEST_CASE("a beam swings freely for a million implicit steps, damped as theory says", "[.long]") {
    BlockCase block{{1, 0.1, 0.1}, {10, 1, 1}};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.part[0].implicit = true;
    c.fem.implicit_damping = 5e-4;
    const double dt = c.time.max_step = 20 * explicit_step(c);
    Structure s(build_model(c), 1);
    for (std::size_t n = 0; n < s.nodes().size(); ++n) {
        const double x = s.nodes().x0[n].c[0];
        if (s.nodes().inverse_mass[n].c[2] > 0) s.nodes().v[n].c[2] = 0.1 * x * x;
    }
    const std::int32_t tip = std::int32_t(s.nodes().size()) - 1;
    double before = 0;
    int first = -1, last = 0, crossings = 0;
    // The fast modes of the start have died out when the measurement begins; when it ends, a
    // constant share of 1e-4 (strains of finite steps) is still small against what is left.
    const int begin = 100000, measured = 400000, steps = 1000000;
    double start = 0, balance = 0, later = 0, end = 0, worst = 0;
    march(s, dt, steps, [&](int n) {
        if (n < begin) return;
        const double u = s.displacement(tip)[2];
        if (before < 0 && u >= 0) {
            (first < 0 ? first : last) = n;
            ++crossings;
        }
        before = u;
        if (n % 1000 != 0 && n != steps - 1) return;
        const Energies e = s.energies();
        end = e.kinetic + e.internal + e.hourglass + e.implicit;
        if (n == begin) {
            start = end;
            balance = e.balance_error();
        }
        if (n == measured) later = end;
        worst = std::max(worst, std::abs(e.balance_error() - balance));
    });
    const double z = 2 * pi * (crossings - 1) / (last - first);  // omega dt
    const double decay = c.fem.implicit_damping * z * z * (measured - begin);
    WARN("free beam, omega dt " << z << ", from step 100,000 to 400,000: log of energy falls by "
                                << std::log(start / later) << ", theory " << decay
                                << "; after a million, energy over that " << end / later
                                << ", balance closes to " << worst / start << ", "
                                << s.implicit()->factorizations() << " factorizations");
    CHECK(std::log(start / later) == Approx(decay).epsilon(0.01));
    CHECK(end < 0.05 * later);
    CHECK(worst < 1e-4 * start);
}

TEST_CASE("implicit and explicit parts share nodes: stable at the explicit part's own limit") {
    BlockCase block{{1, 0.2, 0.2}, {20, 4, 4}};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    Model model = build_model(c);
    Part stiff = model.parts[0];
    model.parts[0].element = GENERATE(ElementFormulation::one_point, ElementFormulation::b_bar);
    stiff.name = "stiff";
    stiff.implicit = true;
    stiff.material = LinearElastic::from_young(1e4 * block.young_modulus, 0.3);
    stiff.elements.clear();
    std::vector<std::int32_t> soft;
    for (std::int32_t e : model.parts[0].elements)
        (model.mesh.x[model.mesh.hexahedra[e][0]][0] > 0.49 ? stiff.elements : soft).push_back(e);
    model.parts[0].elements = soft;
    model.parts.push_back(stiff);
    model.cfl = 0.995;
    Structure s(std::move(model), 1);
    const double dt = s.stable_step().dt;
    CHECK(dt > 50 * s.implicit()->explicit_step());
    shake(s, 1e-6);
    double start = 0, balance = 0, largest = 0, worst = 0;
    march(s, dt, 5000, [&](int n) {
        const Energies e = s.energies();
        const double total = e.kinetic + e.internal + e.hourglass + e.implicit;
        if (n == 0) {
            start = total;
            balance = e.balance_error();
        }
        largest = std::max(largest, total);
        worst = std::max(worst, std::abs(e.balance_error() - balance));
    });
    WARN("a part 10^4 times as stiff, " << dt / s.implicit()->explicit_step()
                                        << " of its own steps in one: energy off by "
                                        << worst / start);
    CHECK(largest < 1.001 * start);
    CHECK(worst < 1e-3 * start);
}

TEST_CASE("an explicit shell on an implicit block: stable at the shell's own limit") {
    BlockCase block{{1, 0.2, 0.2}, {20, 4, 4}, 1e13, 0.3};
    Case c = block.settings();
    c.fem.part[0].implicit = true;
    c.fem.material.push_back(c.fem.material[0]);
    c.fem.material[1].name = "skin";
    c.fem.material[1].young_modulus = 1e9;
    c.fem.part.push_back({"skin", "skin", ElementFormulation::shell, 0.01});
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    Mesh mesh = make_block(*c.fem.block);
    for (const Quad& q : mesh.facets_of("zmax", "fem.part")) {
        mesh.volume_sets["skin"].push_back(std::int32_t(mesh.n_elements()));
        mesh.shells.push_back(q);
        mesh.element_tag.push_back(std::int64_t(mesh.n_elements()));
    }
    Model model = build_model(c, std::move(mesh));
    model.cfl = 0.995;
    Structure s(std::move(model), 1);
    const double dt = s.stable_step().dt;
    CHECK_THAT(s.stable_step().limiter, Catch::Matchers::Contains("skin"));
    CHECK(dt > 50 * s.implicit()->explicit_step());
    shake(s, 1e-6);
    double start = 0, balance = 0, largest = 0, worst = 0;
    march(s, dt, 5000, [&](int n) {
        const Energies e = s.energies();
        const double total = e.kinetic + e.internal + e.hourglass + e.implicit;
        if (n == 0) {
            start = total;
            balance = e.balance_error();
        }
        largest = std::max(largest, total);
        worst = std::max(worst, std::abs(e.balance_error() - balance));
    });
    WARN("a shell on a block 10^4 times as stiff, " << dt / s.implicit()->explicit_step()
                                                    << " of its own steps in one: energy off by "
                                                    << worst / start);
    CHECK(largest < 1.001 * start);
    CHECK(worst < 1e-3 * start);
}

TEST_CASE("contact has the whole budget 4 on the lumped mass of implicit nodes") {
    // Springs share m/dt^2 on every node of a free plate, integrated with the loads.
    BlockCase block{{1, 0.5, 0.05}, {10, 5, 1}, 1e10, 0.3};
    Case c = block.settings();
    c.fem.part[0].implicit = true;
    const double dt = c.time.max_step = 50 * explicit_step(c);
    const auto growth = [&](double share) {
        Structure s(build_model(c), 1);
        Nodes& nodes = s.nodes();
        shake(s, 1e-7);
        double largest = 0;
        for (int n = 0; n < 2000; ++n) {
            s.internal_forces();
            for (std::size_t i = 0; i < nodes.size(); ++i)
                for (int d = 0; d < 3; ++d)
                    nodes.f[i].c[d] -=
                        share * nodes.mass[i] / (dt * dt) * (nodes.x[i].c[d] - nodes.x0[i].c[d]);
            s.kick(dt);
            s.drift(dt);
            largest = std::max(largest, s.largest_displacement() / (1e-7 * dt));
            if (largest > 1e6) break;
        }
        return largest;
    };
    const double within = growth(3.95), beyond = growth(4.05);
    WARN("springs of 3.95 and 4.05 m/dt^2 on every node: largest displacement over v dt "
         << within << ", " << beyond);
    CHECK(within < 100);
    CHECK(beyond > 1e6);
}

TEST_CASE("a panel that turns by 90 degrees stays rigid, keeps its energy and turns on") {
    BlockCase block{{1, 0.6, 0.05}, {10, 6, 1}, 1e9, 0.3};
    Case c = block.settings();
    c.fem.part[0].implicit = true;
    const double dt = c.time.max_step = 20 * explicit_step(c);
    const int steps = 2000;
    const double rate = 0.5 * pi / (steps * dt);  // about y through the center
    Structure s(build_model(c), 1);
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        nodes.v[n].c[0] = rate * (nodes.x0[n].c[2] - 0.025);
        nodes.v[n].c[2] = -rate * (nodes.x0[n].c[0] - 0.5);
    }
    double start = 0, least = 1e300, most = 0;
    march(s, dt, steps, [&](int n) {
        const Energies e = s.energies();
        if (n == 0) start = e.kinetic;
        least = std::min(least, e.kinetic);
        most = std::max(most, e.kinetic);
    });
    double worst = 0, moment = 0, inertia = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double X = nodes.x0[n].c[0] - 0.5, Z = nodes.x0[n].c[2] - 0.025;
        const double x = nodes.x[n].c[0] - 0.5, z = nodes.x[n].c[2] - 0.025;
        worst = std::max(worst, std::hypot(x - Z, z + X));
        moment += nodes.mass[n] * (z * nodes.v[n].c[0] - x * nodes.v[n].c[2]);
        inertia += nodes.mass[n] * (X * X + Z * Z);
    }
    WARN("panel turned by 90 degrees in "
         << steps << " steps: farthest node off by " << worst << " m, kinetic energy "
         << least / start << " to " << most / start << ", moment of momentum "
         << moment / (inertia * rate) << ", " << s.implicit()->assemblies() << " assemblies");
    CHECK(worst < 1e-3);
    CHECK(moment == Approx(inertia * rate).epsilon(1e-4));
    CHECK(least > 0.999 * start);
    CHECK(most < 1.001 * start);
}

TEST_CASE("a step that jitters keeps its factor, and its energy") {
    BlockCase block{{1, 0.5, 0.05}, {10, 5, 1}, 1e10, 0.3};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    c.fem.part[0].implicit = true;
    const double dt = c.time.max_step = 20 * explicit_step(c);
    Structure s(build_model(c), 1);
    shake(s, 1e-6);
    Random random;
    double start = 0, most = 0;
    for (int n = 0; n < 5000; ++n) {
        const double jitter = dt * (1 + 0.03 * random());
        s.internal_forces();
        s.kick(jitter);
        const Energies e = s.energies();
        if (n == 0) start = e.kinetic + e.internal + e.hourglass + e.implicit;
        most = std::max(most, e.kinetic + e.internal + e.hourglass + e.implicit);
        s.drift(jitter);
    }
    WARN("steps that differ by 3 %: " << s.implicit()->factorizations()
                                      << " factorizations in 5,000 steps, energy at most "
                                      << most / start << " of the start");
    CHECK(s.implicit()->factorizations() <= 3);
    CHECK(most < 2 * start);
}

TEST_CASE("implicit parts give the same bits for one and two threads") {
    BlockCase block{{1, 1, 4}, {16, 16, 64}};
    const auto run = [&](int threads) {
        Case c = block.settings();
        c.fem.support = {{"zmin", {"x", "y", "z"}}};
        Model model = build_model(c);
        Part stiff = model.parts[0];
        stiff.implicit = true;
        stiff.material = LinearElastic::from_young(1e12, 0.3);
        stiff.elements.clear();
        std::vector<std::int32_t> soft;
        for (std::int32_t e : model.parts[0].elements)
            (model.mesh.x[model.mesh.hexahedra[e][0]][2] > 3.9 ? stiff.elements : soft)
                .push_back(e);
        model.parts[0].elements = soft;
        model.parts.push_back(stiff);
        Structure s(std::move(model), threads);
        shake(s, 1e-3);
        march(s, s.stable_step().dt, 20);
        return s.nodes().x;
    };
    const NodeRows one = run(1), two = run(2);
    bool same = true;
    for (std::size_t n = 0; n < one.size(); ++n)
        for (int d = 0; d < 3; ++d) same &= one[n].c[d] == two[n].c[d];
    CHECK(same);
}

TEST_CASE("what implicit parts do not go together with is refused by name") {
    using Catch::Matchers::Contains;
    BlockCase block{{1, 1, 1}, {2, 2, 2}};
    Case c = implicit_case(block, 1e-3);
    CHECK_NOTHROW(build_model(c));
    SECTION("a material that yields") {
        c.fem.material[0].kind = MaterialKind::tresca;
        c.fem.material[0].shear_strength = 1e4;
        CHECK_THROWS_WITH(build_model(c), Contains("stays elastic"));
    }
    SECTION("an absorbing boundary") {
        c.fem.absorbing = {{"zmin", {}}};
        CHECK_THROWS_WITH(build_model(c), Contains("fem.absorbing \"zmin\""));
    }
    SECTION("a rigid body of all its elements") {
        c.fem.rigid = {{.name = "body", .set = "block"}};
        CHECK_THROWS_WITH(build_model(c), Contains("belong to a rigid body"));
    }
    SECTION("8-point hexahedra") {
        c.fem.part[0].element = ElementFormulation::b_bar;
        CHECK_THROWS_WITH(build_model(c), Contains("one_point"));
    }
    SECTION("tetrahedra") {
        c.fem.block->cells = BlockCells::tetrahedra;
        CHECK_THROWS_WITH(build_model(c), Contains("the set holds tetrahedron 1"));
    }
    SECTION("no limit of the step") {
        c.time.max_step = std::numeric_limits<double>::infinity();
        CHECK_THROWS_WITH(build_model(c), Contains("set time.max_step"));
    }
    SECTION("strong bulk viscosity") {
        c.fem.bulk_viscosity_linear = 0.5;
        CHECK_THROWS_WITH(build_model(c), Contains("bulk_viscosity_linear"));
    }
}

}  // namespace
}  // namespace undertow::fem
