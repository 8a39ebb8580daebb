#pragma once
// The viscous part of a step, taken implicitly (backward Euler): the step is the acoustic one
// however large the viscosity is.
//   m_i (u_i - u_i*)/k + (K u)_i = 0,   u* = v^{n-1/2} + k (a + f + g),  k = (dt^{n-1} + dt^n)/2
// with K of viscous_operator.hpp, by conjugate gradients with the diagonal as preconditioner,
// started from the velocity and its change in the step before. It ends when what is not balanced,
// as a velocity r/m, is `tolerance` in the rms over all particles of
//   sqrt[(k a)^2 + D/m],   a the mean acceleration, D = k u.K u what friction dissipates in a step,
// which for mu alone is gd sqrt(k mu/rho), the shear rate times the way momentum diffuses in a
// step.
//
// What is left is carried into the next step, r/m is added to its u*: momentum is conserved but for
// what is on its way, which never adds up. It does not move the particles. Put into their
// velocities (v = u + r/m, the explicit formula with the stress of u) it is a rough motion: K
// magnifies it k lambda times, a yield-stress fluid takes it for a shear rate and yields, and a
// tolerance measured by a start that contains it allows the next step to leave more. In u it is
// r/(k lambda m), and a tolerance measured by D, which grows as sqrt(k lambda), allows ever less:
// it cannot feed itself.

#include <variant>
#include <vector>

#include "sph_solver/physics/viscous_operator.hpp"

namespace undertow::sph {

/// Counts of a run.
struct ImplicitFigures {
    std::int64_t steps = 0, iterations = 0;
    int most_iterations = 0;
    std::int64_t not_converged = 0;  // steps that left more than the tolerance, at the limit of
                                     // iterations or of what the precision knows: warned of
    double worst_residual = 0;       // of those: over the tolerance
};

/// The update and what it keeps from step to step, in the precision Real of sph.precision.
template <class Real>
class ImplicitUpdate {
 public:
    ImplicitUpdate(double tolerance, int most_iterations)
        : tolerance_(tolerance), most_iterations_(most_iterations) {}

    void solve(const PairPhysics& physics, const Neighborhood& neighbors,
               const MirrorPlanes& mirror, const NoSlipImages& no_slip, const Bodies& bodies,
               double kick, const Vec3& gravity, std::size_t identities, Particles& particles);
    void archive(Archive& a);

    const ImplicitFigures& figures() const { return figures_; }
    int most_iterations() const { return most_iterations_; }
    Vec3 left(std::int64_t id) const {
        const Real* v = before_[id].left;
        return {v[0], v[1], v[2]};
    }

 private:
    // of a residual: the precision knows no more of it
    static constexpr double known_digits = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;

    template <class Body>
    double sum_over_particles(int n, Body&& body);

    double tolerance_;
    int most_iterations_;
    ViscousOperator<Real> operator_;
    struct Before {                // of the step before
        Real a[3] = {0, 0, 0};     // its acceleration [m/s2]
        Real left[3] = {0, 0, 0};  // r/m [m/s]
    };
    std::vector<Before> before_;  // [identities]
    Field3<Real> guess_, change_, residual_, direction_, image_;
    std::vector<Real> diagonal_;
    std::vector<double> part_;
    ImplicitFigures figures_;
};

class ImplicitViscosity {
 public:
    explicit ImplicitViscosity(double tolerance, Precision precision = Precision::float32,
                               int most_iterations = 300)
        : update_(ImplicitUpdate<float>(tolerance, most_iterations)) {
        if (precision == Precision::float64)
            update_ = ImplicitUpdate<double>(tolerance, most_iterations);
    }

    /// Adds the viscous acceleration to particles.ax, ay, az (pressure forces without it). kick: k
    /// [s]. Records must show v^{n-1/2}. particles: to be counted by identities below `identities`.
    void solve(const PairPhysics& physics, const Neighborhood& neighbors,
               const MirrorPlanes& mirror, const NoSlipImages& no_slip, const Bodies& bodies,
               double kick, const Vec3& gravity, std::size_t identities, Particles& particles) {
        std::visit(
            [&](auto& update) {
                update.solve(physics, neighbors, mirror, no_slip, bodies, kick, gravity, identities,
                             particles);
            },
            update_);
    }

    void archive(Archive& a) {
        std::visit([&](auto& update) { update.archive(a); }, update_);
    }
    const ImplicitFigures& figures() const {
        return std::visit([](const auto& u) -> const ImplicitFigures& { return u.figures(); },
                          update_);
    }
    int most_iterations() const {
        return std::visit([](const auto& u) { return u.most_iterations(); }, update_);
    }
    /// What the last step left of a particle, by identity: r/m [m/s].
    Vec3 left(std::int64_t id) const {
        return std::visit([id](const auto& u) { return u.left(id); }, update_);
    }

 private:
    std::variant<ImplicitUpdate<float>, ImplicitUpdate<double>> update_;
};

}  // namespace undertow::sph
