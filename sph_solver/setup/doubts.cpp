#include "sph_solver/setup/doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "wire/errors.hpp"

namespace undertow::sph {

namespace {

// Compression at the start, p/(rho0 c0^2): weakly compressible means 0.01; "auto" makes it 0.0025.
constexpr double doubtful_compression = 0.03, hopeless_compression = 0.3;
// No liquid at room temperature is thinner; liquid carbon dioxide has 7e-5.
constexpr double thinnest_liquid = 5e-5;  // [Pa s]
constexpr double lightest_liquid = 100;   // [kg/m3]
// An opening of fewer spacings lets nothing pass, or single particles.
constexpr double narrowest_opening = 2;

void doubt_sound_speed(const Case& input, const FluidSystem& fluid,
                       std::vector<std::string>& doubts) {
    const Particles& p = fluid.particles;
    if (p.size() == 0) return;
    const auto [low, high] = std::minmax_element(p.z.begin(), p.z.end());
    // far beyond its range the equation of state cannot bear the weight that the fluid has
    const double g_height = std::abs(input.info.gravity[2]) * (*high - *low);  // [m2/s2]
    for (std::size_t f = 0; f < fluid.fluids().size(); ++f) {
        const FluidLaw& law = fluid.fluid(static_cast<int>(f));
        double most = 0;  // [Pa]
        for (std::size_t i = 0; i < p.size(); ++i)
            if (p.fluid[i] == f) most = std::max(most, p.p[i]);
        const double compression = most / (law.rho0 * law.c0 * law.c0);
        if (!(compression > doubtful_compression)) continue;
        const std::string sentence = fmt::format(
            "the sound speed of fluid \"{}\", {:.4g} m/s, is too small: the pressure it starts with, "
            "{:.3g} Pa, compresses it by about {:.2g} %, where 1 % is weakly compressible. Give it "
            "sound_speed = {:.2g} m/s or more, or leave sound_speed and sph.max_speed out (\"auto\").",
            input.sph.fluid[f].name, law.c0, most, 100 * compression,
            std::sqrt(100 * std::max(most / law.rho0, g_height)));
        if (compression > hopeless_compression)
            throw InputError(fmt::format("{}: {}", input.file, sentence));
        doubts.push_back(sentence);
    }
}

void doubt_units(const Case& input, std::vector<std::string>& doubts) {
    double g = 0;
    for (const double a : input.info.gravity) g = std::hypot(g, a);
    const bool on_earth = std::abs(g - 9.81) < 0.05;  // else the case may well have no dimensions
    for (const Fluid& f : input.sph.fluid) {
        if (on_earth && f.density > lightest_liquid && f.viscosity > 0 &&
            f.viscosity < thinnest_liquid)
            doubts.push_back(fmt::format(
                "fluid \"{}\": viscosity = {:.3g} Pa s is less than any liquid has (water: 1e-3). It is "
                "the dynamic viscosity; if {:.3g} is the kinematic one in m2/s, give density times "
                "that, {:.3g}.",
                f.name, f.viscosity, f.viscosity, f.viscosity * f.density));
        if (on_earth && f.density < 25 && f.viscosity > 5e-4)
            doubts.push_back(fmt::format(
                "fluid \"{}\": density = {:.4g} kg/m3 is that of a gas, its viscosity, {:.3g} Pa s, "
                "that of a liquid. Densities are in kg/m3: water has 1000.",
                f.name, f.density, f.viscosity));
    }
}

/// Between bodies as they stand at first and planes.
void doubt_openings(const Case& input, const FluidSystem& fluid,
                    std::vector<std::string>& doubts) {
    const double dx = input.sph.spacing;
    const Bodies& b = fluid.bodies;
    for (std::size_t owner = 0; owner < b.body.size(); ++owner)
        for (const PlaneWall& wall : input.sph.plane) {
            double least = 1e300;
            for (int d = 0; d < b.size(); ++d)
                if (b.owner[d] == static_cast<int>(owner))
                    least = std::min(least, (b.x[d] - wall.point[0]) * wall.normal[0] +
                                                (b.y[d] - wall.point[1]) * wall.normal[1] +
                                                (b.z[d] - wall.point[2]) * wall.normal[2]);
            const double opening = least - 0.5 * dx;  // a dummy stands half a spacing inside
            if (opening < 0.3 * dx || opening > narrowest_opening * dx) continue;
            doubts.push_back(fmt::format(
                "the opening between sph.body \"{}\" and sph.plane \"{}\" is about {:.2g} m, {:.2g} "
                "spacings: less than two let nothing pass or single particles. Close it, or take "
                "sph.spacing = {:.2g} m or less, a quarter of it.",
                b.body[owner].body().name, wall.name, opening, opening / dx, 0.25 * opening));
        }
}

void check_width(const Case& input, const FluidSystem& fluid) {
    const Particles& p = fluid.particles;
    double widest = 0, finest = input.sph.spacing;  // [m]
    for (const auto* x : {&p.x, &p.y, &p.z}) {
        if (x->empty()) continue;
        const auto [lo, hi] = std::minmax_element(x->begin(), x->end());
        widest = std::max(widest, *hi - *lo);
    }
    for (const FluidLaw& f : fluid.fluids()) finest = std::min(finest, f.spacing);
    const double most = widest_scene(input.sph.precision);
    if (widest <= most * finest) return;
    const bool in_float = input.sph.precision == Precision::float32;
    throw InputError(fmt::format(
        "{}: the fluid is {:.3g} m wide, {:.2g} spacings of {:.3g} m; positions in sums tell {:.0e} "
        "apart. {} a coarser spacing, or a smaller scene.",
        input.file, widest, widest / finest, finest, most,
        in_float ? "Take sph.precision = \"double\"," : "Take"));
}

}  // namespace

double widest_scene(Precision precision) {
    return precision == Precision::float32 ? 1e6 : 1e7;
}

std::vector<std::string> doubts_at_start(const Case& input, const FluidSystem& fluid) {
    std::vector<std::string> doubts;
    check_width(input, fluid);
    doubt_sound_speed(input, fluid, doubts);
    doubt_units(input, doubts);
    doubt_openings(input, fluid, doubts);
    return doubts;
}

}  // namespace undertow::sph
