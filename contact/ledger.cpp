#include "contact/ledger.hpp"

#include <algorithm>
#include <cmath>

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
    nodes_.clear();
    for (std::int32_t node : touched_nodes)
        nodes_.push_back(
            {std::uint32_t(node), row_of(on_nodes, std::size_t(node)), surface.velocity(node)});
}

void Ledger::book(const std::vector<Contact>& contacts, std::span<const double> v_particles,
                  const RowChanges& rows, const Surface& surface,
                  const std::vector<Contact>& present) {
    book_work(v_particles, rows, surface);
    book_contacts(contacts, v_particles, rows, surface);
    book_changes(contacts, rows, present);
}

/// From forces and velocities alone.
void Ledger::book_work(std::span<const double> v_particles, const RowChanges& rows,
                       const Surface& surface) {
    double particles = 0, nodes = 0;
    if (rows.none()) {
        for (std::size_t i = 0; i < force_.size(); ++i)
            particles += force_[i] * (v_[i] + v_particles[i]);
    } else {
        for (std::size_t i = 0; i < rows.now.size() && 3 * i < force_.size(); ++i) {
            const Vec before = row_of(v_, i);
            const Vec after = rows.now[i] < 0 ? before : row_of(v_particles, rows.now[i]);
            particles += row_of(force_, i).dot(before + after);
        }
    }
    for (const KeptNode& kept : nodes_)
        nodes += kept.force.dot(kept.v + surface.velocity(std::int32_t(kept.node)));
    particles *= 0.5 * step_.kick();
    nodes *= 0.5 * step_.kick();
    energy_.work_particles += particles;
    energy_.work_surface += nodes;
    energy_.turnover += std::abs(particles) + std::abs(nodes);
}

/// What damping and friction took, and what the step itself did to the springs.
void Ledger::book_contacts(const std::vector<Contact>& contacts,
                           std::span<const double> v_particles, const RowChanges& rows,
                           const Surface& surface) {
    const double dt_change = step_.dt_before - step_.dt;
    double damping = 0, friction = 0, uneven = 0;
    ahead_.clear();
    for (const Contact& contact : contacts) {
        const std::int64_t row = row_after(rows, contact.particle);
        const Vec before = contact.slip - contact.closing * contact.normal;  // relative velocity
        const std::int32_t* q = surface.corners(contact.facet);
        Vec after = row >= 0 ? row_of(v_particles, row) : row_of(v_, contact.particle);
        for (int a = 0; a < 4; ++a) after -= contact.weight[a] * surface.velocity(q[a]);
        const double w_after = -contact.normal.dot(after),
                     elastic = contact.stiffness * contact.depth;
        ahead_.push_back(contact.depth + step_.dt * w_after);
        uneven += elastic * (w_after - contact.closing);
        damping += contact.damping_force * (w_after + contact.closing);
        friction += contact.friction.dot(before + after);
    }
    energy_.uneven += 0.25 * dt_change * uneven;
    energy_.damping += 0.5 * step_.kick() * damping;
    energy_.friction -= 0.5 * step_.kick() * friction;
}

/// What is stored now, and what changed hands between the kept step and the present one.
void Ledger::book_changes(const std::vector<Contact>& contacts, const RowChanges& rows,
                          const std::vector<Contact>& present) {
    first_.assign(v_.size() / 3, -1);
    for (std::size_t c = contacts.size(); c-- > 0;) first_[contacts[c].particle] = std::int32_t(c);
    follow_.assign(contacts.size(), -1);
    double penalty = 0, impact = 0, turning = 0;
    for (std::size_t p = 0; p < present.size(); ++p) {
        const Contact& now = present[p];
        const double behind = now.depth - step_.dt * now.closing;  // d-
        penalty += now.stiffness * now.depth * behind;
        const std::int64_t row = row_before(rows, now.particle);
        std::int32_t found = -1;
        double most = same_wall;
        for (std::int32_t c = row < 0 ? -1 : first_[row];
             c >= 0 && c < std::int32_t(contacts.size()) && contacts[c].particle == row; ++c) {
            const double aligned = contacts[c].normal.dot(now.normal);
            if (follow_[c] >= 0 || aligned <= most) continue;
            most = aligned;
            found = c;
        }
        if (found < 0) {
            impact -= now.stiffness * now.depth * behind;
            continue;
        }
        const Contact& was = contacts[found];
        follow_[found] = std::int32_t(p);
        energy_.relaxation += 0.5 * (was.stiffness - now.stiffness) * was.depth * now.depth;
        turning += was.stiffness * was.depth * (ahead_[found] - now.depth) +
                   now.stiffness * now.depth * (was.depth - behind);
    }
    for (std::size_t c = 0; c < contacts.size(); ++c)
        if (follow_[c] < 0) impact += contacts[c].stiffness * contacts[c].depth * ahead_[c];
    energy_.penalty = 0.5 * penalty;
    energy_.impact += 0.5 * impact;
    energy_.turning += 0.5 * turning;
}

}  // namespace undertow::contact
