#include "sph_solver/physics/fluid_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sph_solver/boundary/periodic.hpp"
#include "sph_solver/particles.hpp"
#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

/// Largest initial speed of a fill [m/s]; that of formulas from samples, 16 to each side of its box.
double start_speed(const Fill& f) {
    const auto size = [](const Vec3& v) { return std::hypot(v[0], v[1], v[2]); };
    if (f.velocity_field.empty()) return size(f.velocity);
    constexpr int samples = 16;
    double speed = 0;
    for (int n = 0; n < samples * samples * samples; ++n) {
        const int cell[3] = {n % samples, n / samples % samples, n / (samples * samples)};
        Vec3 x, v;
        for (int a = 0; a < 3; ++a)
            x[a] = f.box.min[a] + (cell[a] + 0.5) / samples * (f.box.max[a] - f.box.min[a]);
        for (int a = 0; a < 3; ++a) v[a] = f.velocity_field[a](x[0], x[1], x[2]);
        speed = std::max(speed, size(v));
    }
    return speed;
}

/// Largest speed that comes through an opening [m/s], from 16 samples to each side and in time.
double inflow_speed(const Inflow& f, double end) {
    constexpr int samples = 16;
    const int across = f.normal[0] != 0 ? 1 : 0, up = f.normal[2] != 0 ? 1 : 2;
    double speed = 0;
    for (int n = 0; n < samples * samples * samples; ++n) {
        Vec3 x = f.box.min;
        x[across] += (n % samples + 0.5) / samples * (f.box.max[across] - f.box.min[across]);
        x[up] += (n / samples % samples + 0.5) / samples * (f.box.max[up] - f.box.min[up]);
        const double t = end * (n / (samples * samples) + 1) / samples;
        speed = std::max(speed, (*f.velocity)(x[0], x[1], x[2], t));
    }
    return speed;
}

}  // namespace

double expected_speed(const Case& input) {
    if (input.sph.max_speed > 0) return input.sph.max_speed;
    double low = 1e300, high = -1e300, speed = 0;
    for (const Fill& f : input.sph.fill) {
        low = std::min(low, f.box.min[2]);
        high = std::max(high, f.surface_level.value_or(f.box.max[2]));
        speed = std::max(speed, start_speed(f));
    }
    for (const Inflow& f : input.sph.inflow) speed = std::max(speed, inflow_speed(f, input.time.end));
    const Vec3 g = balanced_gravity(input);   // along periodic axes nothing bounds the fall
    const double fall = std::hypot(g[0], g[1], g[2]) * std::max(0.0, high - low);
    const double expected = 2 * std::sqrt(fall) + speed;
    if (!(expected > 0))
        throw InputError(fmt::format(
            "{}: sph.fluid.sound_speed = \"auto\" needs sph.max_speed, the largest expected speed "
            "[m/s]: without gravity and initial velocity it cannot be estimated.",
            input.file));
    return expected;
}

namespace {

FluidLaw resolve_fluid(const Case& input, const Fluid& f) {
    FluidLaw law;
    law.rho0 = f.density;
    law.mu = f.viscosity;
    law.c0 = f.sound_speed ? *f.sound_speed : 10 * expected_speed(input);
    law.equation_of_state = f.equation_of_state;
    law.us_up = {law.rho0, law.c0, f.hugoniot_slope, f.gruneisen};
    law.tait = {law.rho0, law.c0, f.tait_exponent};
    law.rheology = {f.yield_stress, f.consistency, f.flow_index, f.viscosity, f.max_viscosity};
    const double dx = f.spacing > 0 ? f.spacing : input.sph.spacing;
    law.spacing = dx;
    law.h = input.sph.smoothing_ratio * dx;
    law.volume = input.info.dimension == 3 ? dx * dx * dx : dx * dx;
    law.mass = law.rho0 * law.volume * (input.info.dimension == 3 ? 1 : input.info.thickness);
    return law;
}

}  // namespace

std::vector<FluidLaw> resolve_fluids(const Case& input) {
    if (input.sph.fluid.empty())
        throw InputError(input.file + ": sph.fluid: no fluid; add a [[sph.fluid]].");
    if (input.sph.fluid.size() > FluidTag::most)
        throw InputError(fmt::format("{}: sph.fluid: {} fluids given; at most {} are allowed.",
                                     input.file, input.sph.fluid.size(), FluidTag::most));
    std::vector<FluidLaw> laws;
    for (const Fluid& f : input.sph.fluid) laws.push_back(resolve_fluid(input, f));
    return laws;
}

}  // namespace undertow::sph
