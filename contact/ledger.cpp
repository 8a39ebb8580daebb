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
                  std::span<const double> on_particles, std::span<const double> on_nodes,
                  std::span<const std::int32_t> touched_nodes, const StepFigures& step) {
    step_ = step;
    energy_.relaxation += step.relaxation;
    force_.assign(on_particles.begin(), on_particles.end());
    v_.assign(active.v.begin(), active.v.end());
    nodes_.clear();
    for (std::int32_t node : touched_nodes)
        nodes_.push_back(
            {std::uint32_t(node), row_of(on_nodes, std::size_t(node)), surface.velocity(node)});
}

void Ledger::book(const std::vector<Contact>& contacts, std::span<const double> v_particles,
                  std::span<const std::int64_t> row_now, const Surface& surface) {
    const double kick = step_.kick;
    double particles = 0, nodes = 0;
    if (row_now.empty()) {
        for (std::size_t i = 0; i < force_.size(); ++i)
            particles += force_[i] * (v_[i] + v_particles[i]);
    } else {
        for (std::size_t i = 0; i < row_now.size() && 3 * i < force_.size(); ++i) {
            const Vec before = row_of(v_, i);
            const Vec after = row_now[i] < 0 ? before : row_of(v_particles, row_now[i]);
            particles += row_of(force_, i).dot(before + after);
        }
    }
    for (const KeptNode& kept : nodes_)
        nodes += kept.force.dot(kept.v + surface.velocity(std::int32_t(kept.node)));
    particles *= 0.5 * kick;
    nodes *= 0.5 * kick;
    energy_.work_particles += particles;
    energy_.work_surface += nodes;
    energy_.turnover += std::abs(particles) + std::abs(nodes);

    double penalty = 0, damping = 0, friction = 0;
    for (const Contact& contact : contacts) {
        const std::int64_t row = row_after(row_now, contact.particle);
        const Vec before = contact.slip - contact.closing * contact.normal;  // relative velocity
        Vec after = before;
        if (row >= 0) {
            const std::int32_t* q = surface.corners(contact.facet);
            after = row_of(v_particles, row);
            for (int a = 0; a < 4; ++a) after -= contact.weight[a] * surface.velocity(q[a]);
        }
        const double depth_after = contact.depth - step_.dt * contact.normal.dot(after);
        penalty += contact.stiffness * contact.depth * depth_after;
        const Vec sum = before + after;
        damping += contact.damping_force * contact.normal.dot(sum);
        friction += contact.friction.dot(sum);
    }
    energy_.penalty = 0.5 * penalty;
    energy_.damping -= 0.5 * kick * damping;
    energy_.friction -= 0.5 * kick * friction;
}

}  // namespace undertow::contact
