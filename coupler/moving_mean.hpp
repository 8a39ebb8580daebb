#pragma once
// Mean of a quantity over the last `window` seconds of steps of unequal length.

#include <cstddef>
#include <vector>

namespace undertow {
class Archive;
}

namespace undertow::coupler {

class MovingMean {
 public:
    explicit MovingMean(double window);  // [s]; 0 = the last value itself

    /// The quantity had this mean during the dt [s] that ends at t.
    void add(double t, double dt, double value);

    /// Mean over (t - window, t], or over all time so far where that is shorter.
    double mean() const;
    void archive(Archive& a);

 private:
    struct Sample {
        double t;         // [s]
        double integral;  // of the quantity up to t
    };
    const Sample& at(std::size_t i) const { return ring_[(first_ + i) % ring_.size()]; }

    double window_;
    std::vector<Sample> ring_;  // doubled when full: no allocation once it holds a window
    std::size_t first_ = 0, count_ = 0;
    double value_ = 0;
};

}  // namespace undertow::coupler
