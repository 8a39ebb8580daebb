#pragma once
// The laws a part can follow. An element's kernel is compiled once for each.

#include <variant>

#include "fem_solver/materials/j2.hpp"
#include "fem_solver/materials/linear_elastic.hpp"
#include "fem_solver/materials/mohr_coulomb.hpp"
#include "fem_solver/materials/tresca.hpp"

namespace undertow::fem {

using Material = std::variant<LinearElastic, Tresca, J2, MohrCoulomb>;

inline const LinearElastic& elastic_moduli(const LinearElastic& law) {
    return law;
}
template <class Law>
const LinearElastic& elastic_moduli(const Law& law) {
    return law.elastic;
}
/// The moduli of small strains, which set wave speeds and the stable step.
inline const LinearElastic& elastic_moduli(const Material& material) {
    return std::visit([](const auto& law) -> const LinearElastic& { return elastic_moduli(law); },
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
/// Whether plastic flow can change the volume, so that the mean stress is no longer the elastic one
/// of the change of volume.
inline bool dilates(const Material& material) {
    return std::visit([](const auto& law) { return law.dilates; }, material);
}
/// Whether the strength at a point depends on its plastic strain.
inline bool hardens(const Material& material) {
    return std::visit(
        []<class Law>(const Law&) { return law_hardens<Law>(); }, material);
}

}  // namespace undertow::fem
