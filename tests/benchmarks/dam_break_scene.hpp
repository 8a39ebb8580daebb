#pragma once
// The developed dam break on which the SPH solver's speed is measured: the case cases/dam_break
// with its rigid wall (kernel, diffusion, no-slip planes, gate as it has them), taken at t* = t
// sqrt(g/H) of 1, 1.7 and 2.4, when the front runs out and the particles have long left their
// lattice.

#include <vector>

#include "case/case.hpp"
#include "sph_solver/fluid_system.hpp"

namespace undertow::benchmarks {

struct Snapshot {
    double t = 0;  // [s]
    std::vector<double> x, y, z, vx, vy, vz, drho;
};

/// The case with the given spacing [m] and further "key=value" overrides.
Case dam_break(double spacing, const std::vector<std::string>& set = {});

/// Runs it with two passes and keeps its state at the times [t*].
std::vector<Snapshot> develop(const Case& input, const std::vector<double>& t_star);

/// A tank as wide as `copies` of it: the same flow with so many times its particles, every second
/// copy mirrored, so that it goes on smoothly across where a side wall was.
Snapshot side_by_side(const Snapshot& one, int copies);
Case widened(Case one, int copies);

/// Puts a state into a solver whose case holds as many particles.
void load(const Snapshot& state, sph::FluidSystem& fluid);

/// One step as solver.cpp takes it, without output and link. Sizes of this and earlier steps [s].
struct Steps {
    double t = 0, dt = 0, before = 0, before_that = 0;
};
sph::Health take_step(sph::FluidSystem& fluid, Steps& steps, bool two_pass);

/// Stable step of a pass kind with the case's own margins [s].
double step_size(const Case& input, const sph::FluidSystem& fluid, const sph::Health& health,
                 bool two_pass);

}  // namespace undertow::benchmarks
