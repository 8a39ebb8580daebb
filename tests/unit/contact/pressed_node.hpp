#pragma once
// P particles pressed on one node of a structure at the edge of its own stability: the hard case of
// the penalty's stability budget. Used by the tests (10^4 steps) and by bench_contact_stability
// (10^6).

#include <algorithm>
#include <cmath>
#include <random>

#include "scene.hpp"

namespace undertow::contact::test {

struct PressedNode {
    int particles = 1;      // P
    double mass_ratio = 1;  // of one particle to the node
    double cfl = 0.9;       // omega dt/2 of the node's own spring to the ground
    int steps = 10000;
};

struct PressedEnergies {
    double early = 0, late = 0;  // [J] largest kinetic energy in the first tenth, and after
};

/// The budget of section 3 of docs/theory_contact.md: beta + 2 eta <= 2/3 of 4 (1 - cfl^2), and no
/// more than the defaults. Without damping all of it may be stiffness.
inline LawSettings within_budget(double cfl, bool damped, double share_of_rest = 2.0 / 3) {
    LawSettings law;
    law.stiffness = StiffnessKind::eq11;
    const double budget = share_of_rest * 4 * (1 - cfl * cfl);
    const double share = std::min(1.0, budget / (law.beta + (damped ? 2 * law.eta : 0)));
    law.beta *= share;
    law.eta = damped ? share * law.eta : 0;
    return law;
}

/// Every particle carries a weight that sinks it some tenths of a unit; all start off their
/// equilibrium by up to half of it, so that some keep leaving the node and coming back.
/// after_step(n, kinetic energy [J]) returns whether to go on.
template <typename AfterStep>
void press(const PressedNode& scene, const LawSettings& law, AfterStep after_step) {
    const double dt = 1, l0 = 100, m = scene.mass_ratio;
    const double weight = 0.02 * std::min(m, 1.0 / scene.particles);
    const double sunk = weight * (1 / m + scene.particles) / law.beta * dt * dt;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    Particles particles;
    for (int i = 0; i < scene.particles; ++i) {
        const double v = 0.25 * sunk * any(random), depth = sunk * (1 + 0.5 * any(random));
        particles.add({0, 0, l0 - depth}, {0, 0, v}, m, l0, 1);
    }
    Nodes plate = flat_plate(1, 1, 1e4, 1);
    for (int n : {1, 2, 3}) plate.mass[n] = 1e12;
    World world(plate, particles, law);
    const double ground = 4 * scene.cfl * scene.cfl / (dt * dt);
    world.node_load = [&](std::size_t n) {
        return n == 0 ? Vec(-ground * Vec::Map(world.nodes.x.data())) : Vec(0, 0, 0);
    };
    world.particle_load = [weight](std::size_t) { return Vec(0, 0, -weight); };
    for (int n = 0; n < scene.steps; ++n) {
        world.step(dt);
        // A ball on a point would roll off: only the vertical motion is of interest.
        for (int i = 0; i < 3 * scene.particles; ++i)
            if (i % 3 != 2) world.particles.x[i] = world.particles.v[i] = 0;
        if (!after_step(n, world.kinetic_energy())) return;
    }
}

/// Stops when the energy has grown by 10^6.
inline PressedEnergies press_on_one_node(const PressedNode& scene, const LawSettings& law) {
    PressedEnergies energies;
    press(scene, law, [&](int n, double energy) {
        double& largest = n < scene.steps / 10 ? energies.early : energies.late;
        largest = std::max(largest, energy);
        return n < scene.steps / 10 || energies.late < 1e6 * energies.early;
    });
    return energies;
}

}  // namespace undertow::contact::test
