#pragma once
// What the SPH solver writes: fields, gauges, wall forces, energies, summary.

#include <memory>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "checkpoint/checkpoint_figures.hpp"
#include "results/field_file.hpp"
#include "results/history.hpp"
#include "results/summary.hpp"
#include "sph_solver/fluid_system.hpp"
#include "sph_solver/gauge_files.hpp"
#include "sph_solver/losses.hpp"

namespace undertow::sph {

/// Wall time by activity [s], and counts of a run.
struct RunFigures {
    double neighbors = 0, pack = 0, sums = 0, viscosity = 0, contact_wait = 0, move = 0, output = 0;   // [s]
    double wall = 0;                                   // [s]
    std::int64_t steps = 0, two_pass_steps = 0;
    double particle_steps = 0;
    double dt_min = 1e300, dt_sum = 0;                 // [s]
    double max_compression = 0, max_speed = 0;         // [-], [m/s]
    CheckpointFigures checkpoints;

    void archive(Archive& a);
};

class Recorder {
 public:
    Recorder(const Case& input, const std::string& folder, bool alone,
             FileStart start = FileStart::fresh);

    /// Gauges, forces and energies if one is due at t. The records must show the state at t.
    void observe(double t, const FluidSystem& fluid);
    /// Particle fields at t.
    void write_fields(double t, const FluidSystem& fluid);
    void write_summary(const RunFigures& figures, const FluidSystem& fluid, int threads,
                       const std::string& ended);
    void flush();
    void archive(Archive& a, double t);  // t [s]: now
    /// Magnitude of the latest force on the walls [N]; < 0 before the first.
    double wall_force() const { return wall_force_; }
    double last_fields() const { return last_fields_; }   // time of those written last [s]; < 0: none

 private:
    struct EnergySums {   // without the masses
        double kinetic = 0, potential = 0, elastic = 0;
    };
    void write_energies(double t, const FluidSystem& fluid);
    void write_wall_forces(double t, const FluidSystem& fluid);

    std::string folder_;
    bool alone_;
    HistoryTimes row_times_;
    GaugeFiles gauges_;
    ParticleFile fields_;
    std::vector<std::string> names_;   // of the fluids
    std::unique_ptr<History> force_file_;
    History energy_file_;
    std::vector<std::string> walls_;   // planes, then bodies
    std::vector<double> impulse_;      // [N s] per wall and fluid
    double last_force_t_ = -1;         // [s]
    std::vector<double> last_force_;   // [N] per wall and fluid, see forces.csv
    std::vector<double> largest_force_;// [N] per wall, of all fluids
    double wall_force_ = -1;
    double last_fields_ = -1;          // [s]
    LossReport losses_;
    std::vector<std::array<EnergySums, FluidTag::most>> energy_parts_;  // of blocks, reused
};

}  // namespace undertow::sph
