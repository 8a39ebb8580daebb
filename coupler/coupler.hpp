#pragma once
// The coupler: brings a particle solver and a surface participant to one time step, computes the
// contact between them, and keeps the books.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "case/time_step.hpp"
#include "checkpoint/checkpoint_clock.hpp"
#include "checkpoint/checkpoint_set.hpp"
#include "contact/penalty_contact.hpp"
#include "coupler/joint_surface.hpp"
#include "coupler/participants.hpp"
#include "coupler/pressure_field.hpp"
#include "coupler/recorder.hpp"
#include "coupler/run_figures.hpp"
#include "coupler/search_budget.hpp"
#include "wire/failure.hpp"

namespace undertow::coupler {

struct CouplerOptions {
    std::string folder;  // of the results
    MeetingPlace place;
    bool quiet = false;
    std::string resume;  // a set of checkpoints to go on from; empty = from the start
};

class Coupler {
 public:
    Coupler(const Case& input, const CouplerOptions& options);

    /// Runs to time.end, or until somebody asks to stop. Returns the exit code (done or
    /// interrupted). Every failure is told to the participants, then thrown on.
    int run();

 private:
    int run_loop();
    void prepare();
    std::string reason_to_end() const;
    void update_contact();
    void search();
    double longest_step() const;  // [s]
    const AgreedStep& agree_time_step();
    void send_boxes();
    void send_active();
    void send_same_active();
    bool shows_motion() const;
    void send_forces(const AgreedStep& step);
    void report_start_inside() const;
    void record(const AgreedStep& step);
    void write_fields();
    ProgressFigures live(std::string doing = {}) const;
    int finish(const std::string& reason);
    // checkpoint.cpp:
    void check_capabilities() const;
    bool checkpoint_due(const std::string& reason_to_end) const;
    void write_checkpoint();
    void archive(Archive& a);
    void resume();
    void write_failure(const Failure& failure) const noexcept;

    Case input_;
    CouplerOptions options_;
    std::optional<Manifest> from_;  // the set that the run goes on from
    Participants participants_;
    CheckpointClock clock_;
    ProgressLine progress_;
    StepAgreement agreement_;

    JointSurface joint_;
    std::unique_ptr<contact::Surface> boxed_;  // where the boxes are drawn
    std::unique_ptr<contact::PenaltyContact> contact_;
    std::unique_ptr<SearchBudget> budget_;
    std::unique_ptr<Recorder> recorder_;
    std::unique_ptr<PressureField> pressure_;
    std::unique_ptr<RunFigures> figures_;

    std::int64_t n_ = 0;
    double t_ = 0;       // [s] at the start of step n
    AgreedStep step_{};  // the last agreed one
    std::vector<StepOffer> offers_{3};
    wire::Force force_;                 // what both get; its text keeps its memory
    std::vector<std::uint32_t> phase_;  // of each active particle
    bool late_reported_ = false;
    bool resumed_ = false;  // this step's messages are those of the checkpoint
};

}  // namespace undertow::coupler
