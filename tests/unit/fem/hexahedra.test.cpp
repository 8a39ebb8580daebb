// Many elements: patch test, momentum, stability, threads.

#include "fem_solver/elements/hexahedra.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "fem_solver/elements/coloring.hpp"
#include "fem_solver/physics/largest_frequency.hpp"
#include "fem_solver/setup/block_mesh.hpp"
#include "support.hpp"

namespace undertow::fem {
namespace {

struct DistortedBlock {
    BlockCase block{{1, 0.8, 1.2}, {4, 5, 3}};
    Model model = build_model(block.settings());
    DistortedBlock(double amount = 0.1) { distort(model.mesh, block, amount); }
};

TEST_CASE("uniform strain gives uniform stress and no force inside (patch test)") {
    DistortedBlock patch;
    Structure s(std::move(patch.model), 1);
    const double H[3][3] = {{1e-6, 2e-7, -3e-7}, {1e-7, -5e-7, 2e-7}, {4e-7, 1e-7, 8e-7}};
    const double dt = 1;
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int i = 0; i < 3; ++i) {
            double u = 0;
            for (int j = 0; j < 3; ++j) u += H[i][j] * nodes.x[n].c[j];
            nodes.v[n].c[i] = u / dt;
        }
    s.elements().step(nodes, dt, 1);
    const std::vector<double> stress = s.elements().stress();
    double largest = 0, spread = 0;
    for (std::size_t e = 0; e < s.elements().size(); ++e)
        for (int k = 0; k < 6; ++k) {
            largest = std::max(largest, std::abs(stress[6 * e + k]));
            spread = std::max(spread, std::abs(stress[6 * e + k] - stress[k]));
        }
    const LinearElastic law = LinearElastic::from_young(1e9, 0.3);
    // small strain against the midpoint rule: a relative difference of the strain's size
    CHECK(stress[0] == Approx(law.lambda * 1.3e-6 + 2 * law.mu * 1e-6).epsilon(3e-6));
    double inside = 0, outside = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double* x = nodes.x0[n].c;
        const bool in = x[0] > 1e-9 && x[0] < 1 - 1e-9 && x[1] > 1e-9 && x[1] < 0.8 - 1e-9 &&
                        x[2] > 1e-9 && x[2] < 1.2 - 1e-9;
        for (int d = 0; d < 3; ++d)
            (in ? inside : outside) = std::max(in ? inside : outside, std::abs(nodes.f[n].c[d]));
    }
    CHECK(spread / largest < 1e-13);  // round-off
    CHECK(inside / outside < 1e-13);
    WARN("patch test: stress spread " << spread / largest << ", forces inside over outside "
                                      << inside / outside);
}

TEST_CASE("a free body keeps its momentum and its moment of momentum") {
    DistortedBlock body;
    Structure s(std::move(body.model), 1);
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int d = 0; d < 3; ++d) nodes.v[n].c[d] = std::sin(3.0 * nodes.x[n].c[(d + 1) % 3] + d);
    const auto momenta = [&](double(&p)[3], double(&L)[3]) {
        for (int d = 0; d < 3; ++d) p[d] = L[d] = 0;
        for (std::size_t n = 0; n < nodes.size(); ++n)
            for (int d = 0; d < 3; ++d) {
                const int a = (d + 1) % 3, b = (d + 2) % 3;
                p[d] += nodes.mass[n] * nodes.v[n].c[d];
                L[d] += nodes.mass[n] *
                        (nodes.x[n].c[a] * nodes.v[n].c[b] - nodes.x[n].c[b] * nodes.v[n].c[a]);
            }
    };
    double p0[3], L0[3], p[3], L[3];
    const double dt = s.stable_step().dt;
    momenta(p0, L0);
    s.internal_forces();
    s.kick(dt);  // from here on L is taken with x^n and v^{n-1/2}, an invariant of leapfrog
    s.drift(dt);
    momenta(p0, L0);
    march(s, dt, 1000);
    momenta(p, L);
    double size = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) size += nodes.mass[n];
    for (int d = 0; d < 3; ++d) {
        CHECK(std::abs(p[d] - p0[d]) / size < 1e-13);  // round-off of 1000 steps
        CHECK(std::abs(L[d] - L0[d]) / size < 1e-12);
    }
    WARN("momentum drift " << std::abs(p[0] - p0[0]) / size << ", moment "
                           << std::abs(L[2] - L0[2]) / size);
}

TEST_CASE("the scheme is stable just below the largest frequency's limit and not beyond") {
    BlockCase block{{0.3, 0.1, 0.1}, {12, 4, 4}};
    Case c = block.settings();
    c.fem.support = {{"xmin", {"x", "y", "z"}}};
    const double factor = GENERATE(0.9, 0.995, 1.03);
    Structure s(build_model(c), 1);
    const LargestFrequency found = find_largest_frequency(s.elements(), s.nodes());
    CHECK(found.converged);
    CHECK(found.omega < s.omega_bound());  // the elements' bound is one
    Nodes& nodes = s.nodes();
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (int d = 0; d < 3; ++d)
            if (nodes.inverse_mass[n].c[d] > 0) nodes.v[n].c[d] = 1e-6 * std::sin(1e5 * n + d);
    double first = 0, last = 0;
    march(s, factor * 2 / found.omega, 2000, [&](int n) {
        if (n == 1) first = s.energies().kinetic + s.energies().internal + s.energies().hourglass;
        if (n < 1990) return;
        last = s.energies().kinetic + s.energies().internal + s.energies().hourglass;
    });
    if (factor < 1)
        CHECK(last == Approx(first).epsilon(1e-3));
    else
        CHECK(!(last < 1e6 * first));
    if (factor == 0.9)
        WARN("largest frequency over the elements' bound: "
             << found.omega / s.omega_bound() << " in " << found.iterations << " iterations");
}

TEST_CASE("no two groups of a color share a node, and every group has a color") {
    std::vector<std::vector<std::int32_t>> groups(60);
    std::uint32_t state = 5;
    for (auto& group : groups)
        for (int k = 0; k < 7; ++k) {
            state = state * 1664525u + 1013904223u;
            group.push_back(std::int32_t(state >> 8) % 90);
        }
    const Coloring coloring = color_by_nodes(groups, 90);
    CHECK(coloring.order.size() == groups.size());
    std::vector<bool> seen(groups.size(), false);
    for (std::size_t c = 0; c + 1 < coloring.begin.size(); ++c) {
        std::vector<int> owner(90, -1);
        for (std::int32_t i = coloring.begin[c]; i < coloring.begin[c + 1]; ++i) {
            const std::int32_t g = coloring.order[i];
            CHECK_FALSE(seen[g]);
            seen[g] = true;
            for (std::int32_t n : groups[g]) {
                CHECK((owner[n] == -1 || owner[n] == g));
                owner[n] = g;
            }
        }
    }
}

TEST_CASE("one and two threads give the same bits") {
    // above 8192: below, threads are not used; in the order of the mesh, and in lumps above 16384
    const int layers = GENERATE(9, 17);
    BlockCase block{{1, 1, 1}, {32, 32, layers}};
    Case c = block.settings();
    c.info.gravity = {0, 0, -9.81};
    c.fem.support = {{"zmin", {"x", "y", "z"}}};
    Structure one(build_model(c), 1), two(build_model(c), 2);
    const auto& batches = dynamic_cast<const Hexahedra&>(*two.elements().groups()[0]).batches();
    CHECK(batches.chunks() > 1);
    CHECK_FALSE(batches.queue().before(batches.chunks() - 1).empty());
    const double dt = one.stable_step().dt;
    march(one, dt, 20);
    march(two, dt, 20);
    CHECK(std::memcmp(one.nodes().x.data(), two.nodes().x.data(),
                      one.nodes().size() * sizeof(NodeRow)) == 0);
    CHECK(one.energies().internal == two.energies().internal);
    CHECK(one.energies().kinetic == two.energies().kinetic);
}

}  // namespace
}  // namespace undertow::fem
