#pragma once
// One agreed stable step. Used by the coupler, and by a solver that runs alone.

#include <cstdint>
#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow {

struct StepOffer {
    double dt;              // [s] largest stable step of this participant
    std::string limiter;    // "sph: sound"
};

struct AgreedStep {
    double dt;              // [s]
    double t1;              // [s] time at the end of the step, exact on output times
    std::string limiter;    // who decided: an offer's name, "growth", "output", "time.max_step"
    bool output;            // t1 is a common output time
    bool last;              // t1 is time.end
};

class Archive;

/// dt = min over offers, time.max_step and growth * last dt, then fitted so that steps land exactly
/// on the multiples of output.fields_every and on time.end (the interval left is divided evenly over
/// its last steps, so that no sliver step appears; a step cut short for that does not slow the
/// following ones by the growth limit).  [Wang 2024, Eq. 12]
/// Throws PhysicsError when the offers fall below time.min_step, naming the limiter.
class StepAgreement {
 public:
    StepAgreement(const TimeSettings& time, double fields_every);
    /// Holds until the next one.
    const AgreedStep& agree(double t, const std::vector<StepOffer>& offers);
    void archive(Archive& a);

 private:
    TimeSettings time_;
    double fields_every_;
    std::int64_t next_output_ = 1;
    double last_free_dt_ = 0;   // last dt before fitting; 0 = no step yet
    AgreedStep step_{};         // its text keeps its memory from step to step
};

}  // namespace undertow
