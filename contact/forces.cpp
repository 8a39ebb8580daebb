#include "contact/forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "contact/laws.hpp"

namespace undertow::contact {

namespace {

// Rounding a force to 2^-40 of the largest one is far below what x and v are known to; a sum of
// 2^13 such forces is still exact as a double, 2^23 as an integer.
constexpr int force_bits = 40;
// Shape weights are summed as integers for the same reason: 1 = 2^40.
constexpr double one_share = 1099511627776.0;

constexpr std::size_t packs_ahead = 3;  // that many packs of eight contacts hide the way to memory

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
    make_room(active.size(), surface.nodes());
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
    if (settings_.friction == FrictionKind::viscous)
        with_friction(ViscousFriction{settings_.alpha, settings_.mu, eta_t, dt});
    else if (settings_.mu > 0)
        with_friction(CoulombFriction{settings_.mu, eta_t, dt});
    else
        with_friction(NoFriction{});
    give_forces();
}

/// Asks for the sums of the nodes of a pack that comes later: they lie scattered, and nobody else
/// foresees which. g++ leaves out calls of a function that only fetches, unless it is inlined.
[[gnu::always_inline]] inline void ForceLaw::fetch_sums(const ContactList& contacts,
                                                        std::size_t p) {
    if (p >= contacts.packs()) return;
    const ContactPack& pack = contacts.pack(p);
    for (int a = 0; a < 4; ++a)
        for (int lane = 0; lane < lane_count; ++lane)
            __builtin_prefetch(&node_sum_[std::size_t(pack.node[a][lane])], 1);
}

void ForceLaw::make_room(std::size_t particles, std::size_t nodes) {
    if (node_sum_.size() != nodes) {
        node_sum_.assign(nodes, {});
        node_force_.assign(3 * nodes, 0);
        touched_.resize(nodes + 1);
        were_touched_.resize(nodes + 1);
        touched_count_ = 0;
    }
    touched_.swap(were_touched_);
    were_touched_count_ = touched_count_;
    if (rows_changed_ || particle_sum_.size() != 3 * particles) {
        contacts_of_.assign(particles, 0);
        particle_sum_.assign(3 * particles, 0);
        particle_force_.assign(3 * particles, 0);
    }
    rows_changed_ = false;
}

/// S_a and c_i of the effective masses. Whether a node is touched for the first time is anybody's
/// guess, a branch predictor's too: its row is written in any case, and counted if it is new.
void ForceLaw::share_masses(const ContactList& contacts) {
    std::int32_t* const touched = touched_.data();
    std::size_t count = 0;
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        const ContactPack& pack = contacts.pack(p);
        const int lanes = contacts.lanes(p);
        fetch_sums(contacts, p + packs_ahead);
        fetch_pack(contacts, p + 2 * packs_ahead);
        for (int lane = 0; lane < lanes; ++lane)
            contacts_of_[std::size_t(pack.particle[lane])] += 1;
        for (int a = 0; a < 4; ++a) {
            const LaneWholes share = rounded(pack.weight[a] * spread<Lanes>(one_share));
            for (int lane = 0; lane < lanes; ++lane) {
                const std::int32_t node = pack.node[a][lane];
                std::int64_t& sum = node_sum_[std::size_t(node)].share;
                const bool first = sum == untouched;
                touched[count] = node;
                count += first;
                sum = (first ? 0 : sum) + share[lane];
            }
        }
    }
    touched_count_ = count;
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

/// Mass, stiffness and force of every contact. Forces are summed at once with the quantum of the
/// step before: the largest force seldom passes a power of two, and if it did, they are summed again.
template <typename Stiffness, typename Friction>
void ForceLaw::push(const Stiffness& stiffness_of, double dt, const NormalDamping& damping,
                    const Friction& friction, const Points& active, const Surface& surface,
                    ContactList& contacts) {
    former_.swap(in_contact_);
    in_contact_.clear();
    const Lanes none = spread<Lanes>(0);
    Lanes largest = none, health = none;  // health is NaN as soon as one force is NaN or infinite
    const Lanes per_quantum = spread<Lanes>(1 / quantum_);
    const Lanes too_large = spread<Lanes>(std::ldexp(quantum_, force_bits));
    bool summed = quantum_ > 0;
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        ContactPack& c = contacts.pack(p);
        fetch_sums(contacts, p + packs_ahead);
        fetch_pack(contacts, p + 2 * packs_ahead);
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
        c.stiffness = k;
        c.normal_force = f_n;
        c.damping_force = f_n - elastic;
        Three<Lanes> force = f_n * c.normal;
        if constexpr (std::is_same_v<Friction, NoFriction>) {
            c.drag = none;
        } else {
            const Lanes speed = norm(c.slip);
            const Lanes drag = friction(m_c, f_n, speed);
            c.drag = select(less(none, speed), drag / speed, none);
            force = force + c.friction();
        }
        if (!inside_.empty()) ease_out(active, dt, c, contacts.lanes(p), m_c);
        LaneMask fits = first_lanes(lane_count);
        for (const Lanes* component : {&force.x, &force.y, &force.z}) {
            const Lanes size = larger(*component, -*component);
            largest = larger(largest, size);
            health = health + 0 * *component;
            fits = fits & less(size, too_large);
        }
        summed = summed && all(fits);
        if (summed) sum(c, contacts.lanes(p), force, per_quantum);
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

    const double guessed = quantum_;
    quantum_ = 0;
    // Forces whose quantum would be no normal number are zero for every purpose.
    if (finite_ && largest_ > std::ldexp(std::numeric_limits<double>::min(), force_bits + 1))
        quantum_ = std::ldexp(1.0, std::ilogb(largest_) + 1 - force_bits);
    if (!summed || quantum_ != guessed) sum_again(contacts);
}

/// Adds the forces of a pack to its particles and nodes.
void ForceLaw::sum(const ContactPack& c, int lanes, const Three<Lanes>& force,
                   const Lanes& per_quantum) {
    const LaneWholes whole[3] = {rounded(force.x * per_quantum), rounded(force.y * per_quantum),
                                 rounded(force.z * per_quantum)};
    // The node with the largest weight takes the remainder: nothing is lost.
    Lanes heaviest = c.weight[0];
    LaneMask rest[4] = {first_lanes(lane_count), first_lanes(0), first_lanes(0), first_lanes(0)};
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
    for (int lane = 0; lane < lanes; ++lane) {
        std::int64_t* on_particle = &particle_sum_[3 * std::size_t(c.particle[lane])];
        for (int axis = 0; axis < 3; ++axis) on_particle[axis] += whole[axis][lane];
        for (int a = 0; a < 4; ++a) {
            NodeSum& on_node = node_sum_[c.node[a][lane]];
            for (int axis = 0; axis < 3; ++axis) on_node.force[axis] -= part[a][axis][lane];
        }
    }
}

/// With a quantum that was not foreseen.
void ForceLaw::sum_again(const ContactList& contacts) {
    for (std::uint32_t i : in_contact_)
        for (int axis = 0; axis < 3; ++axis) particle_sum_[3 * std::size_t(i) + axis] = 0;
    for (std::int32_t node : touched_nodes()) node_sum_[node].force = {};
    if (quantum_ == 0) return;
    const Lanes per_quantum = spread<Lanes>(1 / quantum_);
    for (std::size_t p = 0; p < contacts.packs(); ++p)
        sum(contacts.pack(p), contacts.lanes(p), contacts.pack(p).force(), per_quantum);
}

/// Sums become forces and are cleared; who was touched at the step before and is no more has none.
void ForceLaw::give_forces() {
    const auto fetch_nodes = [&](const std::vector<std::int32_t>& nodes, std::size_t t) {
        if (t >= nodes.size()) return;
        __builtin_prefetch(&node_sum_[std::size_t(nodes[t])], 1);
        __builtin_prefetch(&node_force_[3 * std::size_t(nodes[t])], 1);
    };
    constexpr std::size_t nodes_ahead = 24;
    for (std::uint32_t i : former_)
        if (contacts_of_[i] == 0)
            for (int axis = 0; axis < 3; ++axis) particle_force_[3 * std::size_t(i) + axis] = 0;
    for (std::uint32_t i : in_contact_) {
        for (int axis = 0; axis < 3; ++axis) {
            std::int64_t& sum = particle_sum_[3 * std::size_t(i) + axis];
            particle_force_[3 * std::size_t(i) + axis] = double(sum) * quantum_;
            sum = 0;
        }
        contacts_of_[i] = 0;
    }
    for (std::size_t t = 0; t < were_touched_count_; ++t) {
        fetch_nodes(were_touched_, t + nodes_ahead);
        if (const std::size_t node = std::size_t(were_touched_[t]);
            node_sum_[node].share == untouched)
            for (int axis = 0; axis < 3; ++axis) node_force_[3 * node + axis] = 0;
    }
    for (std::size_t t = 0; t < touched_count_; ++t) {
        fetch_nodes(touched_, t + nodes_ahead);
        const std::int32_t node = touched_[t];
        for (int axis = 0; axis < 3; ++axis)
            node_force_[3 * std::size_t(node) + axis] =
                double(node_sum_[node].force[axis]) * quantum_;
        node_sum_[node] = {};
    }
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
