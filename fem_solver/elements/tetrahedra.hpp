#pragma once
// All tetrahedra with averaged nodal pressure: storage, and one step of all of them.

#include "fem_solver/elements/batched_group.hpp"
#include "fem_solver/elements/tetrahedron.hpp"

namespace undertow::fem {

class Tetrahedra final
    : public BatchedGroup<4, TetrahedronConstants<Lanes>, TetrahedronState<Lanes>> {
 public:
    /// Takes undeformed shapes from the mesh; every element in one part at most. Dilatations are
    /// averaged within a part: pressures jump where materials meet.
    Tetrahedra(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity);

    void set_stress(std::int32_t element, const Symmetric<double>& stress) override;
    ElementsReport step(Nodes& nodes, double dt, int threads) override;
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const override;
    ExtremeElement most_compressed(const Nodes& nodes) const override;
    void write_stress(std::span<double> stress) const override;

 private:
    /// Volumes around a node of a part and their change in the step, [m3] each.
    using Patch = double __attribute__((vector_size(16)));
    struct PatchNodes {
        std::int32_t node[4][n_lanes];  // corner, lane -> index of a patch
    };

    void number_patches(const Mesh& mesh, const std::vector<Part>& parts);
    void add_volumes(std::size_t batch, const NodeRows& x, const NodeRows& u, double dt,
                     std::vector<Patch>& patch) const;
    static void take_dilatation(std::vector<Patch>& patch, int threads);
    Lanes dilatation(std::size_t batch, const std::vector<Patch>& patch) const;
    template <class Law>
    ElementsReport step_chunk(const Chunk& chunk, Nodes& nodes, double dt, const Law& material);

    std::vector<PatchNodes> patch_nodes_;  // [n_batches]
    std::vector<Patch> patch_;  // per node and part: volume and change; after take_dilatation() the
                                // dilatation first
};

}  // namespace undertow::fem
