#include "case/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "checkpoint/archive.hpp"
#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow {

namespace {

/// Steps over which the rest of an output interval is divided evenly.
constexpr double last_steps = 8;
/// Relative room for round-off when a time is compared with an output time.
constexpr double round_off = 1e-12;

}  // namespace

StepAgreement::StepAgreement(const TimeSettings& time, double fields_every)
    : time_(time),
      fields_every_(fields_every > 0 ? fields_every : std::numeric_limits<double>::infinity()) {}

const AgreedStep& StepAgreement::agree(double t, const std::vector<StepOffer>& offers) {
    double dt = std::numeric_limits<double>::infinity();
    std::string& limiter = step_.limiter;
    limiter.clear();
    for (const StepOffer& offer : offers) {
        if (!(offer.dt >= time_.min_step))
            throw StepCollapse("At t = " + number_text(t, 4) + " s the stable step fell to " +
                               number_text(offer.dt, 4) + " s (" + offer.limiter +
                               "), below time.min_step = " + number_text(time_.min_step, 4) +
                               " s: the state has gone wrong there; look at the last field output "
                               "and refine or soften what limits the step.");
        if (offer.dt < dt) {
            dt = offer.dt;
            limiter = offer.limiter;
        }
    }
    if (time_.max_step < dt) {
        dt = time_.max_step;
        limiter = "time.max_step";
    }
    if (last_free_dt_ > 0 && time_.growth * last_free_dt_ < dt) {
        dt = time_.growth * last_free_dt_;
        limiter = "growth";
    }
    last_free_dt_ = dt;

    // Output times are multiples computed afresh, never sums, so that all programs agree on them.
    while (static_cast<double>(next_output_) * fields_every_ <= t * (1 + round_off)) ++next_output_;
    const double next_output = static_cast<double>(next_output_) * fields_every_;
    const bool end_first = next_output >= time_.end * (1 - round_off);
    const double target = end_first ? time_.end : next_output;
    const double left = target - t;
    const double steps = std::max(1.0, std::ceil(left / dt * (1 - round_off)));
    if (steps <= 1) {
        if (left < dt * (1 - round_off)) limiter = "output";
        step_.dt = left, step_.t1 = target;
        step_.output = true, step_.last = end_first;
        return step_;
    }
    if (steps <= last_steps && left / steps < dt * (1 - round_off)) {
        dt = left / steps;
        limiter = "output";
    }
    step_.dt = dt, step_.t1 = t + dt;
    step_.output = step_.last = false;
    return step_;
}

void StepAgreement::archive(Archive& a) {
    a("last_free_dt", last_free_dt_);  // output times are found anew
}

}  // namespace undertow
