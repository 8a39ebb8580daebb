#pragma once
// What came in, what went out and what was lost, in the log and in the summary: nothing vanishes
// silently.

#include <string>
#include <vector>

#include "results/summary.hpp"
#include "sph_solver/fluid_system.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

/// Says in the log when a particle leaves sph.domain through a face for the first time, and when
/// one first got behind a wall. The summary has the sums.
class LossReport {
 public:
    void report(double t, const FluidSystem& fluid);
    void archive(Archive& a);

 private:
    std::size_t seen_ = 0;  // of FluidSystem::removed()
    bool said_[6] = {};     // by face
    bool said_put_back_ = false;
};

/// What there was at the start and what came in must be there at the end, have gone out or have
/// been removed, fluid by fluid. Buffers of openings are no part of it.
void add_budget(const std::vector<std::string>& names, const FluidSystem& fluid, Summary& summary);

/// The share of the whole that a model with planes of symmetry is, 1/2 for each: forces, masses and
/// energies are of this share. Nothing without such planes.
void add_model_share(const MirrorPlanes& mirror, Summary& summary);

/// Largest density deviation and, where it is more than 3 %, the sound speed that would keep it at
/// 1 %: rho/rho0 - 1 goes with 1/c0^2. Says so in the log as well. c0 [m/s].
void add_density_advice(double deviation, double c0, Summary& summary);

}  // namespace undertow::sph
