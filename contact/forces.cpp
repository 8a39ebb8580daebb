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
    rows_changed_ = true;
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

void ForceLaw::find_start_inside(const Points& active, const ContactList& contacts) {
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
                       ContactList& contacts) {
    if (memory_.size() != active.size()) {
        memory_.assign(active.size(), 0);
        in_contact_.clear();
        rows_changed_ = true;
    }
    next_.resize(active.size());
    clear(active.size(), surface.nodes());
    share_masses(contacts);
    if (!started_) find_start_inside(active, contacts);
    if (!settings_.ease_start) inside_.clear();
    started_ = true;
    take_off_inside(active, contacts);

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
    sum(contacts);
}

void ForceLaw::clear(std::size_t particles, std::size_t nodes) {
    node_sum_.resize(nodes);
    node_force_.resize(3 * nodes, 0);
    for (std::int32_t node : touched_) {
        node_sum_[node] = {};
        for (int axis = 0; axis < 3; ++axis) node_force_[3 * std::size_t(node) + axis] = 0;
    }
    touched_.clear();
    if (rows_changed_ || particle_sum_.size() != 3 * particles) {
        contacts_of_.assign(particles, 0);
        particle_sum_.assign(3 * particles, 0);
        particle_force_.assign(3 * particles, 0);
    } else {
        for (std::uint32_t i : in_contact_) {
            contacts_of_[i] = 0;
            for (int axis = 0; axis < 3; ++axis)
                particle_sum_[3 * std::size_t(i) + axis] = 0,
                                              particle_force_[3 * std::size_t(i) + axis] = 0;
        }
    }
    rows_changed_ = false;
}

/// S_a and c_i of the effective masses.
void ForceLaw::share_masses(const ContactList& contacts) {
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        const ContactPack& pack = contacts.pack(p);
        const int lanes = contacts.lanes(p);
        for (int lane = 0; lane < lanes; ++lane)
            contacts_of_[std::size_t(pack.particle[lane])] += 1;
        for (int a = 0; a < 4; ++a) {
            const LaneWholes share = rounded(pack.weight[a] * spread<Lanes>(one_share));
            for (int lane = 0; lane < lanes; ++lane) {
                const std::int32_t node = pack.node[a][lane];
                std::int64_t& sum = node_sum_[std::size_t(node)].share;
                if (sum == untouched) {
                    sum = 0;
                    touched_.push_back(node);
                }
                sum += share[lane];
            }
        }
    }
}

/// What a particle was in at the start does not count.
void ForceLaw::take_off_inside(const Points& active, ContactList& contacts) {
    if (inside_.empty()) return;
    inside_.resize(active.size(), 0);
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        ContactPack& pack = contacts.pack(c / lane_count);
        double& inside = inside_[contacts.particle(c)];
        double depth = pack.depth[c % lane_count];
        inside = std::min(inside, depth);
        depth -= inside;
        pack.depth[c % lane_count] = depth;
    }
    contacts.fill_lanes_beyond();
}

/// ... and is given back slowly.
void ForceLaw::ease_out(const Points& active, double dt, const ContactPack& pack, int lanes,
                        const Lanes& m_c) {
    for (int lane = 0; lane < lanes; ++lane) {
        const std::size_t i = std::size_t(pack.particle[lane]);
        if (inside_[i] > 0)
            inside_[i] = std::max(0.0, inside_[i] - out_rate * active.radius[i] *
                                           std::sqrt(pack.stiffness[lane] / m_c[lane]) * dt);
    }
}

/// Mass, stiffness and force of every contact.
template <typename Stiffness, typename Friction>
void ForceLaw::push(const Stiffness& stiffness_of, double dt, const NormalDamping& damping,
                    const Friction& friction, const Points& active, const Surface& surface,
                    ContactList& contacts) {
    former_.swap(in_contact_);
    in_contact_.clear();
    const Lanes none = spread<Lanes>(0);
    Lanes largest = none, health = none;  // health is NaN as soon as one force is NaN or infinite
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        ContactPack& c = contacts.pack(p);
        Lanes inverse = spread<Lanes>(1);
        if (settings_.scale_by_valence) inverse = gather(contacts_of_.data(), c.particle);
        inverse = inverse / gather(active.mass.data(), c.particle);
        for (int a = 0; a < 4; ++a) {
            const Lanes share = settings_.scale_by_valence
                                    ? gather_wholes(&node_sum_[0].share, 4 * c.node[a]) *
                                          (1 / one_share)
                                    : c.weight[a];
            inverse = inverse + c.weight[a] * share * gather(surface.inverse_masses(), c.node[a]);
        }
        const Lanes m_c = 1 / inverse;

        // Within a contact the stiffness falls or stays.
        const Lanes before = gather(memory_.data(), c.particle);
        Lanes k = stiffness_of(m_c, gather(active.stiffness.data(), c.particle));
        k = select(less(none, before), smaller(k, before), k);
        // A particle in a corner remembers the softest of its contacts. Whoever has left the
        // surface has no entry and starts anew at the next touch.
        for (int lane = 0; lane < contacts.lanes(p); ++lane) {
            double& next = next_[std::size_t(c.particle[lane])];
            if (next == 0) {
                next = k[lane];
                in_contact_.push_back(std::uint32_t(c.particle[lane]));
            } else {
                next = std::min<double>(next, k[lane]);
            }
        }

        /// f_n = max(0, k d + c dd/dt) n: no adhesion.  [N]  [Wang 2024, Eq. 8]
        const Lanes elastic = k * c.depth;
        const Lanes f_n = larger(none, elastic + damping(m_c, k) * c.closing);
        const Lanes speed = norm(c.slip);
        const Lanes drag = friction(m_c, f_n, speed);
        c.stiffness = k;
        c.normal_force = f_n;
        c.damping_force = f_n - elastic;
        c.drag = select(less(none, speed), drag / speed, none);
        if (!inside_.empty()) ease_out(active, dt, c, contacts.lanes(p), m_c);
        const Three<Lanes> force = c.force();
        for (const Lanes* component : {&force.x, &force.y, &force.z}) {
            const Lanes size = larger(*component, -*component);
            largest = larger(largest, size);
            health = health + 0 * *component;
        }
    }
    for (std::uint32_t i : former_) memory_[i] = 0;
    memory_.swap(next_);  // next_ is all empty again
    largest_ = 0;
    double sick = 0;
    for (int lane = 0; lane < lane_count; ++lane) {
        largest_ = std::max<double>(largest_, largest[lane]);
        sick += health[lane];
    }
    finite_ = sick == 0;
}

void ForceLaw::sum(const ContactList& contacts) {
    quantum_ = 0;
    // Forces whose quantum would be no normal number are zero for every purpose.
    if (!finite_ || largest_ <= std::ldexp(std::numeric_limits<double>::min(), force_bits + 1))
        return;
    quantum_ = std::ldexp(1.0, std::ilogb(largest_) + 1 - force_bits);
    const Lanes per_quantum = spread<Lanes>(1 / quantum_);
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        const ContactPack& c = contacts.pack(p);
        const Three<Lanes> force = c.force();
        const LaneWholes whole[3] = {rounded(force.x * per_quantum), rounded(force.y * per_quantum),
                                     rounded(force.z * per_quantum)};
        // The node with the largest weight takes the remainder: nothing is lost.
        Lanes heaviest = c.weight[0];
        LaneMask rest[4] = {first_lanes(lane_count), first_lanes(0), first_lanes(0),
                            first_lanes(0)};
        for (int a = 1; a < 4; ++a) {
            const LaneMask more = less(heaviest, c.weight[a]);
            heaviest = select(more, c.weight[a], heaviest);
            for (int b = 0; b < a; ++b) rest[b] = without(rest[b], more);
            rest[a] = more;
        }
        LaneWholes part[4][3];
        for (int axis = 0; axis < 3; ++axis) {
            LaneWholes left = whole[axis];
            for (int a = 0; a < 4; ++a) {
                part[a][axis] = rounded(c.weight[a] * as_numbers(whole[axis]));
                left = left - part[a][axis];
            }
            for (int a = 0; a < 4; ++a)
                part[a][axis] = select(rest[a], part[a][axis] + left, part[a][axis]);
        }
        const int lanes = contacts.lanes(p);
        for (int lane = 0; lane < lanes; ++lane) {
            std::int64_t* on_particle = &particle_sum_[3 * std::size_t(c.particle[lane])];
            for (int axis = 0; axis < 3; ++axis) on_particle[axis] += whole[axis][lane];
            for (int a = 0; a < 4; ++a) {
                NodeSum& on_node = node_sum_[c.node[a][lane]];
                for (int axis = 0; axis < 3; ++axis) on_node.force[axis] -= part[a][axis][lane];
            }
        }
    }
    for (std::uint32_t i : in_contact_)
        for (int axis = 0; axis < 3; ++axis)
            particle_force_[3 * std::size_t(i) + axis] =
                double(particle_sum_[3 * std::size_t(i) + axis]) * quantum_;
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
