#pragma once
// Where does a node touch a faceted surface, and in which direction is it pushed?
//
// Facets stand in for a smooth surface. Between two that meet at less than 30 degrees the normal
// changes steadily (nodal normals n_a, interpolated by the weights w_a of the foot), and the
// surface bulges over the flat facet by
//   h = -1/2 sum_a w_a (x_foot - x_a) . n_a      [m]
// (over the chord of a circle the parabola of its sagitta), so that distance and normal belong
// together, and soil nodes may lie anywhere along a round skirt. With flat facets a node in the
// shallow valley between two of them chatters from one to the other, and a quiet start is not
// found. Sharper convex edges and their corners are round: there a node is pushed along the line
// from its foot.
//
// Deformable facets do not bulge: h would change as they bend, and forces that leave this out do
// work that no spring has stored (0.5 % of an impact's energy instead of 0.1 %).

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "contact/candidates.hpp"
#include "fem_solver/contact_pairs/contact_points.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

struct Touch {
    std::uint32_t facet = 0;
    std::array<double, 4> weight{};  // of the facet's nodes at the foot
    Eigen::Vector3d normal;          // unit, out of the surface
    double distance = 0;             // [m] signed, along the normal
};

enum class SurfaceKind { rigid, deformable };

class TouchedSurface {
 public:
    /// Facets by nodes of the mesh.
    TouchedSurface(const std::vector<Quad>& facets, const Nodes& nodes, SurfaceKind kind);
    /// Both faces of shells that deform; or faces of a rigid body, of which `opposite` tells the two
    /// that belong to one shell, as ContactSet has it.
    TouchedSurface(const FaceLayout& faces, const Nodes& nodes, const TurningNodes& turning);
    void remember_sides(std::vector<std::int32_t> opposite) { opposite_ = std::move(opposite); }
    // The contact library's surface refers to the positions kept here.
    TouchedSurface(const TouchedSurface&) = delete;
    TouchedSurface& operator=(const TouchedSurface&) = delete;

    /// Takes positions and velocities of this step.
    void follow(const Nodes& nodes, const TurningNodes* turning = nullptr);
    /// Normals of the facets at their present positions; all of them.
    void refresh_normals();
    /// Nearest of the candidate facets; false if there is none, or if the node lies beyond the rim
    /// of the surface. `before` is the facet that it was nearest to last, -1 for none: the other
    /// faces of the shells around that one are not seen, so that a node pressed past the middle of
    /// a thin wall comes back out of the face through which it went in.
    bool touch(const Eigen::Vector3d& x, std::span<const std::uint32_t> candidates, Touch& out,
               std::int32_t before = -1) const;

    /// [m] by which the surface may stand before a flat facet; 0 of deformable facets.
    double largest_bulge() const { return largest_bulge_; }

    const contact::Surface& facets() const { return surface_; }
    const ContactPoints& points() const { return points_; }
    Eigen::Vector3d position(const Touch& touch) const;              // [m] of the foot
    Eigen::Vector3d velocity(const Touch& touch) const;              // [m/s] of the foot
    /// [rad/s] of shells that deform, at the foot; 0 of other facets.
    Eigen::Vector3d turn_rate(const Touch& touch, const TurningNodes* turning) const;

 private:
    TouchedSurface(ContactPoints points, std::vector<std::int32_t> quad, const Nodes& nodes,
                   SurfaceKind kind);
    bool is_other_face(std::uint32_t facet, std::int32_t before) const;
    void group_normals();
    void mirror_ends();
    Eigen::Vector3d mean_normal(std::uint32_t facet, int corner) const;
    Eigen::Vector3d corner_normal(std::uint32_t facet, int corner) const;
    bool touch_smooth(const Eigen::Vector3d& x, const contact::Foot& nearest, Touch& out) const;
    bool touch_edge(const Eigen::Vector3d& x, int edge, double share, Touch& out) const;
    void follow_edges();
    void find_bulge();

    SurfaceKind kind_;
    double largest_bulge_ = 0;  // [m]
    ContactPoints points_;
    std::vector<std::int32_t> opposite_;  // per facet, see ContactSet
    contact::Surface surface_;
    std::vector<Eigen::Vector3d> normal_;  // per facet
    // Facets whose normals make the normal of a corner: of corner k of facet f those from
    // group_[start_[4 f + k]] to group_[start_[4 f + k + 1]].
    std::vector<std::uint32_t> start_, group_;
    std::vector<std::int32_t> across_;  // facet beyond the sharp edge k of facet f, else -1
    // Where the smooth surface ends, a facet goes on as it began: the normal of corner k of facet f
    // mirrors that of this other corner; -1 elsewhere.
    std::vector<std::int8_t> mirror_;
    std::vector<std::uint8_t> sharp_node_;    // per node: on a sharp edge
    std::vector<std::uint8_t> edge_runs_on_;  // per node: which runs on through it or ends there
};

}  // namespace undertow::fem
