#pragma once
// The coupled surface: facets over nodes, what does not change (topology, masses) and where it is.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "contact/facet.hpp"

namespace undertow::contact {

/// First defect of a mesh as a sentence ("facet 17 has no area"), empty if it is sound: facets with
/// area, convex, no corner used twice (except a triangle's third), and edge neighbors that agree on
/// which side is wet. x [m] (N, 3), quad (F, 4).
std::string find_defect(std::span<const double> x, std::span<const std::int32_t> quad);

/// The mean plane of a facet.
struct FacetPlane {
    Vec center;    // [m] mean of the corners
    Vec normal;    // unit, wet side
    Vec velocity;  // [m/s] of the center
};

class Surface {
 public:
    Surface(std::vector<std::int32_t> quad, std::vector<double> mass);  // (F, 4); [kg] (N)

    std::size_t facets() const { return quad_.size() / 4; }
    std::size_t nodes() const { return mass_.size(); }
    const std::int32_t* corners(std::uint32_t facet) const { return &quad_[4 * facet]; }
    double mass(std::int32_t node) const { return mass_[node]; }
    const double* inverse_masses() const { return inverse_mass_.data(); }  // [1/kg] (N)

    /// Positions and velocities of this step, (N, 3) each; kept by reference until the next call.
    void move(std::span<const double> x, std::span<const double> v);
    std::span<const double> x() const { return x_; }
    std::span<const double> v() const { return v_; }

    Vec position(std::int32_t node) const { return Vec::Map(&x_[3 * std::size_t(node)]); }
    Vec velocity(std::int32_t node) const { return Vec::Map(&v_[3 * std::size_t(node)]); }
    Corners shape(std::uint32_t facet) const;
    FacetPlane plane(std::uint32_t facet) const;

    /// True if the outline edge or corner given by `rim` (of Foot) belongs to one facet only: there
    /// is no surface beyond it, so being below the facet's plane there does not mean being inside.
    bool is_free_rim(std::uint32_t facet, std::uint8_t rim) const;

 private:
    std::vector<std::int32_t> quad_;
    std::vector<double> mass_, inverse_mass_;
    std::vector<std::uint8_t> free_edges_;  // (F) bit k: edge from corner k to k+1 is free
    std::vector<std::uint8_t> free_node_;   // (N) the node lies on a free edge
    std::span<const double> x_, v_;
};

}  // namespace undertow::contact
