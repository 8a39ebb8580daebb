#pragma once
// What a coupled run cost and found: kept step by step, shown in the live line, written to
// summary.coupler.json at the end.

#include <cstdint>
#include <map>
#include <string>

#include "case/time_step.hpp"
#include "checkpoint/checkpoint_figures.hpp"
#include "contact/penalty_contact.hpp"
#include "coupler/participants.hpp"
#include "coupler/recorder.hpp"
#include "results/progress.hpp"

namespace undertow::coupler {

class RunFigures {
 public:
    RunFigures();

    void count(const AgreedStep& step, const contact::PenaltyContact& contact);
    void count_search() { ++searches_; }
    void count_show() { ++shows_; }
    void count_checkpoint(double seconds) { checkpoints_.count(0, seconds); }
    void archive(Archive& a);

    ProgressFigures live(const AgreedStep& step, const Participants& participants,
                         const Recorder& recorder, double t_end) const;
    void write(const std::string& path, const std::string& reason, double t,
               const Participants& participants, const Recorder& recorder,
               const contact::PenaltyContact& contact, std::int64_t late_searches) const;

    std::int64_t steps() const { return steps_; }
    double wall() const;  // [s] since the first step

 private:
    double start_;  // [s] wall clock
    std::int64_t steps_ = 0, searches_ = 0, shows_ = 0, outputs_ = 0;
    double dt_min_ = 0, dt_max_ = 0, dt_sum_ = 0;  // [s]
    double largest_force_ = 0;                     // [N] component on a particle
    double momentum_residual_ = 0;                 // [N] largest of any step
    std::map<std::string, std::int64_t> limited_by_;
    std::string kind_;  // of the limiter, reused from step to step
    CheckpointFigures checkpoints_;
};

}  // namespace undertow::coupler
