#include "fem_solver/setup/mass_scaling.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "fem_solver/elements/element_groups.hpp"
#include "fem_solver/setup/element_volume.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

// Elements of one part have one density in the kernels: factors come in steps of this.
constexpr double factor_step = 1.1;

void make_heavier(Part& part, double factor) {
    part.weight_density = part.weight_density.value_or(part.density);
    part.density *= factor;
}

/// Largest omega^2 that allows the step dt:
/// (omega dt/2)^2 + xi omega dt = cfl^2, xi = b1 + beta omega/2.  [docs/theory_fem.md, 6]
double omega2_for(double dt, double cfl, double b1, double beta) {
    const double a = 0.25 * dt * dt + 0.5 * beta * dt, b = b1 * dt;
    const double omega = 2 * cfl * cfl / (b + std::sqrt(b * b + 4 * a * cfl * cfl));
    return omega * omega;
}

/// mass_factor of the parts, as the case has it.
void scale_whole_parts(const Case& c, std::vector<Part>& parts) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const double factor = c.fem.part[p].mass_factor;
        if (factor == 1) continue;
        if (parts[p].implicit)
            throw InputError(
                "fem.part \"" + parts[p].name +
                "\": mass_factor has no use on an implicit part, which limits no step; "
                "take one of the two out.");
        if (parts[p].elements.empty())
            throw InputError("fem.part \"" + parts[p].name +
                             "\": mass_factor has no use, for all its elements belong to a rigid "
                             "body, which limits no step; take it out.");
        make_heavier(parts[p], factor);
    }
}

/// Splits a part by the factors that its elements need.
void split(const Part& part, const std::vector<double>& omega2, double allowed,
           std::vector<Part>& parts) {
    std::map<int, Part> by_power;
    for (std::int32_t e : part.elements) {
        const double need = omega2[e] / allowed;
        // 1e-9: an element that just meets the step stays as it is
        const int power =
            need <= 1 + 1e-9 ? 0 : int(std::ceil(std::log(need) / std::log(factor_step) - 1e-9));
        const auto [place, is_new] = by_power.try_emplace(power, part);
        if (is_new) {
            place->second.elements.clear();
            if (power > 0) make_heavier(place->second, std::pow(factor_step, power));
        }
        place->second.elements.push_back(e);
    }
    for (auto& [power, scaled] : by_power) parts.push_back(std::move(scaled));
}

void scale_to_step(const Case& c, const Mesh& mesh, std::vector<Part>& parts,
                   const BulkViscosity& viscosity) {
    const double allowed =
        omega2_for(*c.fem.mass_scaling, c.fem.cfl, viscosity.linear, c.fem.damping_beta);
    const std::vector<double> omega2 = Elements(mesh, parts, viscosity).omega2();
    std::vector<Part> scaled;
    bool any = false;
    for (Part& part : parts) {
        if (part.implicit || part.elements.empty()) {
            scaled.push_back(std::move(part));
            continue;
        }
        any = true;
        split(part, omega2, allowed, scaled);
    }
    if (!any)
        throw InputError(
            "fem.mass_scaling has no use: nothing but implicit parts and rigid bodies deforms, and "
            "they limit no step; take it out.");
    parts = std::move(scaled);
}

}  // namespace

std::vector<ScaledPart> scale_masses(const Case& c, const Mesh& mesh, std::vector<Part>& parts,
                                     const BulkViscosity& viscosity) {
    const bool by_part = std::any_of(c.fem.part.begin(), c.fem.part.end(),
                                     [](const FemPart& p) { return p.mass_factor != 1; });
    if (!by_part && !c.fem.mass_scaling) return {};
    std::map<std::string, double> density;  // [kg/m3] of the material
    for (const Part& part : parts) density[part.name] = part.density;
    if (by_part) scale_whole_parts(c, parts);
    if (c.fem.mass_scaling) scale_to_step(c, mesh, parts, viscosity);
    std::vector<ScaledPart> report;
    for (const Part& part : parts) {
        if (report.empty() || report.back().part != part.name) report.push_back({part.name});
        ScaledPart& of_part = report.back();
        for (std::int32_t e : part.elements) {
            const double volume = element_volume(mesh, e, part.thickness);
            of_part.mass += density.at(part.name) * volume;
            of_part.added += (part.density - density.at(part.name)) * volume;
        }
        if (part.density > density.at(part.name)) of_part.elements += part.elements.size();
    }
    return report;
}

}  // namespace undertow::fem
