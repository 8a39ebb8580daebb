#pragma once
// The particles as contact sees them.

#include <cstdint>
#include <span>

namespace undertow::contact {

/// (P) particles; arrays are borrowed.
struct Points {
    std::span<const double> x;          // [m] (P, 3) at t
    std::span<const double> v;          // [m/s] (P, 3) at t - dt/2
    std::span<const double> mass;       // [kg] (P)
    std::span<const double> radius;     // [m] (P) l0, half the spacing
    std::span<const double> stiffness;  // [N/m] (P) natural stiffness rho c0^2 dx
    std::span<const std::uint64_t> id;  // (P) identity, constant during a run
    std::size_t size() const { return mass.size(); }
};

}  // namespace undertow::contact
