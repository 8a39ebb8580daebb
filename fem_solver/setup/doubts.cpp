#include "fem_solver/setup/doubts.hpp"

#include <cmath>

#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

constexpr double lightest = 10;    // [kg/m3] the lightest foams that are built with
constexpr double heaviest = 3e4;   // [kg/m3] osmium has 2.26e4
constexpr double softest = 50;     // [Pa] jelly has hundreds
constexpr double stiffest = 2e12;  // [Pa] diamond has 1.2e12

}  // namespace

std::vector<std::string> doubts(const Case& c) {
    const Vec3& g = c.info.gravity;
    if (std::abs(std::hypot(g[0], g[1], g[2]) - 9.81) > 0.02) return {};
    std::vector<std::string> told;
    const auto doubt = [&](const FemMaterial& m, const char* key, double value, const char* what) {
        told.push_back("fem.material \"" + m.name + "\": " + key + " = " + number_text(value) +
                       what);
    };
    for (const FemMaterial& m : c.fem.material) {
        if (m.density < lightest)
            doubt(m, "density", m.density,
                  " is that of a gas; densities are in kg/m3: steel has 7850");
        if (m.density > heaviest)
            doubt(m, "density", m.density,
                  " is more than any solid has; densities are in kg/m3: steel has 7850");
        if (m.young_modulus > 0 && m.young_modulus < softest)
            doubt(m, "young_modulus", m.young_modulus,
                  " is less than any solid has; moduli are in Pa: rubber has 1e6 to 1e7, steel "
                  "2.1e11");
        if (m.young_modulus > stiffest)
            doubt(m, "young_modulus", m.young_modulus,
                  " is more than any solid has; moduli are in Pa: steel has 2.1e11");
    }
    return told;
}

}  // namespace undertow::fem
