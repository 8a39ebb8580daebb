#include "fem_solver/implicit/implicit_parts.hpp"

#include <algorithm>
#include <cmath>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow::fem {
namespace {

// 4 kappa'/dt^2 - 1 at the largest step a factor serves. It keeps the fastest modes off the Nyquist
// frequency, where every small change of K pumps energy into them (as cfl = 0.9 does for explicit
// elements), and bears turns of the elements since the assembly, their stiffening under compression
// and the lagged bulk viscosity (xi^2 of it). It slows a mode by another (omega dt)^2/32.
constexpr double margin = 0.25;
constexpr int kicks_between_looks = 8;
// A step that outgrows its factor will do so again: room for that. A first factor has none, so that
// a run at a constant step pays nothing for it.
constexpr double room_to_grow = 1.1;
// A step this much below the factor's, so often in a row, is worth a factor of its own: modes move
// as slowly as the factor's step makes them.
constexpr double small_step = 0.8;
constexpr int small_steps_in_a_row = 256;

std::vector<std::int32_t> implicit_elements(const Model& model) {
    std::vector<std::int32_t> elements;
    for (const Part& part : model.parts)
        if (part.implicit)
            elements.insert(elements.end(), part.elements.begin(), part.elements.end());
    return elements;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

}  // namespace

ImplicitParts::ImplicitParts(const Model& model, const Hexahedra& elements, const Nodes& nodes)
    : stiffness_(model.mesh, implicit_elements(model), nodes),
      factor_(stiffness_.matrix()),
      bodies_(stiffness_.matrix(), nodes),
      shape_(model.mesh, implicit_elements(model), bodies_),
      damping_(model.implicit_damping),
      v_before_(unknowns()),
      k_v_(unknowns()),
      a_(unknowns()),
      scratch_(unknowns()) {
    for (std::int32_t n : stiffness_.matrix().node) mass_.push_back(nodes.mass[n]);
    omega_elements_ = std::sqrt(elements.stiffest().value);
    stress_stiffness_ = elements.largest_stress_stiffness();
}

double ImplicitParts::tolerated_change(double dt) const {
    const double m = 4 * (kappa_ - 0.5 * damping_ * dt_factored_ * dt) / (dt * dt) - 1;
    return 2 / (omega_elements_ * dt) * std::sqrt(m / (1 + m));
}

/// Factors anew when the step has outgrown kappa (or stays far below it) or elements have changed
/// their shape.
void ImplicitParts::follow(const Hexahedra& elements, const Nodes& nodes, double dt) {
    const bool first = kappa_ == 0, outgrown = dt > dt_factored_ * (1 + 1e-12);
    small_steps_ = dt < small_step * dt_factored_ ? small_steps_ + 1 : 0;
    const bool new_step = outgrown || small_steps_ == small_steps_in_a_row;
    const double kappa_before = kappa_;
    if (new_step) {
        if (outgrown && !first) stretched_ = true;
        dt_factored_ = stretched_ ? room_to_grow * dt : dt;
        kappa_ = (0.25 * (1 + margin) + 0.5 * damping_) * dt_factored_ * dt_factored_;
        small_steps_ = 0;
    }
    bool new_shape = first;
    if (kicks_++ % kicks_between_looks == 0 && !first) {
        omega_elements_ = std::sqrt(elements.stiffest().value);
        stress_stiffness_ = elements.largest_stress_stiffness();
        new_shape = shape_.largest_change(nodes.x, bodies_) > tolerated_change(dt);
    }
    if (!new_shape && !new_step) return;

    const auto added_energy = [&](double kappa) {
        stiffness_times(v_before_, k_v_);
        return 0.5 * kappa * dot(v_before_, k_v_);
    };
    const double before = first ? 0 : added_energy(kappa_before);
    if (new_shape) {
        stiffness_.assemble(elements, nodes);
        shape_.accept(nodes.x);
        bodies_.accept(nodes.x);
        ++assemblies_;
    }
    if (!factor_.factorize(stiffness_.matrix(), mass_, kappa_))
        throw PhysicsError(
            "the matrix M + kappa K of the implicit parts, kappa = " + number_text(kappa_, 4) +
            " s2, is not positive definite: an element has inverted or holds values "
            "that are not finite; look at the last field output.");
    ++factorizations_;
    change_work_ += added_energy(kappa_) - before;
}

void ImplicitParts::before_kick(const Hexahedra& elements, Nodes& nodes, const Kick& step) {
    const double dt = std::max(step.dt_before, step.dt_after);
    if (dt == 0) return;  // nothing moves
    gather(nodes.v, v_before_);
    if (kappa_ > 0) bodies_.find(nodes.x);
    follow(elements, nodes, dt);
    stiffness_times(v_before_, k_v_);
    const double c = damping_ * dt_factored_;
    const std::vector<std::int32_t>& node = stiffness_.matrix().node;
    for (std::size_t i = 0; i < node.size(); ++i) {
        const std::int32_t n = node[i];
        for (int d = 0; d < 3; ++d)
            a_[3 * i + d] = nodes.inverse_mass[n].c[d] == 0
                                ? 0
                                : nodes.f[n].c[d] - c * k_v_[3 * i + d] +
                                      mass_[i] * nodes.weight_share[n] * step.gravity[d];
    }
    bodies_.turn_back(a_);
    factor_.solve(a_);
    bodies_.turn(a_);
    for (std::size_t i = 0; i < node.size(); ++i) {
        const std::int32_t n = node[i];
        for (int d = 0; d < 3; ++d)
            if (nodes.inverse_mass[n].c[d] > 0)
                nodes.f[n].c[d] =
                    mass_[i] * (a_[3 * i + d] - nodes.weight_share[n] * step.gravity[d]);
    }
}

void ImplicitParts::after_kick(const Nodes& nodes, const Kick& step, KickReport& report) {
    if (kappa_ == 0) return;
    gather(nodes.v, a_);  // v^{n+1/2}
    const double before = dot(k_v_, v_before_), across = dot(k_v_, a_);
    // work of a force that acts for the span of the kick: what it takes from the kinetic energy
    const double share = 0.25 * damping_ * dt_factored_ * (step.dt_before + step.dt_after);
    energy_ = 0.5 * kappa_ * across;
    damping_work_ += damping_ahead_ + share * before;
    damping_ahead_ = share * across;
    if (step.damping == 0) return;
    stiffness_times(a_, k_v_);
    const double quarter = 0.25 * step.damping * kappa_;
    report.damping_before += quarter * step.dt_before * (before + across);
    report.damping_after += quarter * step.dt_after * (across + dot(k_v_, a_));
}

double ImplicitParts::largest_step(double cfl) const {
    return stress_stiffness_ > 0 ? 2 * cfl / (omega_elements_ * std::sqrt(stress_stiffness_)) : 1e9;
}

void ImplicitParts::gather(const NodeRows& rows, std::vector<double>& out) const {
    const std::vector<std::int32_t>& node = stiffness_.matrix().node;
    for (std::size_t i = 0; i < node.size(); ++i)
        for (int d = 0; d < 3; ++d) out[3 * i + d] = rows[node[i]].c[d];
}

/// out = R K R^T a
void ImplicitParts::stiffness_times(const std::vector<double>& a, std::vector<double>& out) {
    scratch_ = a;
    bodies_.turn_back(scratch_);
    stiffness_.matrix().multiply(scratch_, out);
    bodies_.turn(out);
}

}  // namespace undertow::fem
