#pragma once
// The laws a part can follow. An element's kernel is compiled once for each.

#include <variant>

#include "fem_solver/materials/depth.hpp"
#include "fem_solver/materials/j2.hpp"
#include "fem_solver/materials/linear_elastic.hpp"
#include "fem_solver/materials/mohr_coulomb.hpp"
#include "fem_solver/materials/tresca.hpp"

namespace undertow::fem {

using Material =
    std::variant<LinearElastic, Tresca, J2, MohrCoulomb, WithDepth<Tresca>, WithDepth<MohrCoulomb>>;

template <class Law>
inline constexpr bool depends_on_depth = false;
template <class Law>
inline constexpr bool depends_on_depth<WithDepth<Law>> = true;

inline bool varies_with_depth(const Material& material) {
    return std::visit([]<class Law>(const Law&) { return depends_on_depth<Law>; }, material);
}
/// The law at a height z [m]: of the same kind everywhere.
inline Material law_at(const Material& material, double z) {
    return std::visit(
        [&]<class Law>(const Law& law) -> Material {
            if constexpr (depends_on_depth<Law>)
                return law.at(z);
            else
                return law;
        },
        material);
}

inline const LinearElastic& elastic_moduli(const LinearElastic& law) {
    return law;
}
template <class Law>
const LinearElastic& elastic_moduli(const Law& law) {
    return law.elastic;
}
/// Moduli of small strains, the same everywhere; Poisson's ratio alone where they depend on depth.
inline const LinearElastic& form_moduli(const Material& material) {
    return std::visit(
        []<class Law>(const Law& law) -> const LinearElastic& {
            if constexpr (depends_on_depth<Law>)
                return law.form.elastic;
            else
                return elastic_moduli(law);
        },
        material);
}
/// The moduli of small strains at a height z [m], which set wave speeds and the stable step.
inline LinearElastic elastic_moduli(const Material& material, double z) {
    return std::visit(
        [&]<class Law>(const Law& law) -> LinearElastic {
            if constexpr (depends_on_depth<Law>)
                return law.at(z).elastic;
            else
                return elastic_moduli(law);
        },
        material);
}
inline bool is_plastic(const Material& material) {
    return std::visit([](const auto& law) { return law.plastic; }, material);
}
template <class Law>
constexpr bool law_hardens() {
    if constexpr (Law::plastic) return Law::hardens;
    return false;
}
/// Whether the mean stress may be another one than that of the elements' shared change of volume:
/// plastic flow changes the volume, or moduli depend on the place.
inline bool dilates(const Material& material) {
    return std::visit([](const auto& law) { return law.dilates; }, material);
}
/// Whether the strength at a point depends on its plastic strain.
inline bool hardens(const Material& material) {
    return std::visit([]<class Law>(const Law&) { return law_hardens<Law>(); }, material);
}

/// [Pa] what the field "strength" shows: s_u of Tresca, c of Mohr-Coulomb at a height z [m]; 0 of
/// others.
inline double strength_at(const Material& material, double z) {
    if (const auto* law = std::get_if<WithDepth<Tresca>>(&material)) return law->strength_at(z);
    if (const auto* law = std::get_if<WithDepth<MohrCoulomb>>(&material))
        return law->strength_at(z);
    if (const auto* law = std::get_if<Tresca>(&material)) return law->shear_strength;
    if (const auto* law = std::get_if<MohrCoulomb>(&material))
        return law->cohesion / std::sqrt(1 - law->sin_friction * law->sin_friction);
    return 0;
}

}  // namespace undertow::fem
