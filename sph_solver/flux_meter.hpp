#pragma once
// What flows through a rectangle.

#include <cstdint>
#include <vector>

#include "case/case.hpp"
#include "sph_solver/fluid_system.hpp"

namespace undertow {
class Archive;
}

namespace undertow::sph {

class FluxMeter {
 public:
    /// A gauge of kind flux.
    explicit FluxMeter(const SphGauge& gauge);

    /// Counts who went through since the last call; to be called every step. A particle counts with
    /// its volume when it changes sides inside the rectangle, whatever moved it.
    void count(const FluidSystem& fluid);
    /// Net volume that went through since the first call [m3], exact to one particle.
    double total() const { return total_; }
    void archive(Archive& a);
    /// Rate of flow now, the mean over h to each side: sum V v/(2h) of the particles there [m3/s].
    double rate(const FluidSystem& fluid) const;

 private:
    bool inside(const FluidSystem& fluid, std::size_t i, double& beyond) const;

    Box box_;
    int normal_;      // axis across the rectangle
    double forward_;  // 1 or -1: which way along the axis counts
    double total_ = 0;
    std::vector<std::int8_t> side_;  // by identity: -1 before, 1 beyond, 0 not near
};

}  // namespace undertow::sph
