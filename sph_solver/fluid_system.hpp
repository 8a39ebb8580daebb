#pragma once
// The fluid and what surrounds it: particles, rigid walls, neighbor lists, and the operations that the
// loop in solver.cpp names. No wire, no files.

#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/absorbing_layers.hpp"
#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/boundary/near_walls.hpp"
#include "sph_solver/boundary/openings.hpp"
#include "sph_solver/boundary/surface_images.hpp"
#include "sph_solver/boundary/thin_plates.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/implicit_viscosity.hpp"
#include "sph_solver/physics/pair_sums.hpp"
#include "sph_solver/physics/shifting.hpp"
#include "sph_solver/setup/relaxation.hpp"
#include "sph_solver/setup/start.hpp"

namespace undertow::sph {

/// What one step reveals about the state; reduced in the kernels, checked once per step by the loop.
struct Health {
    double max_speed = 0;          // [m/s]
    double max_acceleration = 0;   // [m/s2]
    double max_compression = 0;    // largest |rho/rho0 - 1|
    double max_kinematic_viscosity = 0;   // largest mu/rho0 of the coming step, times
                                          // viscous_stiffness [m2/s]
    bool finite = true;
    int worst = -1;                // particle (sorted index) that is not finite
};

struct Removed {
    std::int64_t id;
    int fluid;
    double volume;                 // m/rho, true volume also in 2D [m3]
    Vec3 x, v;                     // [m], [m/s]
    int face;                      // of sph.domain it left through: 2 axis, + 1 for the upper one
};

/// Sums of what left through one face of sph.domain, of one fluid.
struct Departed {
    std::int64_t particles = 0;
    double momentum[3] = {0, 0, 0};   // sum of v [m/s]; times the particle's mass it is momentum
};

/// Whether the particles' places are to be found, or come from a checkpoint afterwards.
enum class Begin { anew, resumed };

class FluidSystem {
 public:
    /// skin_over_spacing: how far the neighbor lists reach beyond the support. Flat optimum of list
    /// length against rebuilds: 0.2 where a step moves a particle by a thousandth of the spacing,
    /// 0.4 where the fluid takes its own acoustic step. A relaxed start is found only where it
    /// begins anew.
    FluidSystem(const Case& input, double skin_over_spacing, Begin begin = Begin::anew);

    // ---- the operations of a step, in order of use
    /// Puts particles that got behind a plane back. Sorts and rebuilds all lists if one may lack a pair,
    /// and removes what left the domain. Returns true if so.
    bool refresh_neighbors(double t);
    /// Packs positions, velocities, volumes and pressures of fluid, bodies and images at time t.
    void pack(double t);
    /// Sums over neighbors and over the images behind the coupled surface: rates, forces or both.
    void sum_over_neighbors(Terms terms);
    /// Adds the shear stress of no-slip walls to the accelerations just summed.
    void add_wall_friction();
    /// Adds the friction of walls with a Coulomb coefficient, once all other forces and dt are known.
    void add_coulomb_friction(double dt, double dt_before);
    /// rho += dt * D (two-pass: D just summed).
    void advance_density(double dt);
    /// Adds the viscous accelerations of an implicit update; without effect where they are in the sums.
    void take_viscosity(double dt, double dt_before);
    /// Damps what settles and drives what is held, see Start; without effect once all are let go.
    void constrain_start(double t, double dt, double dt_before);
    /// Damps what is in absorbing layers and drives what stands in openings; without effect where
    /// there are none.
    void constrain_ends(double t, double dt, double dt_before);
    /// v^{n+1/2} = v^{n-1/2} + (a + g + f/m)(dt_before + dt)/2;  x^{n+1} = x^n + dt v^{n+1/2};
    /// with extrapolate: rho^{n+1} = rho^n + dt (D^n + w (D^n - D^{n-1})), w from the step sizes.
    Health kick_and_drift(double dt, double dt_before, double dt_before_that, bool extrapolate);

    /// All that steps change: after forces were summed and before the step is known.
    void archive(Archive& a);

    // ---- of the start
    /// Accelerations at rest under a pressure of 1 Pa everywhere: -2/rho sum V grad W.   [m/s2]
    void sum_under_even_pressure();
    /// Particles were moved by up to this much [m], other than by kick_and_drift.
    void moved(double distance) { reach_ += distance, travelled_ += distance; }
    /// What sph.lattice = "relaxed" did.
    const Relaxation& relaxation() const { return relaxation_; }

    /// Index of a particle by identity, -1 if it was removed.
    int index_of(std::int64_t id) const { return index_[id]; }

    /// Where the coupled surface is, see ThinPlates::place and, unless the case switches its images
    /// off, SurfaceImages::place.
    void place_surface(std::vector<std::int32_t> quad, std::vector<double> x);

    /// Where particle i (sorted index) touches the coupled surface [m] and the velocity of that point
    /// [m/s]: its center but for SurfaceImages::Lift.
    Vec3 contact_point(int i) const;
    Vec3 contact_velocity(int i) const;

    // ---- what others want to know
    double reach() const { return reach_; }       // bound on displacement since the last rebuild [m]
    double travelled() const { return travelled_; }   // the same since the start [m]
    double fastest() const { return fastest_; }       // largest speed [m/s]
    double spacing() const { return spacing_; }   // of sph.spacing [m]
    double widest_spacing() const;                // of the fluids [m]
    const SmoothingLengths& sizes() const { return sizes_; }
    double least_smoothing() const;               // of any particle [m]
    /// The largest c0 (least h)/h of a fluid: the sound that limits a step of the least h.  [m/s]
    double limiting_sound_speed() const;
    double support() const { return neighbors_.support(); }
    const PairPhysics& physics() const { return physics_; }
    const std::vector<FluidLaw>& fluids() const { return physics_.fluids; }
    const FluidLaw& fluid(int k = 0) const { return physics_.fluids[k]; }
    const FluidLaw& fluid_of(std::size_t i) const { return physics_.fluids[particles.fluid[i]]; }
    double largest_sound_speed() const;           // of the fluids [m/s]
    /// The state before the first step.
    Health health() const;
    const std::vector<std::int64_t>& filled() const { return filled_; }   // particles at the start, [fluids]
    const Neighborhood& neighbors() const { return neighbors_; }
    const MirrorPlanes& mirror() const { return mirror_; }
    const std::vector<Removed>& removed() const { return removed_; }
    const Departed& departed(int face, int fluid) const { return departed_[face][fluid]; }
    /// The particle that asks for the step that stable_step named, a sorted index; -1: none is faster,
    /// more accelerated or more viscous than others.
    int limiting_particle(const std::string& limiter) const;
    const Openings& openings() const { return openings_; }
    const NearWalls& near_walls() const { return near_walls_; }
    /// Force of each fluid on each plane, then on each body, shear included [N], [walls, fluids].
    std::vector<Vec3> wall_forces() const;
    const SurfaceImages& surface() const { return surface_; }
    const ThinPlates& plates() const { return plates_; }
    /// Pairs of particles that thin plates take out of the present lists, both ways.
    std::int64_t pairs_cut() const { return neighbors_.fluid_lists().cut_pairs(); }
    std::int64_t put_back() const { return put_back_ + openings_.put_back(); }
    std::int64_t rebuilds() const { return rebuilds_; }
    double mean_neighbors() const;                // within 2h, images included
    const std::optional<ImplicitViscosity>& implicit_viscosity() const { return implicit_; }
    const Start& start() const { return *start_; }
    Vec3 gravity() const { return gravity_; }     // all of it, see PairPhysics::gravity [m/s2]
    const Periodic& periodic() const { return mirror_.periodic(); }

    Particles particles;
    Bodies bodies;

 private:
    void pack_fluid();
    void pack_extras(bool of_bodies);
    void pack_fluid_exactly();
    void pack_extras_exactly(bool of_bodies);
    ExactRecord shown_by(const Extra& extra, const FluidLaw& fluid) const;
    template <class Real>
    void advance_density_in(double dt);
    template <class Real>
    Health kick_and_drift_in(double dt, double dt_before, double dt_before_that, bool extrapolate);
    bool lists_hold();
    void find_near_planes();
    void put_back_behind_planes();
    void remove_outside();
    double viscous_limit() const;                 // largest mu/rho0, times viscous_stiffness [m2/s]
    ShearRate shear_rate_now();

    PairPhysics physics_;
    Vec3 gravity_;                  // [m/s2]
    FluidTag tag_;
    bool heated_;                   // some fluid has Gamma0 != 0
    std::vector<double> heating_;   // by friction [W/kg]; only where heated
    std::vector<std::int64_t> filled_;
    double spacing_;
    double dummy_volume_;           // of a whole dummy of a body [m^d]
    MirrorPlanes mirror_;
    std::vector<FixedReflection> fixed_reflections_;   // [2^planes]
    SmoothingLengths sizes_;
    Neighborhood neighbors_;
    NoSlipImages no_slip_;
    SurfaceImages surface_;
    bool with_surface_images_;
    ThinPlates plates_;
    bool cut_anew_ = false;         // plates have moved since lists were cut, or would cut some
    std::optional<Box> domain_;
    std::optional<Start> start_;
    Openings openings_;
    AbsorbingLayers absorbing_;
    std::optional<ImplicitViscosity> implicit_;
    struct NearPlane {
        int particle, plane;
    };
    std::vector<NearPlane> near_planes_;   // particles with an image at a plane
    bool packed_ = false;           // the records show the present state
    Shift shift_;                   // empty where there is none
    Relaxation relaxation_;
    NearWalls near_walls_;
    std::vector<Vec3> reflected_;   // velocities as bodies show them [m/s], [n]
    double bodies_reach_ = 0;       // bound on their displacement since the last rebuild [m]
    double bodies_travelled_ = 0;   // and since the start [m]
    std::vector<int> index_;        // identity -> sorted index
    int list_age_ = 0;              // [steps]
    double reach_ = 1e300;          // forces the first rebuild
    double travelled_ = 0;          // [m]
    double shear_rate_age_ = 1e300; // time since it was found [s]
    double fastest_ = 0;            // of the last step [m/s]
    std::vector<Removed> removed_;
    Departed departed_[6][FluidTag::most];
    std::int64_t put_back_ = 0, rebuilds_ = 0;
};

}  // namespace undertow::sph
