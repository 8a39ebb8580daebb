#pragma once
// forces.csv, patches.csv, energy.interface.csv: what the contact did to the coupled surfaces.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "contact/penalty_contact.hpp"
#include "coupler/joint_surface.hpp"
#include "coupler/moving_mean.hpp"
#include "results/history.hpp"

namespace undertow::coupler {

/// One step as the recorder sees it.
struct RecordedStep {
    double t = 0;   // [s] of the contact state
    double dt = 0;  // [s] of the step that starts there
};

class Recorder {
 public:
    Recorder(const std::string& folder, const Case& input, const JointSurface& surface,
             const std::vector<std::string>& phases, FileStart start = FileStart::fresh);

    /// Sums the contacts of this step; writes a row when output.history_every has passed.
    /// phase: of each active particle, index into `phases`.
    void record(const RecordedStep& step, const contact::PenaltyContact& contact,
                const std::vector<std::uint32_t>& phase);

    /// The last step as a final row, whatever the interval; all files flushed.
    void finish(const contact::PenaltyContact& contact);
    void flush();
    void archive(Archive& a);

    double total_force() const;                            // [N] norm of the force on all surfaces
    double contact_time() const { return contact_time_; }  // [s] with any contact
    double deepest() const { return deepest_; }            // largest d/l0 so far
    std::size_t most_contacts() const { return most_contacts_; }
    const std::vector<std::string>& names() const { return names_; }
    contact::Vec impulse(std::size_t surface) const { return total_[surface].impulse; }  // [N s]

 private:
    struct Load {
        contact::Vec force = contact::Vec::Zero();    // [N] on the surface
        contact::Vec moment = contact::Vec::Zero();   // [N m] about the origin
        contact::Vec impulse = contact::Vec::Zero();  // [N s] since the start
    };
    struct Patch {
        PressurePatch patch;
        MovingMean mean;
    };
    void write_row(double t, double dt, const contact::PenaltyContact& contact);

    std::vector<std::string> names_;  // of the surfaces
    std::size_t phases_;
    std::vector<std::int32_t> group_;  // of each facet
    std::vector<Load> total_;          // per surface
    std::vector<Load> of_phase_;       // per surface and phase, if there are several
    std::vector<Patch> patch_;
    double every_;               // [s]
    std::int64_t next_row_ = 0;  // row k is due at k * every
    double row_t_ = -1;          // [s] of the last row written
    RecordedStep last_;
    double contact_time_ = 0, deepest_ = 0;
    std::size_t most_contacts_ = 0;
    History forces_, energy_;
    std::optional<History> patches_;
    std::vector<double> row_;
};

}  // namespace undertow::coupler
