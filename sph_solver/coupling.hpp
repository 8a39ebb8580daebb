#pragma once
// The link of the loop to the outside: the coupler, or nobody. The only place that talks to the wire.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "case/case.hpp"
#include "checkpoint/archive_file.hpp"
#include "sph_solver/fluid_system.hpp"

namespace undertow::sph {

/// What a solver offers for step n.
struct StepState {
    std::int64_t n;
    double t;                  // [s]
    double dt_limit;           // [s]
    std::string_view limiter;
    double work;               // particle-steps so far
};

/// What the link orders.
struct StepOrder {
    double dt = 0, t1 = 0;     // [s]
    bool output = false;       // t1 is a common output time
    bool finished = false;     // no step to take: the run is over
    bool interrupted = false;
    std::string limiter;
    std::string checkpoint;    // not empty: write the state under this name, then wait again
};

class Link {
 public:
    virtual ~Link() = default;
    /// Shows positions and velocities at t^n and the stable step; returns at once.
    virtual void offer(const StepState& state, const FluidSystem& fluid) = 0;
    /// Waits for the agreed step; contact accelerations are in fluid.particles.fx, fy, fz then.
    /// The order holds until the next one.
    virtual const StepOrder& wait(FluidSystem& fluid) = 0;
    /// The checkpoint of the last order is on the disk.
    virtual void confirm(const WrittenFile& file) = 0;
    /// Called in long work between two messages: who waits for this program learns that it lives.
    virtual void still_busy(const std::string&) {}
    virtual void archive(Archive& a) = 0;
    virtual void report_error(const std::string& code, const std::string& text) noexcept = 0;
    virtual double waited() const { return 0; }   // [s]
};

std::unique_ptr<Link> make_lonely_link(const Case& input, const std::string& folder);
/// keys: a folder, see wire/curve_keys.hpp; empty = none.
std::unique_ptr<Link> make_coupled_link(const Case& input, const std::string& endpoint,
                                        const std::string& keys = {});

}  // namespace undertow::sph
