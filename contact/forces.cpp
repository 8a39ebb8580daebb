#include "contact/forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/laws.hpp"

namespace undertow::contact {

namespace {

// Rounding a force to 2^-40 of the largest one is far below what x and v are known to; a sum of
// 2^13 such forces is still exact as a double, 2^23 as an integer.
constexpr int force_bits = 40;
// Shape weights are summed as integers for the same reason: 1 = 2^40.
constexpr double one_share = 1099511627776.0;

}  // namespace

void ForceLaw::renumber(std::span<const std::int64_t> old_row) {
    next_.assign(old_row.size(), {});
    in_contact_.clear();
    for (std::size_t i = 0; i < old_row.size(); ++i) {
        if (old_row[i] < 0 || std::size_t(old_row[i]) >= memory_.size()) continue;
        next_[i] = memory_[old_row[i]];
        if (next_[i].stiffness > 0) in_contact_.push_back(std::uint32_t(i));
    }
    memory_.swap(next_);
    next_.assign(old_row.size(), {});
}

void ForceLaw::compute(const Points& active, const Surface& surface, double dt,
                       std::vector<Contact>& contacts) {
    if (memory_.size() != active.size()) {
        memory_.assign(active.size(), {});
        in_contact_.clear();
    }
    next_.resize(active.size());
    share_masses(active, surface, contacts);

    // Tangential and normal dampers of one contact act at right angles: each may use the whole
    // budget beta + 2 eta that the contact holds of a node, and never more than stops the slip.
    const double eta_t = std::min(1.0, 0.5 * settings_.beta + settings_.eta);
    const Eq11Stiffness limit{settings_.beta, dt};
    const NormalDamping damping{settings_.beta, settings_.eta, dt};
    if (settings_.stiffness == StiffnessKind::fluid)
        choose_stiffness(FluidStiffness{limit, settings_.chi}, active, contacts);
    else
        choose_stiffness(limit, active, contacts);
    if (settings_.friction == FrictionKind::coulomb)
        apply(damping, CoulombFriction{settings_.mu, eta_t, dt}, contacts);
    else
        apply(damping, ViscousFriction{settings_.alpha, settings_.mu, eta_t, dt}, contacts);
    sum(surface, contacts, active.size());
}

void ForceLaw::share_masses(const Points& active, const Surface& surface,
                            std::vector<Contact>& contacts) {
    share_.assign(surface.nodes(), 0);
    contacts_of_.assign(active.size(), 0);
    for (const Contact& contact : contacts) {
        ++contacts_of_[contact.particle];
        const std::int32_t* q = surface.corners(contact.facet);
        for (int a = 0; a < 4; ++a) share_[q[a]] += std::llrint(contact.weight[a] * one_share);
    }
    for (Contact& contact : contacts) {
        const std::int32_t* q = surface.corners(contact.facet);
        double inverse = (settings_.scale_by_valence ? contacts_of_[contact.particle] : 1) /
                         active.mass[contact.particle];
        for (int a = 0; a < 4; ++a) {
            const double share =
                settings_.scale_by_valence ? double(share_[q[a]]) / one_share : contact.weight[a];
            inverse += contact.weight[a] * share / surface.mass(q[a]);
        }
        contact.mass = 1 / inverse;
    }
}

template <typename Stiffness>
void ForceLaw::choose_stiffness(const Stiffness& stiffness, const Points& active,
                                std::vector<Contact>& contacts) {
    relaxation_ = 0;
    for (Contact& contact : contacts) {
        const Memory& before = memory_[contact.particle];
        contact.stiffness = stiffness(contact.mass, active.stiffness[contact.particle]);
        if (before.stiffness > 0) {
            const double drop = before.stiffness - contact.stiffness;
            if (drop > 0) relaxation_ += 0.5 * drop * contact.depth * before.depth;
            contact.stiffness = std::min(contact.stiffness, before.stiffness);
        }
    }
    // A particle in a corner remembers the softest of its contacts and the deepest penetration.
    // Whoever has left the surface has no entry and starts anew at the next touch.
    former_.swap(in_contact_);
    in_contact_.clear();
    for (const Contact& contact : contacts) {
        Memory& next = next_[contact.particle];
        if (next.stiffness == 0) {
            next = {contact.stiffness, contact.depth};
            in_contact_.push_back(contact.particle);
        } else {
            next.stiffness = std::min(next.stiffness, contact.stiffness);
            next.depth = std::max(next.depth, contact.depth);
        }
    }
    for (std::uint32_t i : former_) memory_[i] = {};
    memory_.swap(next_);  // next_ is all empty again
}

/// f_n = max(0, k d + c dd/dt) n: no adhesion.  [N]  [Wang 2024, Eq. 8]
template <typename Friction>
void ForceLaw::apply(const NormalDamping& damping, const Friction& friction,
                     std::vector<Contact>& contacts) const {
    for (Contact& contact : contacts) {
        const double elastic = contact.stiffness * contact.depth;
        const double c = damping(contact.mass, contact.stiffness);
        contact.normal_force = std::max(0.0, elastic + c * contact.closing);
        contact.damping_force = contact.normal_force - elastic;
        const double speed = contact.slip.norm();
        const double drag = friction(contact.mass, contact.normal_force, speed);
        contact.friction = speed > 0 ? Vec(-drag / speed * contact.slip) : Vec(Vec::Zero());
        contact.force = contact.normal_force * contact.normal + contact.friction;
    }
}

void ForceLaw::sum(const Surface& surface, const std::vector<Contact>& contacts,
                   std::size_t particles) {
    particle_sum_.assign(3 * particles, 0);
    node_sum_.assign(3 * surface.nodes(), 0);
    double largest = 0, health = 0;  // health is NaN as soon as one force is NaN or infinite
    for (const Contact& contact : contacts) {
        largest = std::max(largest, contact.force.cwiseAbs().maxCoeff());
        health += 0 * contact.force.sum();
    }
    finite_ = health == 0;
    quantum_ = 0;
    // Forces whose quantum would be no normal number are zero for every purpose.
    if (finite_ && largest > std::ldexp(std::numeric_limits<double>::min(), force_bits + 1)) {
        quantum_ = std::ldexp(1.0, std::ilogb(largest) + 1 - force_bits);
        const double per_quantum = 1 / quantum_;
        for (const Contact& contact : contacts) {
            const std::int32_t* q = surface.corners(contact.facet);
            const int rest = int(std::max_element(contact.weight.begin(), contact.weight.end()) -
                                 contact.weight.begin());
            for (int axis = 0; axis < 3; ++axis) {
                const std::int64_t whole = std::llrint(contact.force[axis] * per_quantum);
                std::int64_t given = 0;
                for (int a = 0; a < 4; ++a) {
                    if (a == rest) continue;
                    const std::int64_t part = std::llrint(contact.weight[a] * double(whole));
                    node_sum_[3 * q[a] + axis] -= part;
                    given += part;
                }
                node_sum_[3 * q[rest] + axis] -= whole - given;  // the remainder: nothing is lost
                particle_sum_[3 * contact.particle + axis] += whole;
            }
        }
    }
    particle_force_.resize(particle_sum_.size());
    node_force_.resize(node_sum_.size());
    for (std::size_t i = 0; i < particle_sum_.size(); ++i)
        particle_force_[i] = double(particle_sum_[i]) * quantum_;
    for (std::size_t i = 0; i < node_sum_.size(); ++i)
        node_force_[i] = double(node_sum_[i]) * quantum_;
}

double ForceLaw::momentum_residual() const {
    if (quantum_ == 0) return 0;
    std::array<std::int64_t, 3> total{};
    const double per_quantum = 1 / quantum_;  // a power of two: every product is a whole number
    for (std::span<const double> side : {on_particles(), on_nodes()})
        for (std::size_t i = 0; i + 2 < side.size(); i += 3)
            for (int axis = 0; axis < 3; ++axis)
                total[axis] += static_cast<std::int64_t>(side[i + axis] * per_quantum);
    double residual = 0;
    for (std::int64_t sum : total) residual = std::max(residual, std::abs(double(sum)) * quantum_);
    return residual;
}

}  // namespace undertow::contact
