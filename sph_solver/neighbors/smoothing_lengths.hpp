#pragma once
// The smoothing length of each particle: that of its fluid, h0 = smoothing_ratio dx, or with
// sph.variable_smoothing one that follows from density.
//
//   dh/dt = -(h/d) (d rho/dt)/rho   integrates to   h = h0 (rho0/rho)^(1/d)
//
// so that h keeps its ratio to the distance of neighbors. It stays between h0/2 and 2 h0, and where
// particles are crowded it is cut at each rebuild until none has more than 140 neighbors.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sph_solver/particles.hpp"
#include "sph_solver/physics/fluid_law.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

class Neighborhood;

class SmoothingLengths {
 public:
    static constexpr int most_neighbors = 140;
    static constexpr double smallest = 0.5, largest = 2;  // [h0]
    /// Lists are made for lengths that have grown by this factor: 3 % of density, more than sound
    /// changes it.
    static constexpr double room = 1.01;

    /// dummies: h of bodies' dummies [m].
    SmoothingLengths(bool used, bool variable, int dimension, double dummies,
                     const std::vector<FluidLaw>& fluids)
        : used_(used), variable_(variable), dimension_(dimension), dummies_(dummies) {
        for (const FluidLaw& f : fluids) h0_.push_back(f.h), rho0_.push_back(f.rho0);
    }

    void archive(Archive& a);
    bool used() const { return used_; }
    bool variable() const { return variable_; }
    double of_dummies() const { return dummies_; }  // [m]

    /// From the fluid and the density alone.  [m]
    double of(std::uint8_t fluid, double drho) const {
        if (!variable_) return h0_[fluid];
        const double thinner = rho0_[fluid] / std::max(rho0_[fluid] + drho, 1e-3 * rho0_[fluid]);
        const double growth = dimension_ == 2 ? std::sqrt(thinner) : std::cbrt(thinner);
        return h0_[fluid] * std::clamp(growth, smallest, largest);
    }
    double largest_of(const Particles& particles) const;  // [m]

    /// After a rebuild: cuts lengths of the crowded, and remembers up to where all may grow.
    void cap(Neighborhood& neighbors);
    /// Of particle i (sorted index) at its present density, as far as the lists reach.  [m]
    template <class Real>
    Real now(std::size_t i, std::uint8_t fluid, double drho) {
        const auto h = static_cast<Real>(of(fluid, drho));
        if (h <= ceiling_[i]) return h;
        if (!capped_[i]) {
#pragma omp atomic write
            outgrown_ = 1;
        }
        return ceiling_[i];
    }
    /// Some length has grown beyond what lists were made for.
    bool outgrown() const {
        return outgrown_ != 0;
    }
    double least() const {
        return least_;
    }  // [m] as of the last rebuild
    std::int64_t capped() const {
        return count_;
    }  // particles, at the last rebuild
    std::int64_t most_capped() const {
        return most_count_;
    }  // at any

 private:
    bool crowded(const Neighborhood& neighbors);

    bool used_, variable_;
    int dimension_, outgrown_ = 0;
    double dummies_, least_ = 0;
    std::int64_t count_ = 0, most_count_ = 0;
    std::vector<double> h0_, rho0_;      // [fluids]
    std::vector<float> ceiling_, next_;  // [m], [n]
    std::vector<std::uint8_t> capped_;   // [n]
};

}  // namespace undertow::sph
