// Element-steps per second of the whole step (stable step, internal forces, health, kick, drift) of
// the one-point hexahedron, the 8-point one and the tetrahedron, double: elastic; Tresca, J2 and
// Mohr-Coulomb that stay elastic, and with every element flowing in every step. Inner nodes moved by a tenth of an
// element. Then the whole step of implicit parts at twenty times the elements' own step: plates one
// element thick, and a cube.
//   bench_fem_throughput [--json | --large | --shells | --materials]
// --large: 262,144 one-point hexahedra, in the order of the mesh and shuffled, memory per element.
// Shells: elastic, and J2 at five points through the thickness.
// Targets: 15 M element-steps/s on one core at 64,000 elements, 20 us per step for 240 elements; 5 M
// for the 8-point hexahedron.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <random>
#include <thread>

#include <sys/resource.h>

#include "fem_solver/setup/block_mesh.hpp"
#include "fem_solver/structure.hpp"

using namespace undertow;
using namespace undertow::fem;

namespace {

double wall_clock() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}
double cpu_clock() {  // of this thread: what other programs take does not count
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// [bytes] most that the process has held.
double peak_memory() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * double(usage.ru_maxrss);
}
/// Prints the figures of `elements`, the largest mesh so far; start and search of the frequency
/// included.
double print_memory(double elements) {
    const double bytes = peak_memory() / elements;
    std::fprintf(stderr, "%8.0f elements: %.0f bytes of memory each\n", elements, bytes);
    return bytes;
}

enum class Law {
    elastic,
    tresca_elastic,
    tresca_flowing,
    j2_elastic,
    j2_flowing,
    mohr_coulomb_elastic,
    mohr_coulomb_flowing
};
constexpr const char* law_names[] = {"",
                                     ", Tresca, all elastic",
                                     ", Tresca, all flowing",
                                     ", J2, all elastic",
                                     ", J2, all flowing",
                                     ", Mohr-Coulomb, all elastic",
                                     ", Mohr-Coulomb, all flowing"};
bool flows(Law law) {
    return law == Law::tresca_flowing || law == Law::j2_flowing || law == Law::mohr_coulomb_flowing;
}
void give_law(FemMaterial& material, Law law) {
    const double strength = flows(law) ? 1e4 : 1e12;  // [Pa]
    switch (law) {
        case Law::elastic:
            return;
        case Law::tresca_elastic:
        case Law::tresca_flowing:
            material.kind = MaterialKind::tresca;
            material.shear_strength = strength;
            return;
        case Law::j2_elastic:
        case Law::j2_flowing:
            material.kind = MaterialKind::j2;
            material.yield_stress = strength;
            material.hardening = 1e9;
            return;
        case Law::mohr_coulomb_elastic:
        case Law::mohr_coulomb_flowing:
            material.kind = MaterialKind::mohr_coulomb;
            material.cohesion = strength;
            material.friction_angle = 30;
            return;
    }
}

/// A kind of elements, as a case names it.
struct Kind {
    const char* name;
    ElementFormulation element = ElementFormulation::automatic;
    BlockCells cells = BlockCells::hexahedra;
    bool shuffled = false;  // elements in no order at all, the worst that a mesh file can be
};
const Kind one_point{""};
const Kind shuffled{", in no order", ElementFormulation::automatic, BlockCells::hexahedra, true};
const Kind eight_point{", 8 points", ElementFormulation::b_bar};
const Kind tetrahedra{", tetrahedra", ElementFormulation::averaged_pressure,
                      BlockCells::tetrahedra};

Model make_model(const std::array<int, 3>& divisions, Law law, const Kind& kind) {
    Case c;
    c.info.gravity = {0, 0, -9.81};
    c.fem.block = FemBlock{
        {{0, 0, 0}, {0.01 * divisions[0], 0.01 * divisions[1], 0.01 * divisions[2]}},
        divisions,
        {},
        kind.cells};
    c.fem.material = {{"steel", MaterialKind::linear_elastic, 7850, {}, 210e9, 0.3, 0}};
    give_law(c.fem.material[0], law);
    c.fem.part = {{"block", "steel", kind.element}};
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    Mesh mesh = make_block(*c.fem.block);
    if (kind.shuffled) {
        std::mt19937 random(3);
        std::shuffle(mesh.hexahedra.begin(), mesh.hexahedra.end(), random);
    }
    c.fem.block.reset();
    Model model = build_model(c, std::move(mesh));
    for (std::size_t n = 0; n < model.mesh.x.size(); ++n)
        for (int d = 0; d < 3; ++d)
            model.mesh.x[n][d] += 0.0005 * std::sin(12.9898 * double(n) + 78.233 * d);
    return model;
}

/// Every node on a course of its own that shears all elements alike, about 1e-6 a step: 10 times
/// the strain at which s_u = 10 kPa is reached.
void shear(Structure& s, double dt) {
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        nodes.inverse_mass[n] = NodeRow{};
        const double* x = nodes.x[n].c;
        const double rate = 1e-6 / dt;
        nodes.v[n] = NodeRow{{rate * x[2], 0.3 * rate * x[0], -0.2 * rate * x[1], 0}};
    }
}

/// [s] of one step, best of eight runs.
double step_time(const std::array<int, 3>& divisions, int threads, Law law, const Kind& kind) {
    Structure s(make_model(divisions, law, kind), threads);
    const double dt = s.stable_step().dt;
    if (flows(law)) shear(s, dt);
    const int steps = std::max(5, int(2e6 / double(s.elements().size())));
    double best = 1e300;
    std::int64_t n = 1;  // shapes are checked in every 256th step, as in a run
    for (int repeat = 0; repeat < 8; ++repeat) {
        const double start = threads > 1 ? wall_clock() : cpu_clock();
        for (int k = 0; k < steps; ++k, ++n) {
            s.stable_step();
            s.internal_forces();
            s.check_health(n, 0);
            s.advance(dt);
        }
        best = std::min(best, ((threads > 1 ? wall_clock() : cpu_clock()) - start) / steps);
    }
    const double yielding = double(s.yielding_elements()) / double(s.elements().size());
    if (yielding != (flows(law) ? 1 : 0))
        std::fprintf(stderr, "warning: %g of the elements yield\n", yielding);
    return best;
}

double print(const std::array<int, 3>& divisions, int threads, Law law = Law::elastic,
             const Kind& kind = one_point) {
    const double elements = double(divisions[0]) * divisions[1] * divisions[2] *
                            (kind.cells == BlockCells::tetrahedra ? 6 : 1);
    const double time = step_time(divisions, threads, law, kind);
    std::fprintf(stderr,
                 "%8.0f elements, %d thread%s: %9.1f us per step, %6.2f M element-steps/s%s%s\n",
                 elements, threads, threads > 1 ? "s" : "", 1e6 * time, 1e-6 * elements / time,
                 kind.name, law_names[int(law)]);
    return elements / time;
}

/// [us] of a whole step with the block implicit, best of five runs.
double print_implicit(const std::array<int, 3>& divisions) {
    Case c;
    c.fem.block = FemBlock{
        {{0, 0, 0}, {0.01 * divisions[0], 0.01 * divisions[1], 0.01 * divisions[2]}}, divisions};
    c.fem.material = {{"steel", MaterialKind::linear_elastic, 7850, {}, 210e9, 0.3, 0}};
    c.fem.part = {{.set = "block", .material = "steel", .implicit = true}};
    c.fem.support = {{"ymin", {"x", "y", "z"}}};
    c.time.max_step = 1;
    Structure s(build_model(c), 1);
    const double dt = 20 * s.implicit()->explicit_step();
    for (std::size_t n = 0; n < s.nodes().size(); ++n)
        if (s.nodes().inverse_mass[n].c[0] > 0) s.nodes().v[n].c[0] = 1e-6;
    const auto step = [&](int n) {
        s.stable_step();
        s.internal_forces();
        s.check_health(n, 0);
        s.advance(dt);
    };
    double start = cpu_clock();
    step(0);  // assembles and factors
    const double first = cpu_clock() - start;
    const int steps = std::clamp(int(2e6 / double(s.implicit()->nonzeros())), 3, 1000);
    double best = 1e300;
    for (int repeat = 0; repeat < 5; ++repeat) {
        start = cpu_clock();
        for (int n = 1; n <= steps; ++n) step(n);
        best = std::min(best, (cpu_clock() - start) / steps);
    }
    std::fprintf(stderr,
                 "implicit, %zu unknowns (%d x %d x %d elements), %.3g M entries of the factor: "
                 "%9.1f us per step, first step %.4g s (%lld factorizations)\n",
                 s.implicit()->unknowns(), divisions[0], divisions[1], divisions[2],
                 1e-6 * double(s.implicit()->nonzeros()), 1e6 * best, first,
                 static_cast<long long>(s.implicit()->factorizations()));
    return 1e6 * best;
}

}  // namespace

enum class Section { elastic, layered, flowing };

/// A square plate of n x n shells, 10 mm each, its inner nodes moved by a tenth of an element.
Model make_plate(int n, Section section) {
    Case c;
    c.info.gravity = {0, 0, -9.81};
    c.fem.material = {{"steel", MaterialKind::linear_elastic, 7850, {}, 210e9, 0.3, 0}};
    if (section != Section::elastic) {
        c.fem.material[0].kind = MaterialKind::j2;
        c.fem.material[0].yield_stress = section == Section::layered ? 1e12 : 1e3;
        c.fem.material[0].hardening = 1e9;
    }
    c.fem.part = {{"plate", "steel", ElementFormulation::shell, 0.002}};
    Mesh mesh;
    mesh.source = "plate";
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const double k = i + 1000.0 * j;
            mesh.x.push_back({0.01 * i + 0.0005 * std::sin(12.9898 * k),
                              0.01 * j + 0.0005 * std::sin(78.233 * k),
                              0.0005 * std::sin(39.346 * k)});
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = i + (n + 1) * j;
            mesh.volume_sets["plate"].push_back(std::int32_t(mesh.shells.size()));
            mesh.shells.push_back({a, a + 1, a + n + 2, a + n + 1});
            mesh.element_tag.push_back(std::int64_t(mesh.shells.size()));
        }
    return build_model(c, std::move(mesh));
}

/// Element-steps per second of the whole step of n x n shells on one core, best of eight runs.
double print_shells(int n, Section section) {
    Structure s(make_plate(n, section), 1);
    const double dt = s.stable_step().dt;
    if (section == Section::flowing) shear(s, dt);
    const double elements = double(n) * n;
    const int steps = std::max(5, int(1e6 / elements));
    double best = 1e300;
    for (int repeat = 0; repeat < 8; ++repeat) {
        const double start = cpu_clock();
        for (int k = 0; k < steps; ++k) {
            s.stable_step();
            s.internal_forces();
            s.check_health(k + 1, 0);
            s.advance(dt);
        }
        best = std::min(best, (cpu_clock() - start) / steps);
    }
    const double yielding = double(s.yielding_elements()) / elements;
    if (yielding != (section == Section::flowing ? 1 : 0))
        std::fprintf(stderr, "warning: %g of the shells yield\n", yielding);
    std::fprintf(stderr, "%8.0f shells, 1 thread: %9.1f us per step, %6.2f M element-steps/s, %s\n",
                 elements, 1e6 * best, 1e-6 * elements / best,
                 section == Section::elastic   ? "elastic"
                 : section == Section::layered ? "J2 at five points, all elastic"
                                               : "J2 at five points, all flowing");
    return elements / best;
}

/// J2 and Mohr-Coulomb in 64,000 elements of each kind; prints their figures for --json.
void print_materials(bool json) {
    const struct {
        const Kind& kind;
        std::array<int, 3> divisions;
        const char* name;
    } of_kind[] = {{one_point, {40, 40, 40}, "hex1"},
                   {eight_point, {40, 40, 40}, "hex8_bbar"},
                   {tetrahedra, {22, 22, 22}, "tet4"}};
    const struct {
        Law law;
        const char* name;
    } of_law[] = {{Law::j2_elastic, "j2"},
                  {Law::j2_flowing, "j2_flowing"},
                  {Law::mohr_coulomb_elastic, "mohr_coulomb"},
                  {Law::mohr_coulomb_flowing, "mohr_coulomb_flowing"}};
    for (const auto& k : of_kind)
        for (const auto& l : of_law) {
            const double rate = print(k.divisions, 1, l.law, k.kind);
            if (json) std::printf("\"fem.%s_%s\": %.4g, ", k.name, l.name, rate);
        }
}

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "--materials") == 0) {
        print_materials(false);
        return 0;
    }
    if (argc > 1 && std::strcmp(argv[1], "--shells") == 0) {
        for (Section section : {Section::elastic, Section::layered, Section::flowing})
            print_shells(200, section);
        return 0;
    }
    if (argc > 1 && std::strcmp(argv[1], "--large") == 0) {
        const double one = print({64, 64, 64}, 1);
        print_memory(64.0 * 64 * 64);
        print({64, 64, 64}, 1, Law::elastic, shuffled);
        std::fprintf(stderr, "two threads: %.2f times\n", print({64, 64, 64}, 2) / one);
        return 0;
    }
    print({12, 1, 20}, 1);  // a wall
    print({20, 20, 20}, 1);
    const double rate = print({40, 40, 40}, 1);
    const double tresca = print({40, 40, 40}, 1, Law::tresca_elastic);
    const double flowing = print({40, 40, 40}, 1, Law::tresca_flowing);
    const std::array<int, 3> cube{40, 40, 40}, small{22, 22, 22};  // 64,000 elements
    const double eight = print(cube, 1, Law::elastic, eight_point);
    const double eight_tresca = print(cube, 1, Law::tresca_elastic, eight_point);
    const double eight_flowing = print(cube, 1, Law::tresca_flowing, eight_point);
    const double four = print(small, 1, Law::elastic, tetrahedra);
    const double four_tresca = print(small, 1, Law::tresca_elastic, tetrahedra);
    const double four_flowing = print(small, 1, Law::tresca_flowing, tetrahedra);
    const double large = print({64, 64, 64}, 1);
    const double bytes = print_memory(64.0 * 64 * 64);
    const double shell = print_shells(200, Section::elastic);
    const double layered = print_shells(200, Section::layered);
    const double shell_flowing = print_shells(200, Section::flowing);
    const int cores = int(std::thread::hardware_concurrency());
    const double two = cores > 1 ? print({64, 64, 64}, 2) : large;
    const double implicit[4] = {print_implicit({1, 12, 12}), print_implicit({1, 28, 28}),
                                print_implicit({1, 57, 57}), print_implicit({1, 90, 90})};
    print_implicit({12, 12, 12});
    const bool json = argc > 1 && std::strcmp(argv[1], "--json") == 0;
    if (json) std::printf("{");
    print_materials(json);
    if (json)
        std::printf(
            "\"fem.hex1_elastic\": %.4g, \"fem.hex1_tresca\": %.4g, "
            "\"fem.hex1_tresca_flowing\": %.4g, \"fem.hex8_bbar\": %.4g, "
            "\"fem.hex8_bbar_tresca\": %.4g, \"fem.hex8_bbar_tresca_flowing\": %.4g, "
            "\"fem.tet4\": %.4g, \"fem.tet4_tresca\": %.4g, \"fem.tet4_tresca_flowing\": %.4g, "
            "\"fem.shell4\": %.4g, \"fem.shell4_j2\": %.4g, \"fem.shell4_j2_flowing\": %.4g, "
            "\"fem.hex1_large\": %.4g, \"fem.bytes_per_element\": %.4g, "
            "\"fem.two_thread_speedup\": %.3f, "
            "\"fem.implicit_us_per_step.1000\": %.4g, \"fem.implicit_us_per_step.5000\": %.4g, "
            "\"fem.implicit_us_per_step.20000\": %.4g, \"fem.implicit_us_per_step.50000\": %.4g}\n",
            rate, tresca, flowing, eight, eight_tresca, eight_flowing, four, four_tresca,
            four_flowing, shell, layered, shell_flowing, large, bytes, two / large, implicit[0],
            implicit[1], implicit[2], implicit[3]);
}
