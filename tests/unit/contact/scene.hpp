#pragma once
// Small worlds for the contact tests: surfaces to order, particles, and a leapfrog that moves
// both.

#include <cstdint>
#include <functional>
#include <vector>

#include "contact/penalty_contact.hpp"

namespace undertow::contact::test {

struct Nodes {
    std::vector<double> x, v, mass;  // (N, 3), (N, 3), (N)
    std::vector<std::int32_t> quad;  // (F, 4)
    Surface surface() const { return {quad, mass}; }
};

struct Particles {
    std::vector<double> x, v, mass, radius, stiffness;
    std::vector<std::uint64_t> id;
    void add(const Vec& position, const Vec& velocity, double m, double l0, double k);
    std::size_t size() const { return mass.size(); }
    Points points() const { return {x, v, mass, radius, stiffness, id}; }
};

/// nx x ny quads of edge `size` in the plane z = 0, from the origin, wet side
/// up; node mass m.
Nodes flat_plate(int nx, int ny, double size, double m);

/// Quads through the given corner points, all with node mass m; quad holds node
/// numbers.
Nodes mesh_of(const std::vector<Vec>& corners, const std::vector<std::int32_t>& quad, double m);

/// Contacts of one particle of radius l0 at x against the mesh, everything at
/// rest.
std::vector<Contact> contacts_at(const Nodes& nodes, const Vec& x, double l0);

/// Leapfrog of particles and nodes with contact in between: v += a (dt^{n-1} +
/// dt^n)/2, x += v dt.
class World {
 public:
    World(Nodes nodes, Particles particles, const LawSettings& law, double skin = 1e3);

    std::function<Vec(std::size_t)> particle_load = [](std::size_t) {
        return Vec(0, 0, 0);
    };                                                                                     // [N]
    std::function<Vec(std::size_t)> node_load = [](std::size_t) { return Vec(0, 0, 0); };  // [N]
    bool nodes_fixed = false;

    void step(double dt);
    double kinetic_energy() const;  // [J]
    Nodes nodes;
    Particles particles;
    PenaltyContact contact;

 private:
    double skin_, last_dt_ = 0;
    std::vector<double> x_active_, v_active_;
    bool first_ = true;
};

}  // namespace undertow::contact::test
