#pragma once
// Layers before the ends of a water body in which motion dies out, so that neither sound nor
// surface waves come back.
//
// The two are worlds apart: sound is some ten times as fast, and a damping that ends it within the
// layer would be a wall to surface waves. So surface waves meet gamma_w, and only what is quick
// gamma_s:
//   dv/dt     = ... - gamma_s (v - v_s) - gamma_w (v - v_target),   dv_s/dt  = (v - v_s)/tau
//   d(rho)/dt = ... - gamma_s (rho - s),                            ds/dt    = (rho - s)/tau
// Sound is damped in velocity and density alike, so that the layer has the impedance of water
// whatever the frequency, and nothing comes back but what passes it twice: with gamma_s in the
// density alone a layer twice as long as the pulse sent 23 % back, so 4 %. tau is the time sound
// takes through the layer: to a surface wave it is water somewhat heavier and softer. What density
// loses is gamma_s tau times what s gains, and it comes back with the pressure: a level that stays
// is not touched, nor is mass. A level that changes by eta for good ends up off by some
// gamma_s tau (g H/c0^2) eta, a few percent of eta.
//   gamma = 3 xi^2 A c/L,   xi = 0 where the layer of length L begins, 1 at its end
// weakens what is quick there and back by exp(-2 A), and surface waves of the speed c by exp(-A):
// they lose in velocity only, which is half of their energy. A is `strength` for surface waves and
// 5/3 of it for sound.

#include <cstdint>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/particles.hpp"
#include "sph_solver/physics/pair_sums.hpp"

namespace undertow::sph {

class AbsorbingLayers {
 public:
    AbsorbingLayers(const Case& input, const PairPhysics& physics);

    bool any() const { return !layers_.empty(); }
    void archive(Archive& a);
    /// Finds the particles in the layers, after lists were rebuilt.
    void locate(const Particles& particles);
    /// Replaces accelerations, so that the kick of length `kick` [s] leads to damped velocities,
    /// and damps densities over dt [s]. gravity: of the kick [m/s2].
    void damp(double dt, double kick, const Vec3& gravity, Particles& particles);

 private:
    struct Layer {
        Box box;  // [m]
        int axis;
        double begin, per_length;  // [m], 1/L with the sign of the direction [1/m]
        Vec3 target;               // [m/s]
        double waves, sound;       // 3 A c/L [1/s]
        double follow;             // tau [s]
    };
    struct Member {
        int particle, layer;
    };
    std::vector<Layer> layers_;
    std::vector<Member> members_;
    struct Slow {
        double drho = 0, v[3] = {0, 0, 0};  // [kg/m3], [m/s]
    };
    std::vector<Slow> slow_;            // s by identity
    std::vector<std::uint8_t> inside_;  // by identity: s is up to date
    bool flat_;
};

}  // namespace undertow::sph
