#pragma once
// The scene of pressed_node.hpp for eight different starts at once, one to a lane, without the
// search and the exact sums: 10^6 steps of 100 particles take seconds. The laws are those of
// contact (laws.hpp), the motion is vertical, and along the surface if there is friction.
// dynamics.test.cpp compares it with the World.

#include <algorithm>
#include <random>
#include <vector>

#include "contact/laws.hpp"
#include "pressed_node.hpp"

namespace undertow::contact::test {

/// Largest kinetic energies [J] of eight starts: in the first tenth of the steps, after it, and in
/// the last tenth.
struct EightEnergies {
    Lanes early = spread<Lanes>(0), late = early, last = early;
    /// The lane that grew most. NaN and infinity count as 10^6.
    double worst() const { return largest(late); }
    double worst_at_end() const { return largest(last); }

 private:
    double largest(const Lanes& then) const {
        double most = 0;
        for (int lane = 0; lane < lane_count; ++lane) {
            const double grown = then[lane] / early[lane];
            most = std::max(most, grown < 1e6 ? grown : 1e6);
        }
        return most;
    }
};

enum class WallStep { leapfrog, linearly_implicit };

/// `wall`: how the structure takes its steps. Linearly implicit, a = (m + dt^2 K/4)^-1 (f - K x)
/// (docs/theory_fem.md), cfl may be any number. With friction the ground tilts: a tenth of the
/// weight acts along the surface.
class PressedNodeLanes {
 public:
    PressedNodeLanes(const PressedNode& scene, const LawSettings& law,
                     WallStep wall = WallStep::leapfrog)
        : scene_(scene),
          stiffness_{law.beta, 1},
          damping_{law.beta, law.eta, 1},
          friction_{law.mu, std::min(1.0, 0.5 * law.beta + law.eta), 1} {
        const double m = scene.mass_ratio, P = scene.particles;
        weight_ = 0.02 * std::min(m, 1 / P);
        ground_ = 4 * scene.cfl * scene.cfl;
        node_mass_ = wall == WallStep::leapfrog ? 1 : 1 + ground_ / 4;
        const double sunk = weight_ * (1 / m + P) / law.beta;
        particle_.resize(std::size_t(scene.particles));
        for (int lane = 0; lane < lane_count; ++lane) {
            std::mt19937 random(7u + unsigned(lane));
            std::uniform_real_distribution<double> any(-1, 1);
            for (One& one : particle_) {
                one.v[lane] = 0.25 * sunk * any(random);
                one.x[lane] = -sunk * (1 + 0.5 * any(random));
            }
            if (law.mu > 0)
                for (One& one : particle_) one.along[lane] = 0.25 * sunk * any(random);
        }
    }

    /// One step of dt = 1; x [m] is measured from where a particle just touches the node at rest.
    void step() {
        const Lanes none = spread<Lanes>(0), one = spread<Lanes>(1);
        Lanes touching = none;
        for (const One& p : particle_) touching = touching + select(less(p.x, x_), one, none);
        const Lanes m_c = one / (one / scene_.mass_ratio + touching);
        const Lanes k_now = stiffness_(m_c, none);
        const double kick = first_ ? 0.5 : 1;
        const double per_mass = kick / scene_.mass_ratio;
        first_ = false;
        Lanes on_node = none, along_node = none, energy = none;
        for (One& p : particle_) {
            const LaneMask touches = less(p.x, x_);
            const Lanes k = select(less(none, p.k), smaller(k_now, p.k), k_now);
            const Lanes f =
                select(touches, larger(none, k * (x_ - p.x) + damping_(m_c, k) * (v_ - p.v)), none);
            p.k = select(touches, k, none);
            on_node = on_node - f;
            p.v = p.v + per_mass * (f - weight_);
            p.x = p.x + p.v;
            energy = energy + p.v * p.v;
            if (friction_.mu == 0) continue;
            const Lanes slip = p.along - along_, speed = larger(slip, -slip);
            const Lanes drag = friction_(m_c, f, speed);
            const Lanes f_t = select(less(none, slip), -drag, drag);
            along_node = along_node - f_t;
            p.along = p.along + per_mass * (f_t + select(touches, 0.1 * weight_ + none, none));
            energy = energy + p.along * p.along;
        }
        v_ = v_ + (kick / node_mass_) * (on_node - ground_ * x_);
        x_ = x_ + v_;
        along_ = along_ + (kick / node_mass_) * (along_node - ground_ * shifted_);
        shifted_ = shifted_ + along_;
        kinetic_ = 0.5 * (scene_.mass_ratio * energy + v_ * v_ + along_ * along_);
    }

    const Lanes& kinetic_energy() const { return kinetic_; }  // [J] at n + 1/2

    /// All steps, or until one lane has grown by 10^6.
    EightEnergies run() {
        EightEnergies energies;
        for (int n = 0; n < scene_.steps; ++n) {
            step();
            Lanes& most = n < scene_.steps / 10 ? energies.early : energies.late;
            most = larger(most, kinetic_);
            if (n >= scene_.steps - scene_.steps / 10)
                energies.last = larger(energies.last, kinetic_);
            if (n % 1024 == 0 && n > scene_.steps / 10 && energies.worst() >= 1e6) break;
        }
        return energies;
    }

 private:
    struct alignas(64) One {
        Lanes x, v;                      // [m], [m/s]
        Lanes k = spread<Lanes>(0);      // [N/m] of its contact so far, 0 = in the air
        Lanes along = spread<Lanes>(0);  // [m/s] velocity along the surface
    };
    PressedNode scene_;
    Eq11Stiffness stiffness_;
    NormalDamping damping_;
    CoulombFriction friction_;
    double weight_ = 0, ground_ = 0;  // [N], [N/m]
    double node_mass_ = 1;            // [kg] that a force of the step accelerates
    std::vector<One> particle_;
    Lanes x_ = spread<Lanes>(0), v_ = x_, kinetic_ = x_;  // of the node, mass 1
    Lanes shifted_ = x_, along_ = x_;                     // [m], [m/s] of it along the surface
    bool first_ = true;
};

}  // namespace undertow::contact::test
