#include "coupler/moving_mean.hpp"

#include <algorithm>

namespace undertow::coupler {

MovingMean::MovingMean(double window) : window_(window), ring_(64) {}

void MovingMean::add(double t, double dt, double value) {
    value_ = value;
    if (window_ <= 0) return;
    if (count_ == 0) ring_[count_++] = {t - dt, 0};
    if (count_ == ring_.size()) {
        std::rotate(ring_.begin(), ring_.begin() + std::ptrdiff_t(first_), ring_.end());
        first_ = 0;
        ring_.resize(2 * ring_.size());
    }
    const double integral = at(count_ - 1).integral + value * dt;
    ring_[(first_ + count_) % ring_.size()] = {t, integral};
    ++count_;
    // One sample at or before the window's start is kept: the mean interpolates from it.
    while (count_ > 2 && at(1).t <= t - window_) {
        first_ = (first_ + 1) % ring_.size();
        --count_;
    }
}

double MovingMean::mean() const {
    if (window_ <= 0 || count_ < 2) return value_;
    const Sample& last = at(count_ - 1);
    const double start = std::max(last.t - window_, at(0).t);
    const Sample& before = at(0);
    const Sample& after = at(1);
    const double share = std::clamp((start - before.t) / (after.t - before.t), 0.0, 1.0);
    const double integral = before.integral + share * (after.integral - before.integral);
    return (last.integral - integral) / (last.t - start);
}

}  // namespace undertow::coupler
