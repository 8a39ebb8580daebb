#include "sph_solver/setup/relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "sph_solver/fluid_system.hpp"
#include "sph_solver/setup/fill_plan.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

constexpr int most_iterations = 60;
constexpr double share = 0.2;    // C: half of what is stable, C h^2 |grad of the sum| < 1
constexpr double longest = 0.1;  // [dx] of one shift

/// Is there fluid, body or wall all around, as far as the kernel reaches?
bool enclosed(const FluidSystem& fluid, const FillPlan& plan, const Vec3& x) {
    const double dx = fluid.spacing();
    const bool flat = fluid.physics().dimension == 2;
    const int rings = static_cast<int>(std::ceil(fluid.support() / dx));
    for (int k = 0; k < 27; ++k) {
        const Vec3 direction{k % 3 - 1.0, flat ? 0.0 : k / 3 % 3 - 1.0, k / 9 - 1.0};
        if (length(direction) == 0) continue;
        for (int ring = 1; ring <= rings; ++ring) {
            Vec3 at = x + (ring * dx / length(direction)) * direction;
            fluid.periodic().wrap(at.data());
            if (plan.owner(at) < 0 && !fluid.mirror().behind(at[0], at[1], at[2]) &&
                !plan.in_body(at))
                return false;
        }
    }
    return true;
}

}  // namespace

Relaxation relax(FluidSystem& fluid, const Case& input) {
    const FillPlan plan(input);
    Particles& s = fluid.particles;
    const double dx = fluid.spacing(), h = fluid.physics().h;
    std::vector<char> moves(s.size());  // by identity
    const int n = static_cast<int>(s.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (int i = 0; i < n; ++i) moves[s.id[i]] = enclosed(fluid, plan, {s.x[i], s.y[i], s.z[i]});

    Relaxation result;
    for (;; ++result.iterations) {
        fluid.sum_under_even_pressure();  // accelerations -2/rho sum V grad W
        double sum = 0, furthest = 0;
        std::int64_t count = 0;
        for (std::size_t i = 0; i < s.size(); ++i) {
            if (!moves[s.id[i]]) continue;
            const double half_rho = 0.5 * fluid.fluid_of(i).rho0;
            const Vec3 gradient{half_rho * s.ax[i], half_rho * s.ay[i], half_rho * s.az[i]};
            sum += dot(gradient, gradient), ++count;
            Vec3 shift = (share * h * h) * gradient;
            const double size = length(shift);
            if (size > longest * dx) shift = (longest * dx / size) * shift;
            Vec3 at = Vec3{s.x[i], s.y[i], s.z[i]} + shift;
            const Vec3 wanted = at;
            // too close to a body: back to half a spacing, unless it would stand inside
            if (!plan.clear_obstacles(at, 0.5 * dx)) continue;
            // a hair inside that clearance is what an even spread asks for
            if (length(at - wanted) < 0.25 * dx) at = wanted;
            furthest = std::max(furthest, std::min(size, longest * dx));
            s.x[i] = at[0], s.y[i] = at[1], s.z[i] = at[2];
        }
        const double rms = count ? dx * std::sqrt(sum / double(count)) : 0;
        if (result.iterations == 0) result.before = rms;
        result.after = rms;
        fluid.moved(furthest);
        if (result.iterations == most_iterations || furthest < 1e-3 * dx) break;
    }
    std::vector<double> density;
    for (const FluidLaw& f : fluid.fluids()) density.push_back(f.rho0);
    const double g = std::max(0.0, -input.info.gravity[2]);
    for (std::size_t i = 0; i < s.size(); ++i) {
        const Vec3 x{s.x[i], s.y[i], s.z[i]};
        const int owner = plan.owner(x);
        if (owner < 0 || !moves[s.id[i]]) continue;
        const Fill& fill = input.sph.fill[owner];
        const double pressure =
            fill.pressure ? (*fill.pressure)(x[0], x[1], x[2]) : plan.pressure_at(x, density, g);
        s.drho[i] = fluid.fluid_of(i).deviation_at(pressure);
    }
    return result;
}

}  // namespace undertow::sph
