#include "sph_solver/setup/fill.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "wire/errors.hpp"

namespace undertow::sph {

double expected_speed(const Case& input) {
    if (input.sph.max_speed > 0) return input.sph.max_speed;
    double low = 1e300, high = -1e300, speed = 0;
    for (const Fill& f : input.sph.fill) {
        low = std::min(low, f.box.min[2]);
        high = std::max(high, f.surface_level.value_or(f.box.max[2]));
        speed = std::max(speed, std::hypot(f.velocity[0], f.velocity[1], f.velocity[2]));
    }
    const Vec3& g = input.info.gravity;
    const double fall = std::hypot(g[0], g[1], g[2]) * std::max(0.0, high - low);
    const double expected = 2 * std::sqrt(fall) + speed;
    if (!(expected > 0))
        throw InputError(fmt::format(
            "{}: sph.fluid.sound_speed = \"auto\" needs sph.max_speed, the largest expected speed "
            "[m/s]: without gravity and initial velocity it cannot be estimated.", input.file));
    return expected;
}

FluidLaw resolve_fluid(const Case& input) {
    if (input.sph.fluid.size() != 1)
        throw InputError(fmt::format(
            "{}: sph.fluid: {} fluids given; this version computes exactly one.", input.file,
            input.sph.fluid.size()));
    const Fluid& f = input.sph.fluid.front();
    FluidLaw law;
    law.rho0 = f.density;
    law.mu = f.viscosity;
    law.c0 = f.sound_speed ? *f.sound_speed : 10 * expected_speed(input);
    law.equation_of_state = f.equation_of_state;
    law.us_up = {law.rho0, law.c0, f.hugoniot_slope, f.gruneisen};
    law.tait = {law.rho0, law.c0, f.tait_exponent};
    const double dx = input.sph.spacing;
    law.volume = input.info.dimension == 3 ? dx * dx * dx : dx * dx;
    law.mass = law.rho0 * law.volume * (input.info.dimension == 3 ? 1 : input.info.thickness);
    return law;
}

Particles fill_particles(const Case& input, const FluidLaw& fluid) {
    const double dx = input.sph.spacing;
    const bool flat = input.info.dimension == 2;
    const double g = -input.info.gravity[2];
    Particles particles;
    std::size_t total = 0;
    for (std::size_t k = 0; k < input.sph.fill.size(); ++k) {
        const Fill& f = input.sph.fill[k];
        int n[3];
        for (int a = 0; a < 3; ++a) {
            const double cells = (f.box.max[a] - f.box.min[a]) / dx;
            n[a] = static_cast<int>(std::lround(cells));
            if (flat && a == 1) {
                n[a] = 1;
                continue;
            }
            if (n[a] < 1 || std::abs(cells - n[a]) > 0.01)
                throw InputError(fmt::format(
                    "{}: sph.fill[{}].box is {:.6g} m along {}, {:.3f} spacings of {:.6g} m; it must "
                    "be a whole number: {:.6g} or {:.6g} m.", input.file, k,
                    f.box.max[a] - f.box.min[a], "xyz"[a], cells, dx, std::floor(cells) * dx,
                    std::ceil(cells) * dx));
        }
        const double surface = f.surface_level.value_or(f.box.max[2]);
        particles.resize(total + std::size_t(n[0]) * n[1] * n[2]);
        std::size_t i = total;
        for (int ix = 0; ix < n[0]; ++ix)
            for (int iy = 0; iy < n[1]; ++iy)
                for (int iz = 0; iz < n[2]; ++iz, ++i) {
                    particles.x[i] = f.box.min[0] + (ix + 0.5) * dx;
                    particles.y[i] = flat ? 0 : f.box.min[1] + (iy + 0.5) * dx;
                    particles.z[i] = f.box.min[2] + (iz + 0.5) * dx;
                    particles.vx[i] = f.velocity[0];
                    particles.vy[i] = flat ? 0 : f.velocity[1];
                    particles.vz[i] = f.velocity[2];
                    const double depth = std::max(0.0, surface - particles.z[i]);
                    particles.drho[i] = fluid.deviation_at(fluid.rho0 * std::max(0.0, g) * depth);
                    particles.id[i] = static_cast<std::int64_t>(i);
                }
        total = i;
    }
    if (total == 0)
        throw InputError(fmt::format("{}: sph.fill: no particles; add a [[sph.fill]].", input.file));
    if (total > 2000000000u / 8)
        throw InputError(fmt::format("{}: {} particles are more than this version can index.",
                                     input.file, total));
    return particles;
}

}  // namespace undertow::sph
