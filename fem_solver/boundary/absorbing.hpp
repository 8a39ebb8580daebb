#pragma once
// The far field: a viscous boundary that lets waves out and keeps the reaction of the start.
//
//     t = -rho c_p v_n n - rho c_s (v - v_n n)  [Pa]     [Lysmer and Kuhlemeyer 1969]
//
// It absorbs waves that meet it head on entirely. The velocity is the mean of both half steps, so
// that the dashpots neither lag nor shorten the stable step (on the lagged velocity they are
// unstable at a cfl of 0.8):
//     m (v+ - v-)/s = F - C (v+ + v-)/2,   s = (dt^{n-1} + dt^n)/2
//
// Dashpots give way to a load that stays. Springs beside them stand for the soil beyond: per area
// 4 G/r along the normal and 2 G/r across it, r the distance from where the loads act.
//     [Liu, Du and Du 2006: three-dimensional viscous-spring boundary]

#include <vector>

#include "fem_solver/boundary/nodal_load.hpp"
#include "fem_solver/materials/linear_elastic.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

struct AbsorbingFacet {
    Quad node{};                  // of the mesh, normal outward
    double normal_impedance = 0;  // [kg/(m2 s)] rho c_p of the element behind it
    double shear_impedance = 0;   // [kg/(m2 s)] rho c_s
    double normal_stiffness = 0;  // [N/m3] of the soil beyond
    double shear_stiffness = 0;   // [N/m3]
};

class AbsorbingBoundary {
 public:
    AbsorbingBoundary() = default;
    /// Dashpots of the facets in the shape x [m]; an equal share of a facet hangs on each of
    /// its nodes.
    AbsorbingBoundary(const std::vector<AbsorbingFacet>& facets, const std::vector<Vec3>& x);

    bool empty() const { return reaction_.node.empty(); }
    bool released() const { return released_; }
    const std::vector<std::int32_t>& nodes() const { return reaction_.node; }
    /// Work counts from here.
    void reset_work();
    /// Holds its nodes in every direction; after the supports are in.
    void hold(Nodes& nodes);
    /// Frees what hold() held, and keeps as a constant force what held it: nodes.f are all other
    /// forces but weight. Supports stay.
    void release(Nodes& nodes, const Vec3& gravity);

    // One step, nothing before release():
    /// The reaction of the start and that of the soil beyond to what moved since.
    void react(const NodeRows& x, NodeRows& f);
    void before_kick(const Nodes& nodes, double dt_before);
    /// Corrects velocities, forces (by those of the dashpots) and the report of a kick without
    /// dashpots.
    void after_kick(Nodes& nodes, const Kick& step, KickReport& report);
    void drift(const NodeRows& v, double dt);

    double reaction_work() const { return reaction_.work; }  // [J]
    double dissipated() const { return dissipated_; }        // [J] up to n, after the kick
    void archive(Archive& a);

 private:
    void add_facet(const AbsorbingFacet& facet, const std::vector<Vec3>& x);

    std::vector<Symmetric<double>> dashpot_;  // [N s/m] C, [n_nodes]
    std::vector<Symmetric<double>> spring_;   // [N/m] K, [n_nodes]; empty when there are none
    NodeRows inverse_mass_;                   // [1/kg] what hold() found
    NodalLoad reaction_;                      // [N] its node list is the boundary's
    NodeRows reaction_start_, x_start_;       // [N], [m] at the release
    NodeRows v_before_;                       // [m/s]
    bool released_ = false;
    double dissipated_ = 0, ahead_ = 0;  // [J] up to n, and of the half step after it
};

}  // namespace undertow::fem
