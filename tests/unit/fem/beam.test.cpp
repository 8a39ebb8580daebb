// Bending with few elements through the depth: what the physical hourglass stiffness is for.

#include <catch2/catch.hpp>
#include <cmath>

#include "support.hpp"

namespace undertow::fem {
namespace {

const double pi = std::acos(-1.0);

enum class Ends { clamped_free, free_free };

double first_root(Ends ends) {
    return ends == Ends::clamped_free ? first_cantilever_root : 4.7300407448627040;
}

/// First frequency of a Timoshenko beam over that of Euler and Bernoulli: the shear correction.
/// Shear coefficient of Cowper 1966 for the rectangle.
///   [frequency equations of Huang 1961, J. Appl. Mech. 28, 579]
double timoshenko_ratio(Ends ends, double length, double depth, double nu) {
    const double kappa = 10 * (1 + nu) / (12 + 11 * nu);
    const double r2 = depth * depth / 12 / (length * length);
    const double s2 = r2 * 2 * (1 + nu) / kappa;
    const auto equation = [&](double b) {
        const double root = std::sqrt((r2 - s2) * (r2 - s2) + 4 / (b * b));
        const double alpha = b * std::sqrt(0.5 * (-(r2 + s2) + root));
        const double beta = b * std::sqrt(0.5 * ((r2 + s2) + root));
        const double cc = std::cosh(alpha) * std::cos(beta);
        const double ss = std::sinh(alpha) * std::sin(beta) * b / std::sqrt(1 - b * b * r2 * s2);
        if (ends == Ends::clamped_free)
            return 2 + (b * b * (r2 - s2) * (r2 - s2) + 2) * cc - (r2 + s2) * ss;
        return 2 - 2 * cc + (b * b * r2 * (r2 - s2) * (r2 - s2) + 3 * r2 - s2) * ss;
    };
    const double euler = first_root(ends) * first_root(ends);
    double low = 0.8 * euler, high = 1.02 * euler;
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (equation(low) * equation(middle) > 0 ? low : high) = middle;
    }
    return low / euler;
}

/// First bending frequency (in z) of a beam along x over that of Euler and Bernoulli. The free beam
/// is modeled by its half beyond the plane of symmetry x = 0, so that nothing holds its sections.
double frequency_ratio(Ends ends, const BlockCase& block) {
    Case c = block.settings();
    if (ends == Ends::clamped_free)
        c.fem.support = {{"xmin", {"x", "y", "z"}}};
    else
        c.fem.support = {{"xmin", {"x"}}, {"ymin", {"y"}}};
    Structure s(build_model(c), 1);
    Nodes& nodes = s.nodes();
    const double L = (ends == Ends::clamped_free ? 1 : 2) * block.size[0], H = block.size[2];
    const double root = first_root(ends);
    const double euler = root * root / (L * L) *
                         std::sqrt(block.young_modulus / block.density * H * H / 12) / (2 * pi);
    double momentum = 0, mass = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double X = root * nodes.x0[n].c[0] / L;
        double shape;
        if (ends == Ends::clamped_free)
            shape = std::cosh(X) - std::cos(X) - 0.734095513759 * (std::sinh(X) - std::sin(X));
        else
            shape = std::cos(X) / std::cos(root / 2) + std::cosh(X) / std::cosh(root / 2);
        nodes.v[n].c[2] = nodes.inverse_mass[n].c[2] > 0 ? 1e-5 * H * euler * shape : 0;
        momentum += nodes.mass[n] * nodes.v[n].c[2];
        mass += nodes.mass[n];
    }
    if (ends == Ends::free_free)
        for (std::size_t n = 0; n < nodes.size(); ++n) nodes.v[n].c[2] -= momentum / mass;
    const std::int32_t tip = std::int32_t(nodes.size()) - 1;
    const double dt = s.stable_step().dt;
    double before = 0, first = 0, last = 0;
    int crossings = 0;
    march(s, dt, int(5.2 / euler / dt), [&](int n) {
        const double u = s.displacement(tip)[2];
        if (before < 0 && u >= 0) {  // upward zero crossings, interpolated
            const double t = (n - u / (u - before)) * dt;
            (crossings++ == 0 ? first : last) = t;
        }
        before = u;
    });
    return (crossings - 1) / (last - first) / euler;
}

TEST_CASE("a cantilever has its first frequency to 1 percent, two elements deep or one") {
    // Beam theory lets the clamped section contract; the model's clamp does not, and a mesh of
    // eight elements through the depth is 0.5 % above Timoshenko for nu = 0.3 (0.0 % for nu = 0).
    const double nu = GENERATE(0.0, 0.3);
    const double exact = timoshenko_ratio(Ends::clamped_free, 1, 0.1, nu);
    const auto ratio = [&](std::array<int, 3> divisions) {
        return frequency_ratio(
                   Ends::clamped_free,
                   {.size = {1, 0.1, 0.1}, .divisions = divisions, .poisson_ratio = nu}) /
               exact;
    };
    const double cubes2 = ratio({20, 2, 2}), bricks2 = ratio({12, 3, 2});
    const double cubes1 = ratio({10, 1, 1}), bricks1 = ratio({16, 2, 1});
    WARN("cantilever L/H 10, nu " << nu << ", f1 over Timoshenko (" << exact
                                  << " of Euler-Bernoulli): 2 deep " << cubes2
                                  << ", as 83 x 33 x 50 mm " << bricks2 << "; 1 deep " << cubes1
                                  << ", as 62 x 50 x 100 mm " << bricks1);
    for (double r : {cubes2, bricks2, cubes1, bricks1}) CHECK(r == Approx(1).epsilon(0.01));
}

TEST_CASE("a free beam has its first frequency to 1 percent, two elements deep, at nu = 0.49 too") {
    const double nu = GENERATE(0.3, 0.49);
    const double exact = timoshenko_ratio(Ends::free_free, 1.5, 0.1, nu);
    const auto ratio = [&](std::array<int, 3> divisions) {
        return frequency_ratio(
                   Ends::free_free,
                   {.size = {0.75, 0.05, 0.1}, .divisions = divisions, .poisson_ratio = nu}) /
               exact;
    };
    const double two = ratio({16, 1, 2}), one = ratio({8, 1, 1}), four = ratio({30, 2, 4});
    WARN("free beam L/H 15, nu " << nu << ", f1 over Timoshenko (" << exact
                                 << " of Euler-Bernoulli): 1 deep " << one << ", 2 deep " << two
                                 << ", 4 deep " << four);
    CHECK(two == Approx(1).epsilon(0.01));
    CHECK(four == Approx(1).epsilon(0.003));
    // One element deep all mass lies on the surfaces: three times the rotary inertia H^2/12 of the
    // section, which costs a free beam of this slenderness 1.8 % of its frequency.
    CHECK(one == Approx(1 - 0.018).epsilon(0.01));
}

TEST_CASE("8-point hexahedra and tetrahedra come to the beam's frequency with the mesh") {
    // A free beam is held nowhere, so theory and solid agree to 0.1 %. Both elements are stiff in
    // bending when the mesh is coarse: what counts is that the error falls with its square.
    const auto [element, cells, name, limit] =
        GENERATE(std::tuple{ElementFormulation::b_bar, BlockCells::hexahedra, "8-point", 0.01},
                 std::tuple{ElementFormulation::averaged_pressure, BlockCells::tetrahedra,
                            "tetrahedra", 0.05});
    const double nu = GENERATE(0.3, 0.49);
    const double exact = timoshenko_ratio(Ends::free_free, 1.5, 0.1, nu);
    double error[3];
    for (int k = 0; k < 3; ++k) {
        const int n = 1 << k;
        error[k] = frequency_ratio(Ends::free_free, {.size = {0.75, 0.05, 0.1},
                                                     .divisions = {15 * n, n, 2 * n},
                                                     .poisson_ratio = nu,
                                                     .element = element,
                                                     .cells = cells}) /
                       exact -
                   1;
    }
    WARN(name << ", nu " << nu << ": f1 over Timoshenko - 1: " << error[0] << ", " << error[1]
              << ", " << error[2] << "; order " << std::log2(std::abs(error[1] / error[2])));
    CHECK(std::abs(error[2]) < limit);
    CHECK(std::abs(error[2]) < 0.4 * std::abs(error[1]));
}

}  // namespace
}  // namespace undertow::fem
