#pragma once
// All quadrilateral shells of the mesh: storage, their nodes' rotations, and one step of all of
// them.

#include <array>
#include <variant>

#include "fem_solver/elements/batches.hpp"
#include "fem_solver/elements/element_group.hpp"
#include "fem_solver/shells/plastic_section.hpp"
#include "fem_solver/shells/shell.hpp"
#include "fem_solver/shells/turning_nodes.hpp"

namespace undertow::fem {

class Shells final : public ElementGroup {
 public:
    /// Takes undeformed shapes from the mesh; elements of `parts` are shells with a thickness.
    Shells(const Mesh& mesh, const std::vector<Part>& parts);

    std::size_t size() const override { return batches_.elements(); }
    void add_nodal_masses(std::vector<double>& mass) const override;
    void add_nodal_weight_masses(std::vector<double>& mass) const override;
    void set_stress(std::int32_t element, const Symmetric<double>& stress) override;
    double omega2_start() const override { return omega2_start_; }
    void write_omega2(std::span<double> omega2) const override {
        batches_.for_each_element(
            [&](std::size_t e, std::size_t b, int l) { omega2[e] = omega2_[b][l]; });
    }

    ElementsReport step(Nodes& nodes, double dt, int threads) override;
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f) const override;
    void accept_shape() override;

    bool rotates() const override { return true; }
    TurningNodes* turning_nodes() override { return &turning_; }
    std::span<const NodeRow> inverse_inertia() const override { return turning_.inverse_inertia; }
    KickReport kick(const Kick& step, int threads) override;
    void drift(double dt, int threads) override;
    void hold() override { turning_.clear_moments(); }
    void stop() override { turning_.stop(); }
    void hold_rotation(std::int32_t node, int axis) override { turning_.hold(node, axis); }

    ExtremeElement stiffest() const override { return batches_.largest(omega2_); }
    ExtremeElement most_compressed(const Nodes& nodes) const override;
    /// Of the middle surface.
    void write_stress(std::span<double> stress) const override;
    void write_face_stress(std::span<double> top, std::span<double> bottom) const override;
    /// The largest of the points through the thickness.
    void write_plastic_strain(std::span<double> strain) const override;
    void archive(Archive& a) override;

    const TurningNodes& turning() const { return turning_; }
    TurningNodes& turning() { return turning_; }

    /// N [N/m] and M [N] (xx, yy, xy) along the element's axes.
    Resultants<double> resultants(std::int32_t element) const;
    const ShellState<Lanes>& batch_state(std::size_t batch) const { return state_[batch]; }

 private:
    struct alignas(64) TurningCorners {
        std::int32_t node[4][n_lanes];  // rows of turning_
    };
    struct Axes {
        Lanes e1[3], e2[3];
    };
    using Section = std::variant<ElasticSection, PlasticSection>;

    /// A plane stress along an element's axes as a row xx yy zz xy yz zx.
    void write_row(const double (&plane)[3], std::size_t b, int lane, double* row) const;
    void build_constants(const Mesh& mesh);
    void build_turning(const Mesh& mesh);
    template <class Law>
    ElementsReport step_chunk(const Chunk& chunk, Nodes& nodes, double dt, const Law& section);

    std::vector<Part> parts_;  // without their element lists
    std::vector<ShellLaw> law_;
    std::vector<Section> section_;
    Batches<4> batches_;
    std::vector<TurningCorners> corners_;
    std::vector<ShellConstants<Lanes>> constants_;
    std::vector<ShellState<Lanes>> state_;
    std::vector<Resultants<Lanes>> resultants_;
    std::vector<LayeredState<Lanes>> layers_;  // of the batches that can yield
    std::vector<std::int32_t> layers_at_;      // batch -> layers_; -1: elastic
    std::vector<Axes> axes_;                   // of the last step, for output
    std::vector<Lanes> omega2_;                // [1/s2] of the last step
    TurningNodes turning_;
    double omega2_start_ = 0;
};

}  // namespace undertow::fem
