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

// Of l0: a particle that starts deeper than this is inside, and comes out at this share of
// l0 sqrt(k/m_c).
constexpr double inside_from = 0.1, out_rate = 0.02;

}  // namespace

void ForceLaw::renumber(std::span<const std::int64_t> old_row) {
    next_.assign(old_row.size(), 0);
    in_contact_.clear();
    for (std::size_t i = 0; i < old_row.size(); ++i) {
        if (old_row[i] < 0 || std::size_t(old_row[i]) >= memory_.size()) continue;
        next_[i] = memory_[old_row[i]];
        if (next_[i] > 0) in_contact_.push_back(std::uint32_t(i));
    }
    memory_.swap(next_);
    next_.assign(old_row.size(), 0);
    if (inside_.empty()) return;
    next_inside_.assign(old_row.size(), 0);
    for (std::size_t i = 0; i < old_row.size(); ++i)
        if (old_row[i] >= 0 && std::size_t(old_row[i]) < inside_.size())
            next_inside_[i] = inside_[old_row[i]];
    inside_.swap(next_inside_);
}

void ForceLaw::find_start_inside(const Points& active, const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) {
        const std::uint32_t i = contact.particle;
        const double depth = contact.depth / active.radius[i];
        if (depth <= inside_from) continue;
        if (inside_.empty()) inside_.assign(active.size(), 0);
        if (inside_[i] == 0) ++start_inside_.particles;
        inside_[i] = std::max(inside_[i], contact.depth);
        if (depth > start_inside_.deepest) {
            start_inside_.deepest = depth;
            start_inside_.id = active.id[i];
        }
    }
}

void ForceLaw::compute(const Points& active, const Surface& surface, double dt,
                       std::vector<Contact>& contacts) {
    if (memory_.size() != active.size()) {
        memory_.assign(active.size(), 0);
        in_contact_.clear();
    }
    next_.resize(active.size());
    clear(active.size(), surface.nodes());
    share_masses(surface, contacts);
    if (!started_) find_start_inside(active, contacts);
    if (!settings_.ease_start) inside_.clear();
    started_ = true;

    // Tangential and normal dampers of one contact act at right angles: each may use the whole
    // budget beta + 2 eta that the contact holds of a node, and never more than stops the slip.
    const double eta_t = std::min(1.0, 0.5 * settings_.beta + settings_.eta);
    const Eq11Stiffness limit{settings_.beta, dt};
    const NormalDamping damping{settings_.beta, settings_.eta, dt};
    const auto with_friction = [&](const auto& friction) {
        if (settings_.stiffness == StiffnessKind::fluid)
            push(FluidStiffness{limit, settings_.chi}, dt, damping, friction, active, surface,
                 contacts);
        else
            push(limit, dt, damping, friction, active, surface, contacts);
    };
    if (settings_.friction == FrictionKind::coulomb)
        with_friction(CoulombFriction{settings_.mu, eta_t, dt});
    else
        with_friction(ViscousFriction{settings_.alpha, settings_.mu, eta_t, dt});
    sum(surface, contacts);
}

void ForceLaw::clear(std::size_t particles, std::size_t nodes) {
    node_sum_.resize(nodes);
    is_touched_.resize(nodes, 0);
    node_force_.resize(3 * nodes, 0);
    for (std::int32_t node : touched_) {
        node_sum_[node] = {};
        is_touched_[node] = 0;
        for (int axis = 0; axis < 3; ++axis) node_force_[3 * std::size_t(node) + axis] = 0;
    }
    touched_.clear();
    contacts_of_.assign(particles, 0);
    particle_sum_.assign(3 * particles, 0);
    particle_force_.assign(3 * particles, 0);
}

/// S_a and c_i of the effective masses.
void ForceLaw::share_masses(const Surface& surface, const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) {
        ++contacts_of_[contact.particle];
        const std::int32_t* q = surface.corners(contact.facet);
        for (int a = 0; a < 4; ++a) {
            node_sum_[q[a]].share += std::llrint(contact.weight[a] * one_share);
            if (is_touched_[q[a]]) continue;
            is_touched_[q[a]] = 1;
            touched_.push_back(q[a]);
        }
    }
}

/// Mass, stiffness and force of every contact.
template <typename Stiffness, typename Friction>
void ForceLaw::push(const Stiffness& stiffness_of, double dt, const NormalDamping& damping,
                    const Friction& friction, const Points& active, const Surface& surface,
                    std::vector<Contact>& contacts) {
    former_.swap(in_contact_);
    in_contact_.clear();
    double largest = 0, health = 0;  // health is NaN as soon as one force is NaN or infinite
    for (Contact& contact : contacts) {
        const std::int32_t* q = surface.corners(contact.facet);
        double inverse = (settings_.scale_by_valence ? contacts_of_[contact.particle] : 1) /
                         active.mass[contact.particle];
        for (int a = 0; a < 4; ++a) {
            const double share = settings_.scale_by_valence
                                     ? double(node_sum_[q[a]].share) * (1 / one_share)
                                     : contact.weight[a];
            inverse += contact.weight[a] * share * surface.inverse_mass(q[a]);
        }
        const double m_c = 1 / inverse;
        double* inside = inside_.empty() ? nullptr : &inside_[contact.particle];
        if (inside) {
            *inside = std::min(*inside, contact.depth);
            contact.depth -= *inside;
        }

        // Within a contact the stiffness falls or stays.
        const double before = memory_[contact.particle];
        double k = stiffness_of(m_c, active.stiffness[contact.particle]);
        if (before > 0) {
            k = std::min(k, before);
        }
        // A particle in a corner remembers the softest of its contacts. Whoever has left the
        // surface has no entry and starts anew at the next touch.
        double& next = next_[contact.particle];
        if (next == 0) {
            next = k;
            in_contact_.push_back(contact.particle);
        } else {
            next = std::min(next, k);
        }

        /// f_n = max(0, k d + c dd/dt) n: no adhesion.  [N]  [Wang 2024, Eq. 8]
        const double elastic = k * contact.depth;
        const double f_n = std::max(0.0, elastic + damping(m_c, k) * contact.closing);
        const double speed = contact.slip.norm();
        const double drag = friction(m_c, f_n, speed);
        contact.mass = m_c;
        contact.stiffness = k;
        contact.normal_force = f_n;
        contact.damping_force = f_n - elastic;
        if (inside && *inside > 0)
            *inside = std::max(0.0, *inside - out_rate * active.radius[contact.particle] *
                                                  std::sqrt(k / m_c) * dt);
        contact.friction = (speed > 0 ? -drag / speed : 0.0) * contact.slip;
        contact.force = f_n * contact.normal + contact.friction;
        largest = std::max(largest, contact.force.cwiseAbs().maxCoeff());
        health += 0 * contact.force.sum();
    }
    for (std::uint32_t i : former_) memory_[i] = 0;
    memory_.swap(next_);  // next_ is all empty again
    largest_ = largest;
    finite_ = health == 0;
}

void ForceLaw::sum(const Surface& surface, const std::vector<Contact>& contacts) {
    quantum_ = 0;
    // Forces whose quantum would be no normal number are zero for every purpose.
    if (!finite_ || largest_ <= std::ldexp(std::numeric_limits<double>::min(), force_bits + 1))
        return;
    quantum_ = std::ldexp(1.0, std::ilogb(largest_) + 1 - force_bits);
    const double per_quantum = 1 / quantum_;
    for (const Contact& contact : contacts) {
        const std::int32_t* q = surface.corners(contact.facet);
        int rest = 0;  // the node with the largest weight takes the remainder: nothing is lost
        for (int a = 1; a < 4; ++a)
            if (contact.weight[a] > contact.weight[rest]) rest = a;
        std::array<std::int64_t, 3> left;
        for (int axis = 0; axis < 3; ++axis) {
            left[axis] = std::llrint(contact.force[axis] * per_quantum);
            particle_sum_[3 * std::size_t(contact.particle) + axis] += left[axis];
        }
        const std::array<std::int64_t, 3> whole = left;
        for (int a = 0; a < 4; ++a) {
            if (a == rest) continue;
            for (int axis = 0; axis < 3; ++axis) {
                const std::int64_t part = std::llrint(contact.weight[a] * double(whole[axis]));
                node_sum_[q[a]].force[axis] -= part;
                left[axis] -= part;
            }
        }
        for (int axis = 0; axis < 3; ++axis) node_sum_[q[rest]].force[axis] -= left[axis];
    }
    for (std::size_t i = 0; i < particle_sum_.size(); ++i)
        particle_force_[i] = double(particle_sum_[i]) * quantum_;
    for (std::int32_t node : touched_)
        for (int axis = 0; axis < 3; ++axis)
            node_force_[3 * std::size_t(node) + axis] =
                double(node_sum_[node].force[axis]) * quantum_;
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
