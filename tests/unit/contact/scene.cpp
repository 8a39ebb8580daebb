#include "scene.hpp"

namespace undertow::contact::test {

void Particles::add(const Vec& position, const Vec& velocity, double m, double l0, double k) {
    x.insert(x.end(), position.begin(), position.end());
    v.insert(v.end(), velocity.begin(), velocity.end());
    mass.push_back(m);
    radius.push_back(l0);
    stiffness.push_back(k);
    id.push_back(1000 + 7 * id.size());
}

Nodes mesh_of(const std::vector<Vec>& corners, const std::vector<std::int32_t>& quad, double m) {
    Nodes nodes;
    for (const Vec& x : corners) nodes.x.insert(nodes.x.end(), x.begin(), x.end());
    nodes.v.assign(nodes.x.size(), 0);
    nodes.mass.assign(corners.size(), m);
    nodes.quad = quad;
    return nodes;
}

Nodes flat_plate(int nx, int ny, double size, double m) {
    std::vector<Vec> corners;
    std::vector<std::int32_t> quad;
    for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i) corners.push_back({i * size, j * size, 0});
    for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
            const std::int32_t a = j * (nx + 1) + i;
            quad.insert(quad.end(), {a, a + 1, a + nx + 2, a + nx + 1});
        }
    return mesh_of(corners, quad, m);
}

std::vector<Contact> contacts_at(const Nodes& nodes, const Vec& x, double l0) {
    Particles particles;
    particles.add(x, Vec::Zero(), 1, l0, 1);
    PenaltyContact contact(nodes.surface(), {});
    contact.rebuild(particles.points(), 0.1 * l0, nodes.x, nodes.v);
    return contact.contacts().rows();
}

World::World(Nodes n, Particles p, const LawSettings& law, double skin)
    : nodes(std::move(n)), particles(std::move(p)), contact(nodes.surface(), law), skin_(skin) {}

void World::step(double dt) {
    if (first_) contact.rebuild(particles.points(), skin_, nodes.x, nodes.v);
    const auto rows = contact.active_rows();
    if (!first_) {
        x_active_.resize(3 * rows.size());
        v_active_.resize(3 * rows.size());
        for (std::size_t i = 0; i < 3 * rows.size(); ++i) {
            x_active_[i] = particles.x[3 * rows[i / 3] + i % 3];
            v_active_[i] = particles.v[3 * rows[i / 3] + i % 3];
        }
        contact.update(x_active_, v_active_, nodes.x, nodes.v);
    }
    first_ = false;
    contact.compute_forces(dt);
    contact.settle();

    const double kick = 0.5 * (last_dt_ + dt);
    last_dt_ = dt;
    std::vector<double> force(particles.x.size(), 0);
    for (std::size_t i = 0; i < 3 * rows.size(); ++i)
        force[3 * rows[i / 3] + i % 3] = contact.on_particles()[i];
    for (std::size_t i = 0; i < particles.x.size(); ++i) {
        const double load = particle_load(i / 3)[i % 3];
        particles.v[i] += kick * (force[i] + load) / particles.mass[i / 3];
        particles.x[i] += dt * particles.v[i];
    }
    if (nodes_fixed) return;
    for (std::size_t i = 0; i < nodes.x.size(); ++i) {
        const double load = node_load(i / 3)[i % 3];
        nodes.v[i] += kick * (contact.on_nodes()[i] + load) / nodes.mass[i / 3];
        nodes.x[i] += dt * nodes.v[i];
    }
}

double World::kinetic_energy() const {
    double energy = 0;
    for (std::size_t i = 0; i < particles.v.size(); ++i)
        energy += 0.5 * particles.mass[i / 3] * particles.v[i] * particles.v[i];
    for (std::size_t i = 0; i < nodes.v.size(); ++i)
        energy += 0.5 * nodes.mass[i / 3] * nodes.v[i] * nodes.v[i];
    return energy;
}

}  // namespace undertow::contact::test
