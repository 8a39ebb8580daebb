#include "contact/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::contact {

namespace {

Vec row_of(std::span<const double> values, std::size_t row) {
    return Vec::Map(&values[3 * row]);
}

std::int64_t row_after(std::span<const std::int64_t> row_now, std::uint32_t row) {
    return row_now.empty() ? std::int64_t(row) : row_now[row];
}

}  // namespace

double InterfaceEnergy::relative_residual() const {
    return turnover > 0 ? std::abs(residual()) / (0.5 * turnover) : 0;
}

void Ledger::keep(const Points& active, const Surface& surface,
                  const std::vector<Contact>& contacts, std::span<const double> on_particles,
                  std::span<const double> on_nodes, const StepFigures& step) {
    step_ = step;
    contacts_.assign(contacts.begin(), contacts.end());
    corners_.clear();
    particles_.clear();
    nodes_.clear();
    seen_.resize(surface.nodes(), 0);
    ++stamp_;
    energy_.relaxation += step.relaxation;
    for (const Contact& contact : contacts) {
        if (particles_.empty() || particles_.back().row != contact.particle)
            particles_.push_back({contact.particle, row_of(on_particles, contact.particle),
                                  row_of(active.v, contact.particle)});
        const std::int32_t* q = surface.corners(contact.facet);
        corners_.push_back({q[0], q[1], q[2], q[3]});
        for (int a = 0; a < 4; ++a) {
            if (seen_[q[a]] == stamp_) continue;
            seen_[q[a]] = stamp_;
            nodes_.push_back({std::uint32_t(q[a]), row_of(on_nodes, q[a]), surface.velocity(q[a])});
        }
    }
}

void Ledger::book(std::span<const double> v_particles, std::span<const std::int64_t> row_now,
                  std::span<const double> v_nodes) {
    const double kick = step_.kick;
    double particles = 0, nodes = 0;
    for (const Kept& kept : particles_) {
        const std::int64_t row = row_after(row_now, kept.row);
        const Vec v_after = row < 0 ? kept.v : row_of(v_particles, row);
        particles += 0.5 * kick * kept.force.dot(kept.v + v_after);
    }
    for (const Kept& kept : nodes_)
        nodes += 0.5 * kick * kept.force.dot(kept.v + row_of(v_nodes, kept.row));
    energy_.work_particles += particles;
    energy_.work_surface += nodes;
    energy_.turnover += std::abs(particles) + std::abs(nodes);

    energy_.penalty = 0;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const Contact& contact = contacts_[c];
        const std::int64_t row = row_after(row_now, contact.particle);
        const Vec before = contact.slip - contact.closing * contact.normal;  // relative velocity
        Vec after = before;
        if (row >= 0) {
            after = row_of(v_particles, row);
            for (int a = 0; a < 4; ++a)
                after -= contact.weight[a] * row_of(v_nodes, corners_[c][a]);
        }
        const double depth_after = contact.depth - step_.dt * contact.normal.dot(after);
        energy_.penalty += 0.5 * contact.stiffness * contact.depth * depth_after;
        const Vec mean = 0.5 * (before + after);
        energy_.damping -= kick * contact.damping_force * contact.normal.dot(mean);
        energy_.friction -= kick * contact.friction.dot(mean);
    }
    particles_.clear();
    nodes_.clear();
    contacts_.clear();
}

}  // namespace undertow::contact
