#pragma once
// Stiff, nearly linear parts at a step far beyond their own: linearly implicit leapfrog.
//
//     (M + kappa K) a^n = f_ext + f_contact - f_int(x^n) - c K v^{n-1/2}                        [N]
//     kappa = (1 + margin)/4 dt^2 + c dt/2,   c = damping dt
//
// with M the lumped mass of every element on the node and K the stiffness of the implicit parts.
// The loop stays that of central difference: forces at x^n, kick, drift. With the damping at the
// mean velocity of n (that is what c dt/2 in kappa does), what is stable is
//
//     4 (M + kappa' K) - dt^2 (K + K_e + K_c) = 4 M - dt^2 (K_e + K_c) + (4 kappa' - dt^2) K > 0
//
// kappa' = kappa - c dt/2, K_e the stiffness of explicit elements, K_c that of contact. For
// 4 kappa' >= dt^2 the implicit parts drop out: explicit elements and contact see the lumped mass M
// and their ordinary limits, and a node of implicit elements alone leaves contact the whole
// budget 4. A mode omega moves as if its frequency were omega_s,  sin(omega_s dt/2) = (omega
// dt/2)/sqrt(1 + kappa' omega^2), slower by kappa' omega^2/2 - (omega dt)^2/24 for small omega dt,
// with a damping ratio of damping omega dt/2.   [Stern and Grinspun 2009, implicit-explicit
// variational integrators: there with Newmark's kappa = dt^2/4]
//
// Damping: modes far beyond the step all swing at nearly the Nyquist frequency, where a step that
// varies pumps energy into them, as it does in explicit elements near their limit.
//
// K belongs to a shape. It turns with its body (TurningBodies); when elements turn by theta beyond
// that, K and their true tangent differ: K - K_t >= -(1 + 1/margin) theta^2 K_t, which M must bear.
// So K is assembled and factored anew when any element has turned or strained by more than
//     theta = (2/(omega_e dt)) sqrt(margin/(1 + margin)),
// omega_e the elements' bound. With dt it is different: a factor serves every smaller step (margin
// grows, kappa stays, and modes are as slow as before), so that a step that jitters costs nothing.
//
// Tension stiffens beyond K; the largest stress limits the step (largest_step()), far beyond the
// elements' own.

#include <cstdint>
#include <vector>

#include "fem_solver/implicit/inertia_factor.hpp"
#include "fem_solver/implicit/shape_watch.hpp"
#include "fem_solver/implicit/stiffness_matrix.hpp"
#include "fem_solver/implicit/turning_bodies.hpp"
#include "fem_solver/nodes.hpp"
#include "fem_solver/setup/model.hpp"

namespace undertow::fem {

class ImplicitParts {
 public:
    /// `elements` is the group of the model's implicit parts (at least one). Supports are in
    /// `nodes`.
    ImplicitParts(const Model& model, const Hexahedra& elements, const Nodes& nodes);

    /// After all forces at n are in: replaces them on free directions by what accelerates the
    /// lumped mass like M + kappa K, so that the kick is the ordinary one. Assembles and factors
    /// when shape or step ask for it. PhysicsError if the matrix is not positive definite.
    void before_kick(const Hexahedra& elements, Nodes& nodes, const Kick& step);
    /// Books energies, and Rayleigh damping, which acts on M + kappa K (each mode decays at
    /// alpha/2).
    void after_kick(const Nodes& nodes, const Kick& step, KickReport& report);

    /// [s] of the tension in the parts: 2 cfl/(omega_e sqrt(sigma/(lambda + 2 mu))).
    double largest_step(double cfl) const;
    /// [J] at n, after the kick: 1/2 kappa v^{n-1/2} . K v^{n+1/2}, the energy of the added
    /// inertia.
    double energy() const { return energy_; }
    double damping_work() const { return damping_work_; }  // [J] dissipated by c K v
    /// [J] that came in with new factors: 1/2 v . (kappa K)_new v - 1/2 v . (kappa K)_old v.
    double change_work() const { return change_work_; }
    void count_from_here() { change_work_ = damping_work_ = damping_ahead_ = 0; }

    std::size_t unknowns() const { return 3 * stiffness_.matrix().rows(); }
    std::int64_t nonzeros() const { return factor_.nonzeros(); }  // of the factor
    std::int64_t factorizations() const { return factorizations_; }
    std::int64_t assemblies() const { return assemblies_; }
    double explicit_step() const { return 2 / omega_elements_; }  // [s] by the bound, at cfl = 1
    void archive(Archive& a);

 private:
    void follow(const Hexahedra& elements, const Nodes& nodes, double dt);
    double tolerated_change(double dt) const;
    void gather(const NodeRows& rows, std::vector<double>& out) const;
    void stiffness_times(const std::vector<double>& a, std::vector<double>& out);

    StiffnessMatrix stiffness_;
    InertiaFactor factor_;
    TurningBodies bodies_;
    ShapeWatch shape_;
    double damping_ = 0;        // c/dt
    std::vector<double> mass_;  // [kg] per row of blocks
    double kappa_ = 0;          // [s2] 0: not factored yet
    double dt_factored_ = 0;    // [s] largest step that kappa serves
    bool stretched_ = false;    // whether the step has outgrown a factor before
    int small_steps_ = 0;       // in a row
    std::int64_t kicks_ = 0, factorizations_ = 0, assemblies_ = 0;
    double omega_elements_ = 0;                    // [1/s] largest bound of the parts' elements
    double stress_stiffness_ = 0;                  // largest sigma/(lambda + 2 mu)
    double change_work_ = 0, energy_ = 0;          // [J]
    double damping_work_ = 0, damping_ahead_ = 0;  // [J] up to n, and of the half step after it
    std::vector<double> v_before_, k_v_, a_, scratch_;  // (unknowns)
};

}  // namespace undertow::fem
