#pragma once
// All tetrahedra with averaged pressure: storage, and one step of all of them.

#include <array>

#include "fem_solver/elements/batched_group.hpp"
#include "fem_solver/elements/tetrahedron.hpp"

namespace undertow::fem {

class Tetrahedra final
    : public BatchedGroup<4, TetrahedronConstants<Lanes>, TetrahedronState<Lanes>> {
 public:
    /// Takes undeformed shapes from the mesh; every element in one part at most. Patches lie within
    /// a part: pressures jump where materials meet.
    Tetrahedra(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity);

    void set_stress(std::int32_t element, const Symmetric<double>& stress) override;
    ElementsReport step(Nodes& nodes, double dt, int threads) override;
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const override;
    ExtremeElement most_compressed(const Nodes& nodes) const override;
    void write_stress(std::span<double> stress) const override;

    std::size_t patches() const { return patch_begin_.size() - 1; }

 private:
    /// Volumes of the elements and what they changed in the step [m3], [n_batches]; the patches'
    /// dilatation.
    struct Dilatation {
        std::vector<Lanes> volume, change;
        std::vector<double> of_patch;
    };

    struct WithDilatation;

    void number_patches(const Mesh& mesh, const std::vector<Part>& parts);
    Dilatation make_dilatation() const;
    void find_volumes(std::size_t batch, const NodeRows& x, const NodeRows& v, double dt,
                      Dilatation& out) const;
    void average(Dilatation& out, int threads) const;
    void average_mean_stress(int threads);
    double press(Nodes& nodes, int threads);
    Lanes dilatation(std::size_t batch, const Dilatation& from) const;

    std::vector<std::array<std::int32_t, n_lanes>> patch_of_;  // [n_batches]
    // Of patch p the slots (batch * 8 + lane) from patch_slot_[patch_begin_[p]] on: sums are always
    // taken in this order.
    std::vector<std::int32_t> patch_begin_, patch_slot_;
    Dilatation dilatation_;
    // Where a material dilates, else empty: [Pa] mean stress of the patches beyond what elements were
    // given at the start, [n_patches], and the latter, [n_batches].
    std::vector<double> mean_stress_;
    std::vector<Lanes> start_mean_;
};

}  // namespace undertow::fem
