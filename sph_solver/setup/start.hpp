#pragma once
// How a scene comes to rest and how a slide gets under way.
//
// Until start.settle the velocities of the fluid are damped at a rate gamma, so that water finds its
// place around bodies that the lattice does not fit, and blocks (fills with a ramp) stand still. Then
// each block moves as one, its speed rising smoothly, and is let go at its release. Both act by
// replacing the acceleration that the pair sums found, so that kick and drift stay what they are.

#include <string>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/particles.hpp"

namespace undertow::sph {

class Start {
 public:
    /// first_id: of each fill, see Filled. c0: sound speed [m/s] for the default damping.
    Start(const Case& input, std::vector<std::int64_t> first_id, double c0);

    bool active(double t) const { return t < end_; }
    double end() const { return end_; }          // [s] the last release, or the end of settling
    double damping() const { return damping_; }  // [1/s]

    /// Replaces the accelerations of damped and of prescribed particles for the kick of length `kick`
    /// [s] that leads to t + dt/2.
    void constrain(double t, double dt, double kick, const Vec3& gravity, Particles& particles) const;

    /// Velocity of a block at time t [m/s]: 0, rising as 3 s^2 - 2 s^3 after settling, then full.
    Vec3 block_velocity(int block, double t) const;

 private:
    struct Block {
        std::int64_t first_id, end_id;   // of its particles
        Vec3 velocity;                   // [m/s] when let go
        double ramp;                     // [s]
    };
    std::vector<Block> blocks_;
    double settle_, damping_, end_;      // [s], [1/s], [s]
};

}  // namespace undertow::sph
