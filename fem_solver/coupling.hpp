#pragma once
// The solver's link to whoever grants its steps: the coupler over the wire, or, when it runs alone,
// a null object that agrees with itself. Only this file and coupling.cpp know the wire.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "case/case.hpp"
#include "checkpoint/archive_file.hpp"
#include "fem_solver/structure.hpp"

namespace undertow::fem {

/// The answer to a step's state: take the step, or end.
struct StepOrder {
    double dt = 0;              // [s]
    double t1 = 0;              // [s] time at the end of the step, to be taken as it is
    std::string limiter;        // who limits dt
    bool output = false;        // t1 is a common output time
    std::span<const double> f;  // [N] (n_surface_nodes, 3) contact forces; empty when alone
    bool finish = false;
    bool interrupted = false;  // finish because a user asked for it
    std::string checkpoint;    // not empty: write the state under this name, then wait again
};

class Link {
 public:
    virtual ~Link() = default;
    /// Makes the structure known. Returns the step number to begin with, `n` when it is for this
    /// program to say.
    virtual std::int64_t announce(const Structure& structure, std::int64_t n) = 0;
    /// x^n and v^{n-1/2} of the surface, and the offered step; returns at once.
    virtual void send_state(std::int64_t n, double t, const Structure& structure,
                            const StableStep& offer, bool stop) = 0;
    virtual const StepOrder& wait_order() = 0;
    /// The checkpoint of the last order is on the disk.
    virtual void confirm(const WrittenFile& file) = 0;
    /// Called in long work between two messages: who waits for this program learns that it lives.
    virtual void still_busy(const std::string&) {}
    virtual void archive(Archive& a) = 0;
    virtual void say_goodbye(std::int64_t n) = 0;
    /// Tells the others why this program fails; `code` is one of the protocol's.
    virtual void report_error(const std::string& code, const std::string& text) noexcept = 0;
    virtual double waited() const = 0;  // [s] for the coupler
};

/// folder: of the results, where checkpoints go.
std::unique_ptr<Link> run_alone(const Case& c, const std::string& folder = ".");
/// Connects to the coupler at `endpoint` and shakes hands. PeerError if it does not answer,
/// InputError if the case has no [[fem.surface]] or fem.cfl leaves no room for contact.
/// keys: a folder, see wire/curve_keys.hpp; empty = none.
std::unique_ptr<Link> join_coupler(const Case& c, const std::string& endpoint,
                                   const std::string& keys = {});

}  // namespace undertow::fem
