#pragma once
// Nodal state and the central-difference update.
//
//     v^{n+1/2} = v^{n-1/2} + a^n (dt^{n-1} + dt^n)/2        kick
//     x^{n+1}   = x^n + dt^n v^{n+1/2}                       drift      [Wang 2024, section 2.2]

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "case/case.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/simd.hpp"

namespace undertow {
class Archive;
}

namespace undertow::fem {

struct Nodes {
    NodeRows x0;               // [m] where displacements count from: the mesh, or after settling
    NodeRows x;                // [m] at n
    NodeRows v;                // [m/s] at n - 1/2
    NodeRows f;                // [N] external minus internal forces at n, without weight
    NodeRows inverse_mass;     // [1/kg] per direction; 0 where a support holds the node
    std::vector<double> mass;  // [kg] lumped; 0 of an immobile node, which has no element
    std::vector<double> weight_share;  // mass that gravity acts on over mass

    std::size_t size() const { return mass.size(); }
    void archive(Archive& a);
};

/// What one kick did, summed over the nodes.
struct KickReport {
    double kinetic = 0;         // [J] at n: 1/2 m v^{n-1/2} . v^{n+1/2}, the scheme's own invariant
    double damping_before = 0;  // [J] Rayleigh dissipation in the half step before n
    double damping_after = 0;   // [J] and in the half step after n
    double speed2 = 0;          // [m2/s2] largest

    KickReport& operator+=(const KickReport& other);
};

/// Where a kick stands in time, and the loads that act on every node alike.
struct Kick {
    double dt_before = 0;  // [s] dt^{n-1}; 0 at the first step: a half kick from the start
    double dt_after = 0;   // [s] dt^n
    Vec3 gravity{};        // [m/s2]
    double damping = 0;    // [1/s] Rayleigh alpha; taken at n as the mean of both velocities, so
                           // that it neither lags nor shortens the stable step
};

/// Undeformed nodes at rest; `mass` [kg] per node, and the mass [kg] that gravity acts on. Forces
/// are zero.
Nodes make_nodes(const Mesh& mesh, std::vector<double> mass,
                 const std::vector<double>& weight_mass);

KickReport kick(Nodes& nodes, const Kick& step, int threads);
/// Also clears the forces for the next step.
void drift(Nodes& nodes, double dt, int threads);

/// Both in one pass over memory, the same bits. Those of `later` (in rising order) are only kicked:
/// something else has a say in their velocity yet; drift(nodes, dt, later) follows.
KickReport kick_and_drift(Nodes& nodes, const Kick& step, std::span<const std::int32_t> later,
                          int threads);
void drift(Nodes& nodes, double dt, std::span<const std::int32_t> these);

}  // namespace undertow::fem
