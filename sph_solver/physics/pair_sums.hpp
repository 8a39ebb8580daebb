#pragma once
// The sums over neighbors: rates of density and accelerations for all particles.

#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/no_slip_images.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"
#include "sph_solver/physics/pair_choices.hpp"

namespace undertow::sph {

struct PairPhysics {
    Kernel kernel = Kernel::wendland_c2;
    Precision precision = Precision::float32;
    double h = 0;                     // smoothing length of sph.spacing [m]
    int dimension = 3;
    double artificial_viscosity = 0;  // alpha
    double density_diffusion = 0;     // delta
    Vec3 gravity{};                   // [m/s2] of which pressure takes care at rest: without its
                                      // components along periodic axes
    double lattice_moment = 1;        // sums with grad W are divided by it, see lattice_moment.hpp
    bool gradient_correction = false; // of the continuity equation, see gradient_correction.hpp
    bool implicit_viscosity = false;  // the sums leave the viscous forces out
    ViscousForm viscous_form = ViscousForm::laplacian;
    StrainWeight strain_weight;       // of "strain"
    double shifting = 0;              // K, see find_shift
    TensionControl tension_control = TensionControl::none;
    std::vector<FluidLaw> fluids;     // in the order of [[sph.fluid]]

    /// Of the explicit sums. Without viscosity there, and in the implicit update, the cheaper one.
    ViscousForm explicit_form() const {
        return implicit_viscosity ? ViscousForm::laplacian : viscous_form;
    }
    bool viscoplastic() const {
        for (const FluidLaw& f : fluids)
            if (f.viscoplastic()) return true;
        return false;
    }
    bool variable_smoothing = false;  // h follows from density
    /// Smoothing lengths differ, from fluid to fluid or from particle to particle, or from that of
    /// bodies: pairs take the mean of the two, see PairSize.
    bool sized() const {
        if (variable_smoothing) return true;
        for (const FluidLaw& f : fluids)
            if (f.h != h) return true;
        return false;
    }
    /// Clusters must be told apart by what they hold and meet (Neighborhood::find_fluids).
    bool mixed() const { return fluids.size() > 1 || viscoplastic() || sized(); }
};

/// Whether a sum of forces finds the shear rate of viscoplastic particles, at 1.5 to 2 times the cost,
/// or lets them keep that of an earlier step and its viscosity.
enum class ShearRate { held, found };

/// Writes particles.drho_dt (rate), particles.ax, ay, az (force) or both from the packed records.
/// In the precision of PairPhysics::precision. With forces it also finds the shear rate of
/// viscoplastic particles, and from it particles.viscosity, which the next pack shows to neighbors.
void sum_over_neighbors(const PairPhysics& physics, const Neighborhood& neighbors,
                        const NoSlipImages& no_slip, Terms terms, Particles& particles,
                        ShearRate shear_rate = ShearRate::found);

/// The same in double precision from the same records, one pair at a time: the readable reference
/// of the fast loops.
struct ReferenceSums {
    std::vector<double> rate;         // [kg/m3/s], [n]
    std::vector<Vec3> acceleration;   // [m/s2], [n]
    std::vector<double> shear_rate;   // [1/s], [n], of all particles
};
ReferenceSums sum_over_neighbors_reference(const PairPhysics& physics,
                                           const Neighborhood& neighbors);

}  // namespace undertow::sph
