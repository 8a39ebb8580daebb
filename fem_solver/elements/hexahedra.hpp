#pragma once
// All one-point hexahedra of the mesh: storage, and one step of all of them.

#include "fem_solver/elements/batched_group.hpp"
#include "fem_solver/elements/hexahedron.hpp"

namespace undertow::fem {

class Hexahedra final : public BatchedGroup<8, HexahedronConstants<Lanes>, HexahedronState<Lanes>> {
 public:
    /// Takes undeformed shapes from the mesh; every element in one part at most.
    Hexahedra(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity);

    void set_stress(std::int32_t element, const Symmetric<double>& stress) override;
    ElementsReport step(Nodes& nodes, double dt, int threads) override;
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const override;
    ExtremeElement most_compressed(const Nodes& nodes) const override;
    void write_stress(std::span<double> stress) const override;
    /// Largest |stress|/(lambda + 2 mu): by this share of its bound tension stiffens an element.
    double largest_stress_stiffness() const;
};

}  // namespace undertow::fem
