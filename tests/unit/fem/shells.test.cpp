// Shells in a structure: the whole step, from the tables of a case.

#include <catch2/catch.hpp>
#include <cmath>
#include <ctime>

#include "fem_solver/setup/sheet_mesh.hpp"
#include "fem_solver/settle.hpp"
#include "fem_solver/shells/shells.hpp"
#include "support.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);

double cpu_seconds() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct ShellCase {
    double thickness = 0.01, young_modulus = 2e11, poisson_ratio = 0.3, density = 8000;
    Case settings() const {
        Case c;
        c.info.gravity = {0, 0, 0};
        c.fem.present = true;
        c.fem.bulk_viscosity_linear = 0;
        c.fem.bulk_viscosity_quadratic = 0;
        c.fem.material = {{.name = "steel",
                           .kind = MaterialKind::linear_elastic,
                           .density = density,
                           .young_modulus = young_modulus,
                           .poisson_ratio = poisson_ratio}};
        c.fem.part = {{"shell", "steel", ElementFormulation::shell, thickness}};
        return c;
    }
};

/// n_u x n_v shells over [0, 1]^2 mapped by `place`; node sets u0, u1, v0, v1.
template <class Place>
Mesh sheet(int n_u, int n_v, Place&& place) {
    Mesh mesh;
    mesh.source = "sheet";
    const auto node = [&](int i, int j) { return i + (n_u + 1) * j; };
    for (int j = 0; j <= n_v; ++j)
        for (int i = 0; i <= n_u; ++i) {
            mesh.x.push_back(place(double(i) / n_u, double(j) / n_v));
            const std::int32_t n = node(i, j);
            if (i == 0) mesh.node_sets["u0"].push_back(n);
            if (i == n_u) mesh.node_sets["u1"].push_back(n);
            if (j == 0) mesh.node_sets["v0"].push_back(n);
            if (j == n_v) mesh.node_sets["v1"].push_back(n);
        }
    for (int j = 0; j < n_v; ++j)
        for (int i = 0; i < n_u; ++i) {
            mesh.volume_sets["shell"].push_back(std::int32_t(mesh.shells.size()));
            mesh.shells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
            mesh.element_tag.push_back(std::int64_t(mesh.shells.size()));
        }
    mesh.facet_sets["shell"] = mesh.shells;
    return mesh;
}

const Shells& shells_of(const Structure& s) {
    return dynamic_cast<const Shells&>(*s.elements().groups().front());
}

TEST_CASE("a cantilever of shells swings at the beam's frequency and keeps its energy") {
    const double L = 1, t = 0.01;
    ShellCase shell{.thickness = t, .poisson_ratio = 0};
    Case c = shell.settings();
    c.fem.support = {{"u0", {"clamp"}}};
    std::string text = "cantilever strip L/t = 100, f1 over Euler-Bernoulli:";
    double last = 0, worst_energy = 0;
    for (int n : {5, 10, 20}) {
        Structure s(build_model(c, sheet(n, 1,
                                         [&](double u, double v) -> Vec3 {
                                             return {L * u, 0.1 * v, 0};
                                         })),
                    1);
        Nodes& nodes = s.nodes();
        const double root = first_cantilever_root;
        const double exact = root * root / (L * L) *
                             std::sqrt(shell.young_modulus / shell.density * t * t / 12) / (2 * pi);
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const double X = root * nodes.x0[k].c[0] / L;
            if (nodes.inverse_mass[k].c[2] > 0)
                nodes.v[k].c[2] = 1e-4 * (std::cosh(X) - std::cos(X) -
                                          0.734095513759 * (std::sinh(X) - std::sin(X)));
        }
        const double dt = s.stable_step().dt, start = cpu_seconds();
        double before = 0, first = 0, end = 0, energy = 0, peak = 0;
        int crossings = 0;
        const std::int32_t tip = n;
        const int steps = int(3.2 / exact / dt);
        march(s, dt, steps, [&](int k) {
            const double u = s.displacement(tip)[2];
            if (before < 0 && u >= 0)
                (crossings++ == 0 ? first : end) = (k - u / (u - before)) * dt;
            before = u;
            const Energies e = s.energies();
            peak = std::max(peak, e.kinetic);
            if (k == 0) energy = e.balance_error();
            worst_energy = std::max(worst_energy, std::abs(e.balance_error() - energy) / peak);
        });
        last = (crossings - 1) / (end - first) / exact - 1;
        char one[120];
        std::snprintf(one, sizeof one, " %d: %+.2f %% (%d steps, %.2f s CPU)", n, 100 * last, steps,
                      cpu_seconds() - start);
        text += one;
    }
    WARN(text << "; energy off by " << worst_energy << " of its peak");
    CHECK(std::abs(last) < 0.003);
    CHECK(worst_energy < 1e-6);
}

TEST_CASE("the roof of Scordelis and Lo sags under its weight as linear statics has it") {
    const double R = 25, L = 50, angle = 40 * pi / 180, t = 0.25, g = 1;
    // a light load, so that the answer is linear: sag scaled back
    const double scale = 1e-3;
    ShellCase shell{
        .thickness = t, .young_modulus = 4.32e8, .poisson_ratio = 0, .density = scale * 90 / t / g};
    Case c = shell.settings();
    c.info.gravity = {0, 0, -g};
    c.fem.support = {
        {"u0", {"y", "z", "rx"}}, {"u1", {"x", "ry", "rz"}}, {"v0", {"y", "rx", "rz"}}};
    const int n = 16;
    Structure s(
        build_model(
            c, sheet(n, n,
                     [&](double u, double v) -> Vec3 {
                         return {0.5 * L * u, R * std::sin(angle * v), R * std::cos(angle * v)};
                     })),
        1);
    const double start = cpu_seconds();
    const Settlement found = settle(s, {.tolerance = 1e-4, .max_steps = 40000});
    const double cpu = cpu_seconds() - start;
    const double sag = -(s.nodes().x[(n + 1) * (n + 1) - 1].c[2] - R * std::cos(angle)) / scale;
    WARN("Scordelis-Lo roof 16 x 16, settled: sag "
         << sag << " (deep shell theory 0.3006) in " << found.steps << " steps, " << cpu
         << " s CPU, " << 256e-6 * found.steps / cpu << " M element-steps/s");
    CHECK(sag == Approx(0.3006).epsilon(0.01));
}

TEST_CASE("a free warped shell thrown and spinning stays free of stress, and keeps its momenta") {
    ShellCase shell;
    Structure s(build_model(shell.settings(), sheet(4, 3,
                                                    [](double u, double v) -> Vec3 {
                                                        return {u + 0.05 * v, v, 0.2 * u * v};
                                                    })),
                1);
    Nodes& nodes = s.nodes();
    auto& group = const_cast<Shells&>(shells_of(s));
    const double omega[3] = {20, -10, 30};
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int d = 0; d < 3; ++d) {
            const double* x = nodes.x[n].c;
            nodes.v[n].c[d] =
                5 + omega[(d + 1) % 3] * x[(d + 2) % 3] - omega[(d + 2) % 3] * x[(d + 1) % 3];
            group.turning().omega[n].c[d] = omega[d];
        }
    const auto angular = [&] {
        Vec3 h{};
        for (std::size_t n = 0; n < nodes.size(); ++n)
            for (int d = 0; d < 3; ++d) {
                const int a = (d + 1) % 3, b = (d + 2) % 3;
                h[d] += nodes.mass[n] * (nodes.x[n].c[a] * nodes.v[n].c[b] -
                                         nodes.x[n].c[b] * nodes.v[n].c[a]) +
                        group.turning().inertia[n] * group.turning().omega[n].c[d];
            }
        return h;
    };
    const Vec3 before = angular();
    const double dt = s.stable_step().dt;
    const int steps = int(0.05 / dt);  // 1.8 rad
    double peak = 0;
    march(s, dt, steps, [&](int) {
        for (double sigma : s.elements().stress()) peak = std::max(peak, std::abs(sigma));
    });
    const Vec3 after = angular();
    double change = 0, size = 0;
    for (int d = 0; d < 3; ++d) {
        change = std::max(change, std::abs(after[d] - before[d]));
        size = std::max(size, std::abs(before[d]));
    }
    // spinning at 37 rad/s pulls it by some rho (omega L)^2
    WARN("spinning shell: largest stress "
         << peak / (8000 * 37.4 * 37.4) << " rho (omega L)^2, moment of "
         << "momentum off by " << change / size << " in " << steps << " steps");
    CHECK(peak < 3 * 8000 * 37.4 * 37.4);
    CHECK(change < 2e-4 * size);
}

TEST_CASE("a ring of shells under pressure carries the hoop stress p R/t") {
    const double R = 1, t = 0.01, p = 1e5;
    ShellCase shell{.thickness = t};
    Case c = shell.settings();
    c.fem.damping_alpha = 4000;
    c.fem.pressure = {{"shell", -p, 0.01}};  // facets look outward, pressure is inside
    c.fem.support = {
        {"u0", {"y", "rx", "rz"}}, {"u1", {"x", "ry", "rz"}}, {"v0", {"z"}}, {"v1", {"z"}}};
    Structure s(
        build_model(
            c, sheet(12, 2,
                     [&](double u, double v) -> Vec3 {
                         return {R * std::cos(0.5 * pi * u), R * std::sin(0.5 * pi * u), 0.2 * v};
                     })),
        1);
    march(s, s.stable_step().dt, 4000);
    const Resultants<double> r = shells_of(s).resultants(5);
    // held along z: the stress along the ring is that of plane strain, N = p R all the same
    CHECK(r.N[0] == Approx(p * R).epsilon(0.01));
    CHECK(r.N[1] == Approx(0.3 * p * R).epsilon(0.01));
    // the same along x, y, z: on the middle surface, and the mean of both faces
    const std::vector<double> stress = s.elements().stress();
    const Elements::FaceStress faces = s.elements().face_stress();
    const double trace = stress[30] + stress[31] + stress[32];
    CHECK(trace == Approx((r.N[0] + r.N[1]) / t));
    for (int k = 0; k < 6; ++k)
        CHECK(0.5 * (faces.top[30 + k] + faces.bottom[30 + k]) == Approx(stress[30 + k]).margin(1));
    s.internal_forces();
    s.pressure_forces(1);
    double support = 0;
    for (std::int32_t n : s.model().mesh.node_sets.at("u0")) support += s.nodes().f[n].c[1];
    CHECK(std::abs(support) == Approx(p * R * 0.2).epsilon(0.01));
}

TEST_CASE("shells give the same bits for one thread and two") {
    ShellCase shell;
    const auto run = [&](int threads) {
        Case c = shell.settings();
        c.info.gravity = {0, 0, -9.81};
        c.fem.support = {{"u0", {"clamp"}}};
        Structure s(build_model(c, sheet(130, 130,
                                         [](double u, double v) -> Vec3 {
                                             return {u, v, 0.1 * u * v};
                                         })),
                    threads);
        const double dt = s.stable_step().dt;
        march(s, dt, 20);
        return std::pair{s.nodes().x, s.energies()};
    };
    const auto [one, energies] = run(1);
    const auto [two, of_two] = run(2);
    CHECK(energies.kinetic == of_two.kinetic);
    CHECK(energies.internal == of_two.internal);
    bool same = true;
    for (std::size_t n = 0; n < one.size(); ++n)
        for (int d = 0; d < 3; ++d) same &= one[n].c[d] == two[n].c[d];
    CHECK(same);
}

TEST_CASE("the stable step of a shell does not depend on how thin it is, and holds") {
    for (double t : {0.02, 1e-4}) {
        ShellCase shell{.thickness = t};
        Structure s(build_model(shell.settings(), sheet(8, 8,
                                                        [](double u, double v) -> Vec3 {
                                                            return {u, v + 0.3 * u, 0.1 * u * v};
                                                        })),
                    1);
        const StableStep stable = s.stable_step();
        CHECK(stable.limiter.find("shell ") == 0);
        const double courant = stable.dt * std::sqrt(2e11 / 0.91 / 8000) / 0.125;
        INFO("t = " << t << ": dt c/h = " << courant);
        CHECK(courant > 0.7);
        for (double factor : {0.99 / 0.9, 1.04 / 0.9}) {
            Structure run(
                build_model(shell.settings(), sheet(8, 8,
                                                    [](double u, double v) -> Vec3 {
                                                        return {u, v + 0.3 * u, 0.1 * u * v};
                                                    })),
                1);
            Nodes& nodes = run.nodes();
            for (std::size_t n = 0; n < nodes.size(); ++n)
                for (int d = 0; d < 3; ++d)
                    nodes.v[n].c[d] = 1e-9 * std::sin(12.9898 * double(n) + 78.233 * d);
            double fastest = 0;
            march(run, factor * run.stable_step().dt, 3000);
            for (const NodeRow& v : run.nodes().v)
                for (int d = 0; d < 3; ++d) fastest += std::abs(v.c[d]);  // keeps a NaN
            fastest /= double(run.nodes().size());
            INFO("factor " << factor << ": mean speed " << fastest << " m/s");
            if (factor < 1.11)
                CHECK(fastest < 1e-7);
            else
                CHECK(!(fastest < 1e-4));
        }
    }
}

TEST_CASE("a coupled shell has two faces half a thickness off, and forces there turn its nodes") {
    ShellCase shell{.thickness = 0.1};
    Case c = shell.settings();
    c.fem.surface = {{"deck", "shell"}};
    Structure s(build_model(c, sheet(2, 2,
                                     [](double u, double v) -> Vec3 {
                                         return {u, v, 0};
                                     })),
                1);
    const CoupledSurface& surface = s.model().surface;
    REQUIRE(surface.node.size() == 18);
    REQUIRE(surface.quad.size() == 8);
    double mass = 0;
    for (std::size_t i = 0; i < 18; ++i) {
        CHECK(std::abs(s.surface_position(i)[2]) == Approx(0.05));
        mass += s.surface_mass(i);
    }
    CHECK(mass < 0.1 * 8000);  // half on either face, less for the turn
    CHECK(mass > 0.8 * 0.1 * 8000);
    // faces look away from each other
    for (const Quad& q : surface.quad) {
        const Row a = s.surface_position(q[1]) - s.surface_position(q[0]);
        const Row b = s.surface_position(q[3]) - s.surface_position(q[0]);
        CHECK((a[0] * b[1] - a[1] * b[0]) * s.surface_position(q[0])[2] > 0);
    }
    // friction along x on the upper face: a moment about y
    std::vector<double> f(3 * 18, 0.0);
    double force = 0, moment = 0;
    for (std::size_t i = 0; i < 18; ++i)
        if (s.surface_position(i)[2] > 0) f[3 * i] = 10, force += 10, moment += 10 * 0.05;
    s.contact_forces(f);
    double on_nodes = 0, on_turns = 0;
    for (const NodeRow& row : s.nodes().f) on_nodes += row.c[0];
    for (const NodeRow& row : shells_of(s).turning().moment) on_turns += row.c[1];
    CHECK(on_nodes == Approx(force));
    CHECK(on_turns == Approx(moment));
    // the work of a step is that of the faces: of the nodes' motion and their turn
    const double dt = 1e-6;
    s.kick(dt);
    double work = 0;
    for (std::size_t i = 0; i < 18; ++i)
        for (int d = 0; d < 3; ++d) work += 0.5 * dt * f[3 * i + d] * s.surface_velocity(i)[d];
    s.drift(dt);
    s.hold();
    s.contact_forces(std::vector<double>(3 * 18, 0.0));
    s.kick(dt);
    CHECK(work > 0);
    CHECK(s.energies().contact / work == Approx(1).epsilon(1e-12));
}

TEST_CASE("a strip of J2 shells that hits its clamp yields, and the energies close") {
    ShellCase shell{.thickness = 0.005};
    Case c = shell.settings();
    c.fem.material[0].kind = MaterialKind::j2;
    c.fem.material[0].yield_stress = 2e8;
    c.fem.material[0].hardening = 1e9;
    c.fem.support = {{"u0", {"clamp"}}};
    Structure s(build_model(c, sheet(20, 4,
                                     [](double u, double v) -> Vec3 {
                                         return {0.5 * u, 0.1 * v, 0};
                                     })),
                1);
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (nodes.inverse_mass[n].c[2] > 0) nodes.v[n].c[2] = 20 * nodes.x[n].c[0] / 0.5;
    const double start = cpu_seconds();
    const double dt = s.stable_step().dt;
    double offset = 0, worst = 0, peak = 0;
    const int steps = int(0.03 / dt);
    march(s, dt, steps, [&](int n) {
        const Energies e = s.energies();
        if (n == 0) offset = e.balance_error();
        peak = std::max(peak, e.kinetic);
        worst = std::max(worst, std::abs(e.balance_error() - offset));
    });
    const Energies e = s.energies();
    WARN("strip bent by its own inertia: "
         << e.plastic / peak << " of the energy went into plastic "
         << "flow, balance off by " << worst / peak << ", hourglass " << e.hourglass / peak << "; "
         << steps << " steps, " << cpu_seconds() - start << " s CPU");
    CHECK(e.plastic > 0.3 * peak);
    CHECK(worst < 1e-4 * peak);
    CHECK(e.hourglass < 0.05 * peak);
}

TEST_CASE("a sheet of [fem.block] has its shells, edges and normals, and other boxes are refused") {
    const Mesh mesh = make_sheet({{{0, 2, -1}, {3, 2, 1}}, {6, 0, 4}, {}, BlockCells::shells});
    CHECK(mesh.shells.size() == 24);
    CHECK(mesh.x.size() == 35);
    CHECK(mesh.facets_of("block", "set").size() == 24);
    for (const auto& [edge, count, axis, place] :
         {std::tuple{"xmin", 5, 0, 0.0}, {"xmax", 5, 0, 3.0}, {"zmin", 7, 2, -1.0}, {"zmax", 7, 2, 1.0}}) {
        const auto nodes = mesh.nodes_of(edge, "set");
        CHECK(nodes.size() == std::size_t(count));
        for (std::int32_t n : nodes) CHECK(mesh.x[n][axis] == place);
    }
    for (const Quad& q : mesh.shells) {  // along + y
        const Vec3 a = mesh.x[q[0]], b = mesh.x[q[1]], c = mesh.x[q[3]];
        CHECK((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]) == Approx(0.25));
    }
    CHECK_THROWS_WITH(make_sheet({{{0, 2, -1}, {3, 2.1, 1}}, {6, 0, 4}, {}, BlockCells::shells}),
                      Catch::Contains("middle surface"));
    CHECK_THROWS_WITH(make_sheet({{{0, 2, -1}, {3, 3, 1}}, {6, 1, 4}, {}, BlockCells::shells}),
                      Catch::Contains("one axis"));
}

TEST_CASE("what a shell cannot do is refused with a sentence") {
    ShellCase shell;
    const auto message = [&](const Case& c) -> std::string {
        try {
            build_model(c, sheet(2, 2, [](double u, double v) -> Vec3 { return {u, v, 0}; }));
        } catch (const InputError& e) {
            return e.what();
        }
        return "";
    };
    Case c = shell.settings();
    c.fem.material[0].kind = MaterialKind::tresca;
    c.fem.material[0].shear_strength = 1e6;
    CHECK_THAT(message(c), Catch::Contains("tresca") && Catch::Contains("j2"));
    c = shell.settings();
    c.fem.part[0].thickness = 0;
    CHECK_THAT(message(c), Catch::Contains("thickness"));
    c = shell.settings();
    c.fem.geostatic = FemGeostatic{"shell", 0, 1};
    c.info.gravity = {0, 0, -9.81};
    CHECK_THAT(message(c), Catch::Contains("fem.geostatic"));
    BlockCase block;
    c = block.settings();
    c.fem.support = {{"xmin", {"clamp"}}};
    CHECK_THROWS_WITH(build_model(c), Catch::Contains("do not turn"));
}

}  // namespace
}  // namespace undertow::fem
