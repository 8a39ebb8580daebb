#pragma once
// When must the contact search be repeated, so that no particle is ever missed?
//
// At a search, every particle within l0 + skin of a facet becomes active. One that did not cannot
// touch until the largest displacement of any particle (reported by the particle solver: reach)
// plus the largest displacement of any node has used up the skin. The boxes, outside of which
// particles are not even reported, were sent one step before the search; what the surface moved in
// between is taken off the skin afterwards, with its measured size, so nothing is assumed about it.
//
// A search must be asked for one step ahead. The coming step is allowed twice the fastest approach
// seen so far in the last steps (the force limit of the SPH step keeps a dt^2 below 0.075 dx, so
// speeds do not double from one step to the next), and a tenth of the skin stays in reserve. What
// really happened is checked when the step has been taken: late() counts violations.

#include <cstdint>
#include <span>
#include <vector>

namespace undertow {
class Archive;
}

namespace undertow::coupler {

class SearchBudget {
 public:
    SearchBudget(double largest_radius, double skin);  // [m]

    double skin() const { return skin_; }
    double box_range() const { return largest_radius_ + 1.25 * skin_; }  // [m] around facets

    /// The boxes of a coming search were built around the nodes at x (N, 3).
    void boxes_sent(std::span<const double> x);

    /// [m] the largest displacement of a node since then, x (N, 3).
    double since_boxes(std::span<const double> x) const;

    /// A search was made with nodes at x; `speed` [m/s] is the largest of all searched particles
    /// and nodes.
    void searched(std::span<const double> x, double speed);

    /// A step of length dt [s] was taken: reach [m] of particles since the search, nodes now at x.
    void moved(double reach, std::span<const double> x, double dt);

    /// Must the step after the coming one, of length dt [s], begin with a search?
    bool due(double dt) const;

    void archive(Archive& a);
    double used() const { return used_; }            // [m] of approach since the search
    double allowance() const { return allowance_; }  // [m] granted by it
    std::int64_t late() const { return late_; }      // steps at which the skin was overdrawn

 private:
    double largest_radius_, skin_;
    std::vector<double> x_boxes_, x_search_;  // [m]
    double allowance_ = 0;                    // [m] of the last search
    double used_ = 0;                         // [m] of the allowance
    double rate_ = 0;                         // [m/s] of approach, as seen lately
    std::int64_t late_ = 0;
};

}  // namespace undertow::coupler
