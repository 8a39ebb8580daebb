#pragma once
// All elements of a mesh that deform, whatever their kind: one group for each kind, stepped one
// after the other. Implicit parts (fem_solver/implicit) have a group of their own, which does not
// count where the step is limited.

#include <memory>
#include <string>
#include <vector>

#include "fem_solver/elements/element_group.hpp"
#include "fem_solver/elements/part.hpp"
#include "fem_solver/mesh.hpp"

namespace undertow::fem {

class Hexahedra;

class Elements {
 public:
    /// Takes undeformed shapes from the mesh; every element in one part at most. One in none (of a
    /// rigid body) has no mass and no stress here. InputError for a part whose `element` does not
    /// suit its elements.
    Elements(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity);

    std::size_t size() const { return part_of_.size(); }  // of the mesh
    std::size_t deformable() const { return deformable_; }
    const std::vector<std::unique_ptr<ElementGroup>>& groups() const { return groups_; }

    /// The group of the implicit parts; none without such parts.
    const Hexahedra* implicit() const { return implicit_; }

    // As ElementGroup has them, of all groups together; bounds, tangent forces and the stiffest
    // element are those of the explicit groups:
    std::vector<double> nodal_masses(std::size_t n_nodes) const;
    std::vector<double> nodal_weight_masses(std::size_t n_nodes) const;
    void set_stress(std::int32_t element, const Symmetric<double>& stress);
    double omega2_start() const;
    std::vector<double> omega2() const;  // [1/s2] (n_elements); 0 of a rigid body's
    double largest_wave_speed() const { return wave_speed_; }
    bool any_plastic() const { return any_plastic_; }

    ElementsReport step(Nodes& nodes, double dt, int threads);
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const;
    void accept_shape();

    bool rotates() const;
    TurningNodes* turning_nodes() const;  // of the one group that rotates, or none
    std::span<const NodeRow> inverse_inertia() const;  // of the one group that rotates
    KickReport kick(const Kick& step, int threads);
    void drift(double dt, int threads);
    void hold();
    void stop();
    void hold_rotation(std::int32_t node, int axis);

    std::size_t stiffest() const;
    std::size_t most_compressed(const Nodes& nodes) const;
    const std::string& part_name(std::size_t element) const { return name_[part_of_[element]]; }

    /// [Pa] (n_elements, 6) xx yy zz xy yz zx, in the mesh's order; without bulk viscosity.
    std::vector<double> stress() const;
    /// The same on both faces of shells, 0 of solids; empty when there are no shells.
    struct FaceStress {
        std::vector<double> top, bottom;
    };
    FaceStress face_stress() const;
    /// Equivalent plastic strain (n_elements) so far, in the mesh's order; 0 of elastic parts.
    std::vector<double> plastic_strain() const;
    void archive(Archive& a);

 private:
    bool limits_step(const std::unique_ptr<ElementGroup>& group) const;

    std::vector<std::unique_ptr<ElementGroup>> groups_;
    const Hexahedra* implicit_ = nullptr;  // one of them
    std::vector<std::int32_t> part_of_;   // [n_elements] -1: none
    std::vector<std::int32_t> group_of_;  // [n_elements] -1: none
    std::vector<std::string> name_;       // of parts
    std::size_t deformable_ = 0;
    double wave_speed_ = 0;  // [m/s] of any part
    bool any_plastic_ = false;
};

}  // namespace undertow::fem
