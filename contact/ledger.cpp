#include "contact/ledger.hpp"

#include <algorithm>
#include <cmath>

#include "contact/facet_lanes.hpp"

namespace undertow::contact {

namespace {

Vec row_of(std::span<const double> values, std::size_t row) {
    return Vec::Map(&values[3 * row]);
}

std::int64_t row_after(const RowChanges& rows, std::uint32_t row) {
    return rows.none() ? std::int64_t(row) : rows.now[row];
}

std::int64_t row_before(const RowChanges& rows, std::uint32_t row) {
    return rows.none() ? std::int64_t(row) : rows.was[row];
}

double sum_of(const Lanes& lanes) {
    double sum = 0;
    for (int lane = 0; lane < lane_count; ++lane) sum += lanes[lane];
    return sum;
}

constexpr std::size_t books_ahead = 4;  // that many packs of eight hide the way to memory

// A contact goes on in one whose normal is within 45 degrees: two that are taken for one wall.
constexpr double same_wall = 0.70710678;

}  // namespace

double InterfaceEnergy::relative_residual() const {
    return turnover > 0 ? std::abs(residual()) / (0.5 * turnover) : 0;
}

double InterfaceEnergy::relative_numerical_loss() const {
    return turnover > 0 ? numerical_loss() / (0.5 * turnover) : 0;
}

void Ledger::keep(const Points& active, const Surface& surface,
                  std::span<const double> on_particles, std::span<const double> on_nodes,
                  std::span<const std::int32_t> touched_nodes, const StepFigures& step) {
    step_ = step;
    force_.assign(on_particles.begin(), on_particles.end());
    v_.assign(active.v.begin(), active.v.end());
    nodes_.resize((touched_nodes.size() + lane_count - 1) / lane_count);
    for (std::size_t p = 0; p < nodes_.size(); ++p) {
        KeptNodes& kept = nodes_[p];
        const std::size_t first = p * lane_count, last = touched_nodes.size() - 1;
        for (int lane = 0; lane < lane_count; ++lane)
            kept.node[lane] = touched_nodes[std::min(first + std::size_t(lane), last)];
        const LaneMask here =
            first_lanes(int(std::min<std::size_t>(lane_count, touched_nodes.size() - first)));
        const Lanes none = spread<Lanes>(0);
        kept.force = select(here, gather_three(on_nodes.data(), kept.node),
                            Three<Lanes>{none, none, none});
        kept.v = gather_three(surface.v().data(), kept.node);
    }
}

void Ledger::book(const ContactList& contacts, std::span<const double> v_particles,
                  const RowChanges& rows, const Surface& surface,
                  const ContactList& present) {
    book_work(v_particles, rows, surface);
    book_contacts(contacts, v_particles, rows, surface);
    book_changes(contacts, rows, present);
}

/// From forces and velocities alone.
void Ledger::book_work(std::span<const double> v_particles, const RowChanges& rows,
                       const Surface& surface) {
    Lanes of_particles = spread<Lanes>(0), of_nodes = of_particles;
    double particles = 0;
    if (rows.none()) {
        std::size_t i = 0;
        for (; i + lane_count <= force_.size(); i += lane_count)
            of_particles =
                of_particles + load(&force_[i]) * (load(&v_[i]) + load(&v_particles[i]));
        for (; i < force_.size(); ++i) particles += force_[i] * (v_[i] + v_particles[i]);
    } else {
        for (std::size_t i = 0; i < rows.now.size() && 3 * i < force_.size(); ++i) {
            const Vec before = row_of(v_, i);
            const Vec after = rows.now[i] < 0 ? before : row_of(v_particles, rows.now[i]);
            particles += row_of(force_, i).dot(before + after);
        }
    }
    for (const KeptNodes& kept : nodes_)
        of_nodes =
            of_nodes + dot(kept.force, kept.v + gather_three(surface.v().data(), kept.node));
    particles += sum_of(of_particles);
    double nodes = sum_of(of_nodes);
    particles *= 0.5 * step_.kick();
    nodes *= 0.5 * step_.kick();
    energy_.work_particles += particles;
    energy_.work_surface += nodes;
    energy_.turnover += std::abs(particles) + std::abs(nodes);
}

/// [m/s] velocities at n + 1/2 of the particles of kept contacts; who is gone keeps its own.
Three<Lanes> Ledger::velocity_after(const ContactPack& pack, std::span<const double> v_particles,
                                    const RowChanges& rows) const {
    if (rows.none()) return gather_three(v_particles.data(), pack.particle);
    Three<Lanes> after;
    for (int lane = 0; lane < lane_count; ++lane) {
        const std::uint32_t i = std::uint32_t(pack.particle[lane]);
        const std::int64_t row = row_after(rows, i);
        const Vec v = row >= 0 ? row_of(v_particles, std::size_t(row)) : row_of(v_, i);
        after.x[lane] = v[0], after.y[lane] = v[1], after.z[lane] = v[2];
    }
    return after;
}

/// What damping and friction took, and what the step itself did to the springs.
void Ledger::book_contacts(const ContactList& contacts, std::span<const double> v_particles,
                           const RowChanges& rows, const Surface& surface) {
    const double dt_change = step_.dt_before - step_.dt;
    const Lanes none = spread<Lanes>(0);
    Lanes damping = none, friction = none, uneven = none;
    ahead_.resize(contacts.packs() * lane_count);
    for (std::size_t p = 0; p < contacts.packs(); ++p) {
        const ContactPack& c = contacts.pack(p);
        fetch_pack(contacts, p + books_ahead);
        const LaneMask here = first_lanes(contacts.lanes(p));
        const Three<Lanes> before = c.slip - c.closing * c.normal;  // relative velocity
        const Three<Lanes> after = relative_velocity(velocity_after(c, v_particles, rows), surface,
                                                     c.node, c.weight);
        const Lanes w_after = -dot(c.normal, after), elastic = c.stiffness * c.depth;
        store(c.depth + step_.dt * w_after, &ahead_[p * lane_count]);
        uneven = uneven + select(here, elastic * (w_after - c.closing), none);
        damping = damping + select(here, c.damping_force * (w_after + c.closing), none);
        friction = friction + select(here, dot(c.friction(), before + after), none);
    }
    energy_.uneven += 0.25 * dt_change * sum_of(uneven);
    energy_.damping += 0.5 * step_.kick() * sum_of(damping);
    energy_.friction -= 0.5 * step_.kick() * sum_of(friction);
}

/// What is stored now, and what changed hands between the kept step and the present one.
void Ledger::book_changes(const ContactList& contacts, const RowChanges& rows,
                          const ContactList& present) {
    first_.assign(v_.size() / 3, -1);
    for (std::size_t c = contacts.size(); c-- > 0;) first_[contacts.particle(c)] = std::int32_t(c);
    follow_.assign(contacts.packs() * lane_count, -1);
    const Lanes none = spread<Lanes>(0);
    Lanes penalty = none, impact = none, turning = none, relaxation = none;
    for (std::size_t p = 0; p < present.packs(); ++p) {
        fetch_pack(present, p + books_ahead);
        fetch_pack(contacts, p + books_ahead);
        if (follow_pack(contacts, rows, present, p, penalty, turning, relaxation)) continue;
        for (int lane = 0; lane < present.lanes(p); ++lane)
            follow_one(contacts, rows, present, p, lane, penalty, impact, turning, relaxation);
    }
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        if (follow_[c] >= 0) continue;
        const ContactPack& pack = contacts.pack(c / lane_count);
        const int lane = int(c % lane_count);
        impact[lane] += pack.stiffness[lane] * pack.depth[lane] * ahead_[c];
    }
    energy_.penalty = 0.5 * sum_of(penalty);
    energy_.relaxation += 0.5 * sum_of(relaxation);
    energy_.impact += 0.5 * sum_of(impact);
    energy_.turning += 0.5 * sum_of(turning);
}

/// One present contact goes on from the kept one of its particle whose normal is nearest to its own.
void Ledger::follow_one(const ContactList& contacts, const RowChanges& rows,
                        const ContactList& present, std::size_t p, int lane, Lanes& penalty,
                        Lanes& impact, Lanes& turning, Lanes& relaxation) {
    const std::size_t place = p * lane_count + std::size_t(lane);
    const Contact now = present[place];
    const double behind = now.depth - step_.dt * now.closing;  // d-
    penalty[lane] += now.stiffness * now.depth * behind;
    const std::int64_t row = row_before(rows, now.particle);
    std::int32_t found = -1;
    double most = same_wall;
    for (std::int32_t c = row < 0 ? -1 : first_[std::size_t(row)];
         c >= 0 && c < std::int32_t(contacts.size()) &&
         contacts.particle(std::size_t(c)) == std::size_t(row);
         ++c) {
        const double aligned = contacts[std::size_t(c)].normal.dot(now.normal);
        if (follow_[std::size_t(c)] >= 0 || aligned <= most) continue;
        most = aligned;
        found = c;
    }
    if (found < 0) {
        impact[lane] -= now.stiffness * now.depth * behind;
        return;
    }
    const Contact was = contacts[std::size_t(found)];
    follow_[std::size_t(found)] = std::int32_t(place);
    relaxation[lane] += (was.stiffness - now.stiffness) * was.depth * now.depth;
    turning[lane] += was.stiffness * was.depth * (ahead_[std::size_t(found)] - now.depth) +
                     now.stiffness * now.depth * (was.depth - behind);
}

/// The same for eight at once, if each of their particles had one contact and has one. False, and
/// nothing done, if not.
bool Ledger::follow_pack(const ContactList& contacts, const RowChanges& rows,
                         const ContactList& present, std::size_t p, Lanes& penalty, Lanes& turning,
                         Lanes& relaxation) {
    if (!rows.none() || present.lanes(p) < lane_count) return false;
    const ContactPack& now = present.pack(p);
    const std::size_t first = p * lane_count;
    if (first > 0 && std::int32_t(present.particle(first - 1)) == now.particle[0]) return false;
    if (first + lane_count < present.size() &&
        std::int32_t(present.particle(first + lane_count)) == now.particle[lane_count - 1])
        return false;
    LaneRows was = gather_rows(first_.data(), now.particle);
    for (int lane = 0; lane < lane_count; ++lane) {
        if (lane > 0 && now.particle[lane] == now.particle[lane - 1]) return false;
        const std::int32_t c = was[lane];
        if (c < 0 || (std::size_t(c) + 1 < contacts.size() &&
                      std::int32_t(contacts.particle(std::size_t(c) + 1)) == now.particle[lane]))
            return false;
    }
    // A field of contact c lies at c % 8 of its pack.
    constexpr std::int32_t pack_size = sizeof(ContactPack) / sizeof(double);
    const LaneRows at = (was >> 3) * pack_size + (was & 7);
    const ContactPack& base = contacts.pack(0);
    const auto field = [&](const Lanes& of_first) {
        return gather(reinterpret_cast<const double*>(&of_first), at);
    };
    const Lanes aligned = field(base.normal.x) * now.normal.x +
                          field(base.normal.y) * now.normal.y + field(base.normal.z) * now.normal.z;
    if (any(at_most(aligned, spread<Lanes>(same_wall)))) return false;

    const Lanes behind = now.depth - step_.dt * now.closing;  // d-
    const Lanes stiffness = field(base.stiffness), depth = field(base.depth),
                elastic = now.stiffness * now.depth;
    penalty = penalty + elastic * behind;
    relaxation = relaxation + (stiffness - now.stiffness) * depth * now.depth;
    turning = turning + stiffness * depth * (gather(ahead_.data(), was) - now.depth) +
              elastic * (depth - behind);
    for (int lane = 0; lane < lane_count; ++lane)
        follow_[std::size_t(was[lane])] = std::int32_t(first) + lane;
    return true;
}

}  // namespace undertow::contact
