#pragma once
// Openings in the fluid's world: through an inflow fluid comes with a given speed, through an
// outflow it leaves.
//
// Behind the plane of an opening, outside, stands a buffer as deep as the support. Its particles
// are particles like others, in the lists and in the sums of their neighbors; only their velocity
// and density are prescribed. A particle that comes in over the plane becomes fluid, and a copy of
// it is put in at the back of the buffer: the flow is counted to the particle, and each column
// keeps the spacing it has. A particle that goes out becomes part of the buffer, and is removed at
// its back. All that happens when lists are rebuilt.
//
// Inflow: speed U given, pressure p_e from inside.
// Outflow: sound must leave. With u the speed outward, e what is found inside of the plane and r
// the reference, which follows slowly,
//   p + rho c u = p_e + rho c u_e     the wave that goes out comes from inside
//   p - rho c u = p_r - rho c u_r     nothing comes in
// so  p = (p_e + p_r)/2 + rho c (u_e - u_r)/2,  u = (u_e + u_r)/2 + (p_e - p_r)/(2 rho c)
//                                                [Lastiwka, Basa & Quinlan 2009; Hedstrom 1979]
//   du_r/dt = (u_e - u_r)/tau, tau = L/(0.25 c): slower, and the pressure drifts; faster, and sound
//   comes back  [Poinsot & Lele 1992]. p_r is given by pressure or level, or follows as u_r does.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

/// What passed through an opening of one fluid, positive into the world.
struct Passed {
    std::int64_t particles = 0;
    double momentum[3] = {0, 0, 0};  // sum of v [m/s]; times the particle's mass it is momentum
};

class Openings {
 public:
    Openings(const Case& input, const PairPhysics& physics);

    bool any() const { return !openings_.empty(); }
    void archive(Archive& a);
    /// Fills the buffers: of an inflow on the lattice of its opening, of an outflow with the mirror
    /// image of the fluid before it. InputError: no place for it behind a plane or out of the
    /// domain.
    void fill(const MirrorPlanes& mirror, const std::optional<Box>& domain, Particles& particles);

    /// Moves particles between fluid and buffers, before lists are rebuilt. Appends particles and
    /// their identities; index: identity -> index, as particles stand now.
    void exchange(Particles& particles, std::vector<int>& index);
    /// exchange() found that the particle has left through an outflow.
    bool gone(std::size_t i) const { return role_[i] == left; }
    /// The particle is no fluid yet, or no more. Between exchange() and the sort.
    bool holds(std::size_t i) const { return role_[i] != 0; }
    /// Finds the members of the buffers again, after lists were rebuilt, and what they look at.
    void locate(const Particles& particles, const std::vector<int>& index,
                const Neighborhood& neighbors);

    /// Gives the buffers' particles and records density and pressure. The records of the fluid and
    /// its images must show the state.
    void extrapolate(const PairPhysics& physics, FluidTag tag, Neighborhood& neighbors,
                     Particles& particles);
    /// Replaces the accelerations of the buffers' particles, so that the kick of length `kick` [s]
    /// leads to their velocity at t + dt/2. gravity: of the kick [m/s2].
    void prescribe(double t, double dt, double kick, const Vec3& gravity, Particles& particles);

    std::size_t size() const { return openings_.size(); }
    bool is_inflow(std::size_t k) const { return openings_[k].inflow; }
    const std::string& name(std::size_t k) const { return openings_[k].name; }
    const Passed& passed(std::size_t k, int fluid) const { return openings_[k].passed[fluid]; }
    /// Particles that stand in the buffers, by fluid.
    std::vector<std::int64_t> buffered(const Particles& particles) const;
    /// Fluid that an inflow pushed back in.
    std::int64_t put_back() const { return put_back_; }

 private:
    struct Opening {
        std::string name;
        bool inflow;
        int axis;     // of the normal
        double sign;  // normal: +1 or -1 along it
        double face;  // [m] along the axis
        Box box;
        int fluid = 0;                          // inflow
        std::optional<Expression> speed;        // inflow [m/s]
        std::optional<double> pressure, level;  // [Pa], [m]
        double relaxation = 0;                  // tau [s]
        std::vector<Passed> passed;             // [fluids]
    };
    struct Member {
        std::int64_t id;
        int opening, index;         // index: sorted, while lists hold
        double u_ref, p_ref;        // outflow [m/s], [Pa]
        double p_inside, u_inside;  // [Pa], [m/s]
        double next[3];             // velocity to take [m/s]
    };
    struct Copy {  // of a particle that came in, for the back of its buffer
        int source, axis;
        double shift;        // [m]
        std::size_t member;  // takes it over
    };

    double depth(const Opening& o, const Particles& p, std::size_t i) const;  // outside > 0 [m]
    bool before(const Opening& o, const Particles& p, std::size_t i) const;   // within its box
    static void count(Opening& o, const Particles& p, std::size_t i, int direction);
    void inherit_reference(const Particles& particles, std::size_t standing, Member& m) const;
    void append_copies(Particles& particles, std::vector<int>& index);
    bool look_inside(const PairPhysics& physics, const Neighborhood& neighbors, const Opening& o,
                     const double at[3], std::size_t first, std::size_t last, const Particles& p,
                     Member& m) const;

    static constexpr std::uint8_t left = 255;
    bool flat_;
    double spacing_, depth_;  // [m]; depth of the buffers
    Vec3 gravity_;            // balanced by pressure [m/s2]
    std::vector<Opening> openings_;
    std::vector<Member> members_;
    std::vector<std::uint8_t> role_;  // by sorted index: 0 fluid, k + 1 in the buffer of opening k
    std::vector<Copy> copies_;
    std::vector<std::size_t> near_begin_;  // [members + 1] into near_
    std::vector<int> near_;                // records that a member looks at
    std::int64_t put_back_ = 0;
};

}  // namespace undertow::sph
