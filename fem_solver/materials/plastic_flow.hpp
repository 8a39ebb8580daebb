#pragma once
// What plastic laws have in common.

#include "fem_solver/materials/linear_elastic.hpp"

namespace undertow::fem {

/// What one step of a plastic law leaves besides the stress.
template <class T>
struct PlasticFlow {
    T strain;    // increment of the equivalent plastic strain, sqrt(2/3 e_p : e_p), e_p deviatoric
    T work;      // [J/m3] d_eps_p : (stress before + stress after)/2: what is left of the step's work
                 // is stored, exactly
    T yielding;  // 1 where the stress flowed, else 0
    T trial_J2;  // [Pa2] of the elastic trial stress
};

/// The law at point q of an element: the same everywhere, unless its strength depends on the place
/// (elements/local_laws.hpp).
template <class Material>
UNDERTOW_KERNEL const Material& at_point(const Material& material, int /*q*/) {
    return material;
}

/// A law at a point: elastic ones leave no flow, hardening ones depend on the plastic strain so far.
template <class T, class Material>
UNDERTOW_KERNEL void update_stress(const Material& material, const Symmetric<T>& d_eps, double dt,
                                   const T* plastic_strain, Symmetric<T>& s, PlasticFlow<T>& flow) {
    if constexpr (!Material::plastic)
        material(s, d_eps, dt);
    else if constexpr (Material::hardens)
        material(s, d_eps, dt, *plastic_strain, flow);
    else
        material(s, d_eps, dt, flow);
}

}  // namespace undertow::fem
