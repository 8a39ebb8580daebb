#pragma once
// The viscous part of a step, taken implicitly (backward Euler): the step is the acoustic one
// however large the viscosity is.
//   m_i (u_i - u_i*)/k + (K u)_i = 0,   u* = v^{n-1/2} + k (a + f + g),  k = (dt^{n-1} + dt^n)/2
// with K of viscous_operator.hpp, by conjugate gradients with the diagonal as preconditioner,
// started from the velocity change of the step before. It ends when the force that is not balanced,
// as an acceleration r/(m k), is `tolerance` of the mean acceleration in the rms over all
// particles. What is left is not thrown away: v = u + r/m is v = u* - k K u/m, the explicit formula
// with the stress of u, so that momentum is conserved to round-off whatever the tolerance.

#include <vector>

#include "sph_solver/physics/viscous_operator.hpp"

namespace undertow::sph {

/// Counts of a run.
struct ImplicitFigures {
    std::int64_t steps = 0, iterations = 0;
    int most_iterations = 0;
    std::int64_t not_converged = 0;  // steps that reached the limit of iterations
    double worst_residual = 0;       // of those: over the tolerance
};

class ImplicitViscosity {
 public:
    explicit ImplicitViscosity(double tolerance) : tolerance_(tolerance) {}

    /// Adds the viscous acceleration to particles.ax, ay, az (pressure forces without it). kick: k
    /// [s]. Records must show v^{n-1/2}. particles: to be counted by identities below `identities`.
    void solve(const PairPhysics& physics, const Neighborhood& neighbors,
               const MirrorPlanes& mirror, const NoSlipImages& no_slip, const Bodies& bodies,
               double kick, const Vec3& gravity, std::size_t identities, Particles& particles);

    const ImplicitFigures& figures() const { return figures_; }

 private:
    static constexpr int most_iterations = 300;  // float32 stalls before more of them help

    template <class Body>
    double sum_over_particles(int n, Body&& body);

    double tolerance_;
    ViscousOperator operator_;
    std::vector<float> before_;  // acceleration of the step before [m/s2], [identities][3]
    Field3 guess_, change_, residual_, direction_, image_;
    std::vector<float> diagonal_;
    std::vector<double> part_;
    ImplicitFigures figures_;
};

}  // namespace undertow::sph
