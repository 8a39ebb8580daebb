#pragma once
// Particles next to rigid walls: those that got behind a body are put back, those beside a rough
// wall feel its shear. Planes put back by themselves (mirror_planes.hpp).

#include <vector>

#include "sph_solver/boundary/bodies.hpp"
#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

class NearWalls {
 public:
    /// widest: the largest spacing of the fluids [m].
    NearWalls(double widest, int planes, int bodies, int fluids)
        : widest_(widest),
          planes_(planes),
          fluids_(fluids),
          stress_(std::size_t(planes + bodies) * fluids, Vec3{}),
          coulomb_(stress_) {}

    void archive(Archive& a);

    /// Before lists are rebuilt. A particle inside a body comes to its mirror place with its
    /// approach reversed. travelled: bound on how far any particle went relative to any body since
    /// the start [m], so that one far from all bodies is not asked again until it may have come
    /// near. range: of the kernel and the skin [m]. Returns how many were put back.
    int put_back(Particles& particles, const Bodies& bodies, const Periodic& periodic,
                 double travelled, double range);

    /// After the particles are sorted. index: of each identity.
    void find(const Particles& particles, const MirrorPlanes& mirror, const Bodies& bodies,
              const std::vector<int>& index, double skin);

    /// Velocities as a body's surface reflects them, v - 2 [(v - v_wall) . n] n with n at the
    /// particle: what a body shows of the fluid beside it. Where no body is near, the particle's
    /// own. velocity: [m/s], [n]
    void reflect(const Particles& particles, const Bodies& bodies,
                 std::vector<Vec3>& velocity) const;

    /// dv/dt = -tau w(z)/(rho dx) along the slip velocity at no-slip walls, tau by the law of the
    /// wall. The weight w = 1 - |z - dx/2|/dx shares the stress out among the layers of a lattice
    /// at any distance from the wall; its sum is one. A viscoplastic fluid has the viscosity of the
    /// shear rate u/z between itself and the wall.
    void add_stress(const PairPhysics& physics, const MirrorPlanes& mirror, const Bodies& bodies,
                    Particles& particles);
    /// tau = mu p_wall at walls with Coulomb friction, for the kick of length `kick` [s]: at most
    /// what stops the particle, so that it sticks.
    void add_coulomb(const PairPhysics& physics, const Vec3& gravity, const MirrorPlanes& mirror,
                     const Bodies& bodies, double kick, Particles& particles);

    /// Shear force of a fluid on a wall: the stress just added, and the last Coulomb friction,
    /// which is found after all other forces.   [N], k = wall * fluids + fluid
    Vec3 shear(std::size_t k) const {
        return {stress_[k][0] + coulomb_[k][0], stress_[k][1] + coulomb_[k][1],
                stress_[k][2] + coulomb_[k][2]};
    }

 private:
    /// The same for particles first to last - 1.
    int put_back(Particles& particles, const Bodies& bodies, const Periodic& periodic,
                 double travelled, double range, int first, int last);

    struct Rubbing {
        int particle;     // sorted index
        int wall;         // planes first, then bodies
        Vec3 foot, away;  // of a body: nearest point of its surface and direction, at rest
    };
    struct Place {
        double z;  // distance from the wall [m]
        Vec3 away;
        Vec3 wall;  // velocity [m/s]
    };
    struct Candidate {
        int particle;
        std::int64_t id;
        int body;
        FromSurface from;
    };
    Place place(const Rubbing& r, const MirrorPlanes& mirror, const Bodies& bodies,
                const Particles& particles) const;
    /// add_stress for entries first to last - 1 of rubbing_. force: on the walls [N], as stress_.
    void add_stress(const PairPhysics& physics, const MirrorPlanes& mirror, const Bodies& bodies,
                    Particles& particles, int first, int last, Vec3* force) const;
    Vec3& force_on(const Rubbing& r, const Particles& particles, Vec3* forces) const {
        return forces[r.wall * fluids_ + particles.fluid[r.particle]];
    }

    double widest_;  // [m]
    int planes_, fluids_;
    std::vector<Vec3> stress_, coulomb_;  // [N], [walls, fluids]
    std::vector<Rubbing> rubbing_;        // beside rough walls: planes in the order of particles,
                                          // then bodies, of which a particle has one at most
    std::vector<int> share_;              // of rubbing_: where each begins, and the end
    int plane_shares_ = 0;
    std::vector<int> rough_;              // planes that are not of free slip
    std::vector<Vec3> share_stress_;      // [N], [shares, walls, fluids]
    std::vector<Rubbing> near_;           // within the kernel's range of a body
    std::vector<Candidate> candidates_;
    std::vector<double> safe_until_;  // `travelled` of the next question [m], by identity
};

}  // namespace undertow::sph
