#pragma once
// The kernel completed at the coupled surface. Contact pushes the particles that touch it, and only
// them; what the layers behind miss of their kernel is added here, as if the surface were a mirror.
//
// A particle that touches is the wall to those behind it:
//   - the pressure of the images on a particle that does not touch is its own to keep, and the
//     reaction goes to the touching particles around it: momentum is conserved exactly, and the
//     force on the surface remains the contact force;
//   - a particle that touches carries its own reaction: the images add nothing normal to the
//   surface;
//   - the images move as in a mirror that has the normal velocity of those touching particles. The
//     work of the forces is then that of the density rates: no energy is created, the surface's
//     own motion need not be known, and a particle that arrives at a dry wall is not compressed by
//     an image before it touches.
// How far off the surface a touching particle stands follows from its pressure. Contact alone would
// hold it at its radius l0 for good: where the flow converges along a wall the layer could not
// thicken, and would shoot ahead as a sheet of its own. So the particle solver moves the point with
// which a particle touches by e along the contact force, in acoustic equilibrium with its fluid:
//   de/dt = 0.8 (M - N)/(A rho0 c0) - n.e/tau,   -0.3 l0 <= n.e <= 0.6 l0,  tau = 400 dx/c0
// with N the contact force of the step before, A = dx^2, and M what the mirror asks of this contact: the
// pressure force of the particle's own images, and its share of those on the particles behind. The
// mirror then moves with n.(v_i - de/dt), and what dissipates is 0.8 (M - N)^2/(A rho0 c0) >= 0. (p_i A
// instead of M would not know of crowded particles, each of which presses with its part of A only.)
// Images are evaluated pair by pair and never stored:
//   x_i - x_j' = (x_i - x_j)_t + (s_i + s_j) n,   s distance from the surface, n its normal
// which is symmetric in i and j, also along a curved surface.

#include <cstdint>
#include <vector>

#include "sph_solver/boundary/mirror_planes.hpp"
#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

class SurfaceImages {
 public:
    /// For particles of identities 0 to n - 1; they cost memory once there is a surface.
    void expect(std::size_t n) {
        expected_ = n;
        if (placed()) lift_.resize(n);
    }
    std::size_t expected() const { return expected_; }
    void archive(Archive& a);
    /// Facets (F, 4), counter-clockwise seen from the fluid, a triangle repeats its third node;
    /// x (N, 3) [m] in the particles' coordinates.
    void place(std::vector<std::int32_t> quad, std::vector<double> x);
    /// The same facets a little farther on: the feet go with their nodes, pairs stay. False when they
    /// are not the same or have gone more than `most` [m] since they were placed; nothing is done then.
    /// Distances must be those of the surface now: where they lag behind it, what the mirror does to
    /// the density over a swing of the surface does not cancel, and the fluid loses volume.
    bool follow(const std::vector<std::int32_t>& quad, const std::vector<double>& x, double most);

    /// Finds the particles near the surface and the pairs (i, j') within the support. To be called
    /// when stale: lists were rebuilt or the surface was placed. spacing [m]; reach [m]: how far
    /// particles may move until the next time. flat: in two dimensions, x and z.
    void find_pairs(const Particles& particles, const Neighborhood& neighbors, double spacing,
                    double reach, bool flat);
    /// The point with which particle `id` touches lies at x - e and moves with v - rate.
    struct Lift {
        double e[3] = {0, 0, 0}, rate[3] = {0, 0, 0};  // [m], [m/s]
        bool listed = false;                           // not at rest
    };
    const Lift& lift(std::int64_t id) const {
        static const Lift at_rest;
        return lift_.empty() ? at_rest : lift_[id];
    }
    /// e += dt rate of the particles near the surface. Returns the largest |rate| [m/s].
    double advance(double dt);
    bool placed() const { return !quad_.empty(); }
    bool stale() const { return stale_; }
    void expire() { stale_ = true; }  // lists were rebuilt
    std::size_t pairs() const { return pairs_.size(); }

    /// Adds to particles.drho_dt, ax, ay, az. Records must be packed; particles with a contact
    /// acceleration (fx, fy, fz) are those that touch.
    void add(const PairPhysics& physics, const Neighborhood& neighbors, Terms terms,
             Particles& particles);

 private:
    /// A particle near the surface and its closest facet's plane. In a concave corner it has one
    /// entry per wall, one after the other.
    struct Near {
        int particle;
        std::int32_t corner[4];   // nodes of the facet that holds the foot, and the foot's weights
        double weight_of[4];
        double point[3], normal[3], facet[3];  // [m]; away from the foot, of the facet
        double share;             // of a mirror that the surface is there, 0 to 1
        bool touches;
        double distance;          // s [m]
        double backing;           // 0 (no touching particle around) to 1
        double wall_speed;        // normal velocity of the mirror, from the touching ones [m/s]
        double mass, per_mass;    // rho0 V0 [kg/m^(3-d)], and 1 over it
        double volume, density;   // [m^d], [kg/m3]
        double weight;            // sum of their kernel values [1/m^d]
        double rate, a[3], push;  // results: [kg/m3/s], [m/s2], along the normal [m/s2]
        double mirror;            // of the pressure of all images it carries [m/s2]
    };
    /// j' is the image of near particle b, or of its mirror image `record` at a plane (-1 = none).
    struct Pair {
        int a, b, record;
        double n[3];  // the same normal for (i, j') and (j, i')
        double lean;  // W_ab if one of them touches and the other does not, else 0 [1/m^d]
    };

    void deal_out_pairs();
    /// f(pair) for all pairs, in the same order for every entry of near_ whatever the threads.
    template <class F>
    void for_all_pairs(F&& f);
    void find_touching(const Particles& particles);
    void find_lifts(const PairPhysics& physics, const Particles& particles);
    void find_near(const Particles& particles, double range, bool flat);
    int same_wall_of(int source, const double normal[3]) const;
    template <class KernelLaw>
    void find_backing(const KernelLaw& kernel, const Particles& particles);
    template <class KernelLaw>
    void add_pairs(const PairPhysics& physics, const KernelLaw& kernel,
                   const Neighborhood& neighbors, const Particles& particles);
    void add_reactions();

    std::vector<std::int32_t> quad_;
    std::vector<double> x_, placed_;   // [m] nodes, and where they were placed
    bool flat_ = false;
    std::vector<Near> near_;
    std::vector<int> slot_;  // particle -> its first entry in near_, -1 = far
    std::vector<Pair> dealt_;          // scratch
    std::vector<Pair> pairs_;          // those within a block of near_, block by block, then the rest
    std::vector<std::size_t> block_begin_;   // [blocks + 1] into pairs_
    std::size_t expected_ = 0;
    std::vector<Lift> lift_;  // by identity; empty before the first place()
    std::vector<std::int64_t> lifted_;  // identities of the entries that are not at rest
    double spacing_ = 0;  // [m]
    bool stale_ = false;
};

}  // namespace undertow::sph
