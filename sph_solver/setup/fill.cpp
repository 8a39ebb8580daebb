#include "sph_solver/setup/fill.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

#include "sph_solver/boundary/periodic.hpp"
#include "sph_solver/setup/fill_plan.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

// State, records, lists and their share of walls, as bench_sph_throughput counts them; the state alone.
constexpr double bytes_per_particle = 600, bytes_per_place = 140;

/// Rather a sentence at once than a machine that swaps to death. `each`: bytes that are about to be
/// asked for; count: of particles at most.
void refuse_beyond_memory(const Case& input, double count, double each) {
    const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    if (each * count <= memory) return;
    const double bytes = bytes_per_particle * count;
    throw InputError(fmt::format(
        "{}: sph.spacing = {:.6g} m makes up to {:.3g} particles, which take {:.3g} GiB of memory; this "
        "machine has {:.3g} GiB: use a spacing of {:.2g} m or more.", input.file, input.sph.spacing,
        count, bytes / (1 << 30), memory / (1 << 30),
        input.sph.spacing * 1.05 * std::pow(bytes / memory, 1.0 / input.info.dimension)));
}

}  // namespace

Filled fill_particles(const Case& input, const std::vector<FluidLaw>& fluids) {
    const bool flat = input.info.dimension == 2;
    const double g = std::max(0.0, -balanced_gravity(input)[2]);
    const FillPlan plan(input);
    std::vector<double> density;
    for (const FluidLaw& f : fluids) density.push_back(f.rho0);
    Filled filled;
    Particles& particles = filled.particles;
    std::size_t i = 0;
    for (std::size_t k = 0; k < input.sph.fill.size(); ++k) {
        const Fill& f = input.sph.fill[k];
        const FluidLaw& fluid = fluids[plan.fluid(static_cast<int>(k))];
        const double dx = plan.spacing(static_cast<int>(k));
        const Vec3 behind = ramp_distance(f);
        int n[3], first[3];   // cells in the box, and from its corner to where it starts
        for (int a = 0; a < 3; ++a) {
            const double cells = (f.box.max[a] - f.box.min[a]) / dx;
            n[a] = static_cast<int>(std::lround(cells));
            first[a] = -static_cast<int>(std::lround(behind[a] / dx));
            if (flat && a == 1) {
                n[a] = 1, first[a] = 0;
                continue;
            }
            if (n[a] < 1 || std::abs(cells - n[a]) > 0.01)
                throw InputError(fmt::format(
                    "{}: sph.fill[{}].box is {:.6g} m along {}, {:.3f} spacings of {:.6g} m; it must "
                    "be a whole number: {:.6g} or {:.6g} m.", input.file, k,
                    f.box.max[a] - f.box.min[a], "xyz"[a], cells, dx, std::floor(cells) * dx,
                    std::ceil(cells) * dx));
        }
        filled.first_id.push_back(static_cast<std::int64_t>(i));
        const double places = double(i) + double(n[0]) * n[1] * n[2];
        refuse_beyond_memory(input, places, bytes_per_place);
        particles.resize(i + std::size_t(n[0]) * n[1] * n[2]);
        for (int ix = 0; ix < n[0]; ++ix)
            for (int iy = 0; iy < n[1]; ++iy)
                for (int iz = 0; iz < n[2]; ++iz) {
                    Vec3 x{f.box.min[0] + (first[0] + ix + 0.5) * dx,
                           flat ? 0 : f.box.min[1] + (first[1] + iy + 0.5) * dx,
                           f.box.min[2] + (first[2] + iz + 0.5) * dx};
                    if (plan.owner(x) != static_cast<int>(k)) continue;
                    const double pressure = f.pressure ? (*f.pressure)(x[0], x[1], x[2])
                                                       : plan.pressure_at(x, density, g);
                    if (!plan.clear_obstacles(x, 0.5 * dx)) continue;
                    const Vec3 v = start_velocity(f, x);
                    particles.x[i] = x[0], particles.y[i] = x[1], particles.z[i] = x[2];
                    particles.vx[i] = v[0];
                    particles.vy[i] = flat ? 0 : v[1];
                    particles.vz[i] = v[2];
                    particles.drho[i] = fluid.deviation_at(pressure);
                    particles.fluid[i] = static_cast<std::uint8_t>(plan.fluid(static_cast<int>(k)));
                    particles.id[i] = static_cast<std::int64_t>(i);
                    ++i;
                }
        particles.resize(i);
    }
    filled.first_id.push_back(static_cast<std::int64_t>(i));
    if (i == 0 && input.sph.inflow.empty())
        throw InputError(fmt::format("{}: sph.fill: no particles; add a [[sph.fill]].", input.file));
    if (i > 2000000000u / 8)
        throw InputError(fmt::format("{}: {} particles are more than this version can index.",
                                     input.file, i));
    refuse_beyond_memory(input, double(i), bytes_per_particle);
    return filled;
}

}  // namespace undertow::sph
