#pragma once
// All 8-point hexahedra with mean dilatation: storage, and one step of all of them.

#include "fem_solver/elements/batched_group.hpp"
#include "fem_solver/elements/bbar_hexahedron.hpp"

namespace undertow::fem {

class BbarHexahedra final : public BatchedGroup<8, BbarConstants<Lanes>, BbarState<Lanes>> {
 public:
    /// Takes undeformed shapes from the mesh; every element in one part at most.
    BbarHexahedra(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity);

    void set_stress(std::int32_t element, const Symmetric<double>& stress) override;
    ElementsReport step(Nodes& nodes, double dt, int threads) override;
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const override;
    ExtremeElement most_compressed(const Nodes& nodes) const override;
    void write_stress(std::span<double> stress) const override;  // mean of the points
};

}  // namespace undertow::fem
