#include "contact/forces.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "contact/laws.hpp"
#include "scene.hpp"

using namespace undertow::contact;
using namespace undertow::contact::test;

namespace {

/// A wavy plate with many particles pressed into it at random.
struct Crowd {
    Nodes plate = flat_plate(12, 9, 0.1, 0.4);
    Particles particles;
    Crowd() {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> any(0, 1);
        for (std::size_t n = 0; n < plate.mass.size(); ++n) {
            plate.x[3 * n + 2] =
                0.02 * std::sin(7 * plate.x[3 * n]) * std::cos(5 * plate.x[3 * n + 1]);
            plate.mass[n] *= 0.5 + any(random);
            for (int axis = 0; axis < 3; ++axis) plate.v[3 * n + axis] = any(random) - 0.5;
        }
        for (int i = 0; i < 800; ++i)
            particles.add({1.2 * any(random), 0.9 * any(random), 0.06 * any(random)},
                          {any(random) - 0.5, any(random) - 0.5, -any(random)}, 0.1 + any(random),
                          0.05, 1e5 * any(random));
    }
};

LawSettings frictional() {
    LawSettings law;
    law.mu = 0.3;
    return law;
}

}  // namespace

TEST_CASE("contact forces of particles and nodes sum to exactly zero") {
    Crowd crowd;
    PenaltyContact contact(crowd.plate.surface(), frictional());
    contact.rebuild(crowd.particles.points(), 0.01, crowd.plate.x, crowd.plate.v);
    contact.compute_forces(1e-3);
    REQUIRE(contact.contacts().size() > 300);
    CHECK(contact.momentum_residual() == 0);
    // Exact sums of the doubles that are sent, too: all are multiples of one power of two.
    double sum[3] = {0, 0, 0}, size = 0;
    for (std::size_t i = 0; i < contact.on_particles().size(); ++i) {
        sum[i % 3] += contact.on_particles()[i];
        size += std::abs(contact.on_particles()[i]);
    }
    for (std::size_t i = 0; i < contact.on_nodes().size(); ++i) sum[i % 3] += contact.on_nodes()[i];
    CHECK(size > 0);
    for (double component : sum) CHECK(component == 0);
}

TEST_CASE("shuffled contacts give the same forces, bit for bit") {
    Crowd crowd;
    PenaltyContact contact(crowd.plate.surface(), frictional());
    contact.rebuild(crowd.particles.points(), 0.01, crowd.plate.x, crowd.plate.v);
    std::vector<Contact> contacts = contact.contacts().rows();
    Surface surface = crowd.plate.surface();
    surface.move(crowd.plate.x, crowd.plate.v);
    // Without a search every particle is active, and contacts name active rows.
    for (Contact& c : contacts) c.particle = contact.active_rows()[c.particle];

    ForceLaw ordered(frictional()), shuffled(frictional());
    std::mt19937 random(3);
    for (int step = 0; step < 3;
         ++step) {  // later steps use what is remembered of the earlier ones
        ContactList in_order(contacts, surface.corners(0));
        ordered.compute(crowd.particles.points(), surface, 1e-3 / (1 + step), in_order);
        std::shuffle(contacts.begin(), contacts.end(), random);
        ContactList mixed(contacts, surface.corners(0));
        shuffled.compute(crowd.particles.points(), surface, 1e-3 / (1 + step), mixed);
        REQUIRE(std::equal(ordered.on_nodes().begin(), ordered.on_nodes().end(),
                           shuffled.on_nodes().begin()));
        REQUIRE(std::equal(ordered.on_particles().begin(), ordered.on_particles().end(),
                           shuffled.on_particles().begin()));
    }
}

TEST_CASE("normal contact conserves moments") {
    Crowd crowd;
    PenaltyContact contact(crowd.plate.surface(), LawSettings{});
    contact.rebuild(crowd.particles.points(), 0.01, crowd.plate.x, crowd.plate.v);
    contact.compute_forces(1e-3);
    Vec moment = Vec::Zero();
    double size = 0;
    for (std::size_t i = 0; i < contact.active_rows().size(); ++i) {
        const Vec x = Vec::Map(&crowd.particles.x[3 * contact.active_rows()[i]]);
        const Vec m = x.cross(Vec::Map(&contact.on_particles()[3 * i]));
        moment += m;
        size += m.norm();
    }
    for (std::size_t n = 0; n < crowd.plate.mass.size(); ++n)
        moment += Vec::Map(&crowd.plate.x[3 * n]).cross(Vec::Map(&contact.on_nodes()[3 * n]));
    // Quantum 2^-40 of the largest force and round-off of the closest point, 1e-16/1e-2 of l0.
    CHECK(moment.norm() < 1e-11 * size);
}

TEST_CASE("one particle on one node has the stiffness of Eq. 11 with m_i restored") {
    LawSettings law;
    law.stiffness = StiffnessKind::eq11;
    law.eta = 0;
    const double m_i = 2, m_n = 5, dt = 1e-3, l0 = 0.1, d = 0.01;
    const Nodes plate = flat_plate(2, 2, 1, m_n);
    Particles particles;
    particles.add({1, 1, l0 - d}, {0, 0, 0}, m_i, l0, 1);
    PenaltyContact contact(plate.surface(), law);
    contact.rebuild(particles.points(), 0.1, plate.x, plate.v);
    contact.compute_forces(dt);
    const double k = 0.25 * m_i * m_n / (m_i + m_n) / (dt * dt);
    CHECK(contact.on_particles()[2] == Approx(k * d));
    CHECK(contact.on_nodes()[3 * 4 + 2] == Approx(-k * d));
}

TEST_CASE("below its valence limit the fluid law does not depend on dt") {
    const Nodes plate = flat_plate(2, 2, 1, 1e3);
    Particles particles;
    particles.add({0.7, 0.9, 0.09}, {0, 0, 0}, 2, 0.1, 5e4);
    for (double dt : {1e-5, 1e-4, 1e-3}) {
        PenaltyContact contact(plate.surface(), LawSettings{});
        contact.rebuild(particles.points(), 0.1, plate.x, plate.v);
        contact.compute_forces(dt);
        CHECK(contact.on_particles()[2] == Approx(5e4 * 0.01));
    }
}

TEST_CASE("a surface never pulls") {
    const Nodes plate = flat_plate(2, 2, 1, 1e3);
    Particles particles;
    particles.add({0.7, 0.9, 0.0999}, {0, 0, 10}, 2, 0.1, 5e4);  // leaving fast
    PenaltyContact contact(plate.surface(), LawSettings{});
    contact.rebuild(particles.points(), 0.1, plate.x, plate.v);
    contact.compute_forces(1e-4);
    REQUIRE(contact.contacts().size() == 1);
    CHECK(contact.on_particles()[2] == 0);
}

TEST_CASE("stiffness may fall within a contact, never rise, and starts anew after separation") {
    LawSettings law;
    law.stiffness = StiffnessKind::eq11;
    law.eta = 0;
    const Nodes plate = flat_plate(2, 2, 1, 1e9);
    Particles particles;
    particles.add({1, 1, 0.09}, {0, 0, 0}, 1, 0.1, 1);
    PenaltyContact contact(plate.surface(), law);
    contact.rebuild(particles.points(), 0.1, plate.x, plate.v);
    const auto stiffness = [&](double dt, double z) {
        const std::vector<double> x{1, 1, z}, v{0, 0, 0};
        contact.update(x, v, plate.x, plate.v);
        contact.compute_forces(dt);
        return contact.contacts().empty() ? 0.0 : contact.contacts()[0].stiffness;
    };
    CHECK(stiffness(1e-3, 0.09) == Approx(0.25e6).epsilon(1e-6));
    CHECK(stiffness(5e-4, 0.09) == Approx(0.25e6).epsilon(1e-6));    // smaller dt keeps k
    CHECK(stiffness(2e-3, 0.09) == Approx(0.0625e6).epsilon(1e-6));  // larger dt lowers it
    CHECK(stiffness(1e-3, 0.09) == Approx(0.0625e6).epsilon(1e-6));  // and it stays low
    CHECK(stiffness(1e-3, 0.11) == 0);
    CHECK(stiffness(1e-3, 0.09) == Approx(0.25e6).epsilon(1e-6));  // a new contact
}

TEST_CASE("what is known of a contact survives a new search") {
    LawSettings law;
    law.stiffness = StiffnessKind::eq11;
    const Nodes plate = flat_plate(2, 2, 1, 1e9);
    Particles particles;
    particles.add({0.5, 0.5, 0.11}, {0, 0, 0}, 1, 0.1, 1);
    particles.add({1, 1, 0.09}, {0, 0, 0}, 1, 0.1, 1);
    PenaltyContact contact(plate.surface(), law);
    contact.rebuild(particles.points(), 0.1, plate.x, plate.v);
    contact.compute_forces(2e-3);
    REQUIRE(contact.contacts().size() == 1);
    const double held = contact.contacts()[0].stiffness;
    Particles later;  // other rows, same identity
    later.add({1, 1, 0.09}, {0, 0, 0}, 1, 0.1, 1);
    later.id[0] = particles.id[1];
    contact.rebuild(later.points(), 0.1, plate.x, plate.v);
    contact.compute_forces(1e-3);
    CHECK(contact.contacts()[0].stiffness == held);
}

TEST_CASE("the budget left by a soft spring goes to damping, critical at most") {
    const NormalDamping damping{0.25, 0.1, 1e-3};
    const double m = 2, limit = 0.25 * m / 1e-6;
    CHECK(damping(m, limit) == Approx(0.1 * m / 1e-3));        // all spent on stiffness
    CHECK(damping(m, 0.2 * limit) == Approx(0.2 * m / 1e-3));  // eta + 0.8 beta/2
    CHECK(damping(m, 1e-3 * limit) == Approx(2 * std::sqrt(1e-3 * limit * m)));  // critical
    CHECK(NormalDamping{0.25, 0, 1e-3}(m, limit) == 0);
}

TEST_CASE("viscous friction is limited by Coulomb only when a coefficient is given") {
    CHECK(ViscousFriction{3, 0, 0.2, 1e-3}(1.0, 10.0, 5.0) == Approx(15));
    CHECK(ViscousFriction{3, 0.5, 0.2, 1e-3}(1.0, 10.0, 5.0) == Approx(5));
    CHECK(ViscousFriction{1e9, 0, 0.2, 1e-3}(1.0, 10.0, 5.0) == Approx(0.2 * 1 / 1e-3 * 5));  // stability
}
