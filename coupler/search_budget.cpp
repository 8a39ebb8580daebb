#include "coupler/search_budget.hpp"

#include <algorithm>
#include <cmath>

namespace undertow::coupler {

namespace {

constexpr double speed_margin = 2;   // of the coming step against the last ones
constexpr double reserve = 0.1;      // of the skin
constexpr double rate_decay = 0.98;  // per step: a past burst is forgotten after some 50 steps

double largest_displacement(std::span<const double> x, const std::vector<double>& from) {
    double largest2 = 0;
    for (std::size_t i = 0; i + 2 < x.size(); i += 3) {
        const double dx = x[i] - from[i], dy = x[i + 1] - from[i + 1], dz = x[i + 2] - from[i + 2];
        largest2 = std::max(largest2, dx * dx + dy * dy + dz * dz);
    }
    return std::sqrt(largest2);
}

}  // namespace

SearchBudget::SearchBudget(double largest_radius, double skin)
    : largest_radius_(largest_radius), skin_(skin) {}

void SearchBudget::boxes_sent(std::span<const double> x) {
    x_boxes_.assign(x.begin(), x.end());
}

double SearchBudget::since_boxes(std::span<const double> x) const {
    return largest_displacement(x, x_boxes_);
}

void SearchBudget::searched(std::span<const double> x, double speed) {
    allowance_ = std::min(skin_, box_range() - largest_radius_ - since_boxes(x));
    x_search_.assign(x.begin(), x.end());
    used_ = 0;
    rate_ = std::max(rate_, speed);
    if (allowance_ < 0) ++late_;
}

void SearchBudget::moved(double reach, std::span<const double> x, double dt) {
    const double used = reach + largest_displacement(x, x_search_);
    rate_ = std::max(rate_decay * rate_, (used - used_) / dt);
    used_ = used;
    if (used_ > allowance_) ++late_;
}

bool SearchBudget::due(double dt) const {
    return used_ + speed_margin * rate_ * dt > (1 - reserve) * allowance_;
}

}  // namespace undertow::coupler
