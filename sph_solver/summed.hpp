#pragma once
// One figure of each particle, in the precision of the sums that find it.

#include <type_traits>
#include <vector>

#include "case/case.hpp"

namespace undertow::sph {

/// What a sum over neighbors finds of each particle: float, or double where sph.precision says so.
/// Padded to full clusters of eight.
class Summed {
 public:
    /// Throws away what is there.
    void set_precision(Precision precision) {
        double_ = precision == Precision::float64;
        floats_.clear(), doubles_.clear();
    }
    bool in_double() const { return double_; }
    void resize(std::size_t n) {
        if (double_)
            doubles_.resize(n, 0.0);
        else
            floats_.resize(n, 0.0f);
    }
    std::size_t size() const { return double_ ? doubles_.size() : floats_.size(); }

    double operator[](std::size_t i) const { return double_ ? doubles_[i] : floats_[i]; }
    void set(std::size_t i, double value) {
        if (double_)
            doubles_[i] = value;
        else
            floats_[i] = static_cast<float>(value);
    }
    void add(std::size_t i, double value) {
        if (double_)
            doubles_[i] += value;
        else
            floats_[i] += static_cast<float>(value);
    }
    bool operator==(const Summed&) const = default;

    /// For loops over all; Real must be the precision.
    template <class Real>
    Real* data() {
        if constexpr (std::is_same_v<Real, float>)
            return floats_.data();
        else
            return doubles_.data();
    }

 private:
    bool double_ = false;
    std::vector<float> floats_;
    std::vector<double> doubles_;
};

}  // namespace undertow::sph
