#pragma once
// The state of the fluid: a structure of arrays, sorted along columns at each list rebuild.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "sph_solver/summed.hpp"

namespace undertow::sph {

struct Particles {
    std::vector<double> x, y, z;       // position at t^n [m], [n]
    std::vector<double> vx, vy, vz;    // velocity at t^{n-1/2} [m/s], [n]
    std::vector<double> drho;          // density minus reference density [kg/m3], [n]: never the
                                       // density itself, whose last digits carry the pressure
    std::vector<double> energy;        // specific internal energy [J/kg], [n]; 0 unless Gamma0 != 0
    std::vector<double> rate_before;   // d(rho)/dt of the step before [kg/m3/s], [n]
    std::vector<double> p;             // pressure [Pa], [n]
    std::vector<double> fx, fy, fz;    // contact acceleration of this step [m/s2], [n]
    std::vector<std::int64_t> id;      // identity, constant during the run, [n]
    std::vector<std::uint8_t> fluid;   // index of the fluid, [n]
    std::vector<double> viscosity;     // [Pa s] from the shear rate of the step before; padded to
                                       // full clusters, or empty where no fluid is viscoplastic

    // results of the pair sums
    Summed ax, ay, az;               // acceleration without gravity and contact [m/s2]
    Summed drho_dt;                  // continuity + density diffusion [kg/m3/s]
    std::vector<double> shear_rate;  // sqrt(2 D:D) [1/s]; as viscosity, and only where a particle
                                     // of a viscoplastic fluid is near

    std::size_t size() const { return x.size(); }

    /// All that is one double of each particle.
    std::array<std::vector<double>*, 13> reals() {
        return {&x,  &y, &z, &vx, &vy, &vz, &drho, &energy, &rate_before, &p, &fx, &fy, &fz};
    }

    /// The state of particle `from`, identity included, becomes that of `to`; results of sums do not.
    void copy(std::size_t from, std::size_t to) {
        for (auto* a : reals()) (*a)[to] = (*a)[from];
        id[to] = id[from];
        fluid[to] = fluid[from];
        if (!viscosity.empty()) viscosity[to] = viscosity[from], shear_rate[to] = shear_rate[from];
    }

    /// Of the sums; float unless called.
    void set_precision(Precision precision) {
        for (auto* a : {&ax, &ay, &az, &drho_dt}) a->set_precision(precision);
        resize(size());
    }

    void resize(std::size_t n) {
        for (auto* a : reals()) a->resize(n, 0.0);
        id.resize(n);
        fluid.resize(n, 0);
        for (auto* a : {&ax, &ay, &az, &drho_dt}) a->resize((n + 7) / 8 * 8);
        if (!viscosity.empty())
            for (auto* a : {&viscosity, &shear_rate}) a->resize((n + 7) / 8 * 8, 0.0);
    }
};

/// What a neighbor shows of itself in the pair loop: 32 bytes, one broadcast load per member.
struct alignas(32) Packed {
    using Real = float;
    std::int32_t x, y, z;   // fixed-point position [FixedPoint::unit]
    float volume;           // m/rho [m^d]; its last bits are a FluidTag
    float vx, vy, vz;       // [m/s]
    float p;                // [Pa]
};

/// The same in double precision: 64 bytes. Lists, openings' and gauges' searches go by the others.
struct alignas(64) ExactRecord {
    using Real = double;
    double x, y, z;     // position [m]
    double volume;      // [m^d]; its last bits are a FluidTag
    double vx, vy, vz;  // [m/s]
    double p;           // [Pa]
};

/// The record that sums in a precision read.
template <class Real>
using Record = std::conditional_t<std::is_same_v<Real, float>, Packed, ExactRecord>;

/// The index of the fluid in the last bits of a record's volume: 4e-7 of it, and the pair loop
/// needs no member more (1e-15 of an ExactRecord's). One Newtonian fluid alone has no tag and keeps
/// its volume to the last bit.
class FluidTag {
 public:
    static constexpr std::uint32_t mask = 7;
    static constexpr std::size_t most = mask + 1;   // fluids

    /// mixed: the fluids must be told apart, see PairPhysics::mixed.
    explicit FluidTag(bool mixed) : keep_(mixed ? ~mask : ~0u) {}

    float operator()(double volume, std::uint8_t fluid) const {
        const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(volume));
        return std::bit_cast<float>((bits & keep_) | fluid);
    }
    double exact(double volume, std::uint8_t fluid) const {
        const std::uint64_t keep = ~static_cast<std::uint64_t>(~keep_);
        return std::bit_cast<double>((std::bit_cast<std::uint64_t>(volume) & keep) | fluid);
    }
    static std::uint32_t of(const ExactRecord& q) {
        return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(q.volume)) & mask;
    }
    static std::uint32_t of(const Packed& q) { return std::bit_cast<std::uint32_t>(q.volume) & mask; }

 private:
    std::uint32_t keep_;
};

/// Positions as integers around the middle of the scene: differences are exact, and a particle that
/// creeps by 1e-9 m still moves (float32 coordinates would stand still).
struct FixedPoint {
    double unit = 1;        // [m]
    double x0 = 0, y0 = 0, z0 = 0;   // [m]

    std::int32_t operator()(double a, double a0) const {
        return static_cast<std::int32_t>(std::lrint((a - a0) * inverse));
    }
    double inverse = 1;     // [1/m]
};

}  // namespace undertow::sph
