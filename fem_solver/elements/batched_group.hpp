#pragma once
// What groups of batched elements have in common: storage per batch, masses, reference bounds.

#include <algorithm>
#include <vector>

#include "checkpoint/archive.hpp"
#include "fem_solver/elements/batches.hpp"
#include "fem_solver/elements/element_law.hpp"
#include "fem_solver/elements/local_laws.hpp"

namespace undertow::fem {

/// What elements of a part share, from its material and their moduli.
ElementLaw make_law(const Part& part, const LinearElastic& moduli, const BulkViscosity& viscosity);
/// Mass that gravity acts on over mass; exactly 1 where the two are alike.
double weight_share(const Part& part);

/// `Constants` has mass [kg] and omega2_reference [1/s2] in lanes, `State` what an element keeps.
template <int n_corners, class Constants, class State>
class BatchedGroup : public ElementGroup {
 public:
    BatchedGroup(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity,
                 ElementOrder order_of_large)
        : parts_(parts),
          batches_(mesh, parts, order_of_large,
                   worth_fetching ? Fetch::ahead : Fetch::by_the_processor),
          constants_(batches_.size()),
          state_(batches_.size(), State{}),
          omega2_(batches_.size()) {
        bool any_plastic = false, any_hardens = false;
        for (Part& part : parts_) {
            law_.push_back(make_law(part, form_moduli(part.material), viscosity));
            any_plastic |= is_plastic(part.material);
            any_hardens |= hardens(part.material);
            part.elements = {};
        }
        pack_local_laws(mesh, viscosity);
        if (any_hardens) strain_points_ = State::points;
        if (any_plastic) plastic_strain_.resize(batches_.size() * strain_points_, Lanes{});
    }

    std::size_t size() const override { return batches_.elements(); }
    void add_nodal_masses(std::vector<double>& mass) const override {
        batches_.add_masses(
            mass, [&](std::size_t b) { return constants_[b].mass; }, [](int) { return 1.0; });
    }
    void add_nodal_weight_masses(std::vector<double>& mass) const override {
        batches_.add_masses(
            mass, [&](std::size_t b) { return constants_[b].mass; },
            [&](int part) { return weight_share(parts_[part]); });
    }
    double omega2_start() const override { return omega2_start_; }
    void write_omega2(std::span<double> omega2) const override {
        batches_.for_each_element(
            [&](std::size_t e, std::size_t b, int l) { omega2[e] = omega2_[b][l]; });
    }
    void accept_shape() override {
        for (std::size_t b = 0; b < batches_.size(); ++b) set_reference(b, omega2_[b]);
    }
    ExtremeElement stiffest() const override { return batches_.largest(omega2_); }
    void write_plastic_strain(std::span<double> strain) const override {
        if (plastic_strain_.empty()) return;
        batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
            const std::size_t points = hardens(parts_[batches_[b].part].material) ? strain_points_ : 1;
            double sum = 0;
            for (std::size_t q = 0; q < points; ++q)
                sum += plastic_strain_[b * strain_points_ + q][l];
            strain[e] = sum / double(points);
        });
    }
    const Batches<n_corners>& batches() const { return batches_; }
    void archive(Archive& a) override {
        batches_.archive_order(a);
        a.flat<double>("state", state_);
        a.flat<double>("plastic_strain", plastic_strain_);
        a.flat<double>("omega2", omega2_);
        std::vector<Lanes> reference(constants_.size());
        for (std::size_t b = 0; b < reference.size(); ++b)
            reference[b] = constants_[b].omega2_reference;
        a.flat<double>("omega2_reference", reference);
        for (std::size_t b = 0; b < reference.size(); ++b)
            set_reference(b, reference[b]);
    }

 protected:
    // [bytes] An 8-point element computes so long on its larger state that memory is hardly waited
    // for, and requests ahead cost more than that.
    static constexpr bool worth_fetching = sizeof(State) <= 2048;

    /// Figures of an element that all kinds have alike; omega2 is its bound at the start.
    void set_constants(std::size_t b, int lane, double mass, double omega2) {
        constants_[b].mass[lane] = mass;
        constants_[b].omega2_reference[lane] = omega2;
        constants_[b].length[lane] = length_of(b, lane, omega2);
        omega2_[b][lane] = omega2;
        omega2_start_ = std::max(omega2_start_, omega2);
    }

    /// [m] 2 c/omega, of the bulk viscosity: it has to shrink with the element, or a squeezed one is
    /// damped beyond what its step bears.
    double length_of(std::size_t b, int lane, double omega2) const {
        return 2 * law_of(b, lane).sound_speed / std::sqrt(omega2);
    }
    void set_reference(std::size_t b, const Lanes& omega2) {
        constants_[b].omega2_reference = omega2;
        for (int lane = 0; lane < batches_[b].valid; ++lane)
            constants_[b].length[lane] = length_of(b, lane, omega2[lane]);
    }

    bool is_local(std::size_t b) const { return !local_.empty() && local_begin_[b] >= 0; }
    /// Packed constants of a batch whose law depends on the place.
    const Lanes* local(std::size_t b) const { return &local_[local_begin_[b]]; }
    /// Figures of one element: those of its part, with its own moduli where they differ.
    ElementLaw law_of(std::size_t b, int lane) const {
        ElementLaw law = law_[batches_[b].part];
        if (!is_local(b)) return law;
        const ElementLawOf<Lanes> all = local_element_law(law, local(b));
        law.lambda = all.lambda[lane];
        law.mu = all.mu[lane];
        law.sound_speed = all.sound_speed[lane];
        law.bending_modulus = all.bending_modulus[lane];
        law.young_modulus = all.young_modulus[lane];
        return law;
    }

    // in batched_step.hpp:
    template <class Kernel>
    ElementsReport step_all(Nodes& nodes, double dt, int threads, const Kernel& kernel);
    template <class Kernel>
    void subtract_tangent(const NodeRows& x, const NodeRows& u, NodeRows& f,
                          const Kernel& kernel) const;

    std::vector<Part> parts_;  // without their element lists
    std::vector<ElementLaw> law_;
    Batches<n_corners> batches_;
    std::vector<Constants> constants_;
    std::vector<State> state_;
    std::vector<Lanes> omega2_;          // [1/s2] of the last step
    // [n_batches, strain_points_], empty when no part can yield: of materials that harden at each
    // point, of others the element's mean in the first
    std::vector<Lanes> plastic_strain_;
    std::size_t strain_points_ = 1;
    double omega2_start_ = 0;

 private:
    void pack_local_laws(const Mesh& mesh, const BulkViscosity& viscosity);

    std::vector<Lanes> local_;               // see local_laws.hpp; empty when no law depends on depth
    std::vector<std::ptrdiff_t> local_begin_;  // [n_batches] into it, -1: of a part without

    template <class Kernel, class Law>
    ElementsReport step_chunk(const Chunk& chunk, Nodes& nodes, double dt, const Law& material,
                              const Kernel& kernel);
};

template <int n_corners, class Constants, class State>
void BatchedGroup<n_corners, Constants, State>::pack_local_laws(const Mesh& mesh,
                                                                const BulkViscosity& viscosity) {
    const auto pack = [&]<class Law>(std::size_t b, const WithDepth<Law>& law) {
        constexpr int n = n_strengths(static_cast<const Law*>(nullptr));
        local_begin_.resize(batches_.size(), -1);
        local_begin_[b] = std::ptrdiff_t(local_.size());
        local_.resize(local_.size() + packed::strengths + n * State::points);
        Lanes* figure = &local_[local_begin_[b]];
        for (int lane = 0; lane < n_lanes; ++lane) {
            const std::span<const std::int32_t> corners = mesh.corners(batches_.element(b, lane));
            double height[n_corners], z[State::points];
            for (int c = 0; c < n_corners; ++c) height[c] = mesh.x[corners[c]][2];
            const LinearElastic moduli =
                law.at(height_of(mesh, batches_.element(b, lane))).elastic;
            figure[packed::sound_speed][lane] =
                make_law(parts_[batches_[b].part], moduli, viscosity).sound_speed;
            figure[packed::lambda][lane] = moduli.lambda;
            figure[packed::mu][lane] = moduli.mu;
            heights_of_points(height, z);
            for (int q = 0; q < State::points; ++q)
                put_strength(law.at(z[q]), figure + packed::strengths + n * q, lane);
        }
    };
    for (std::size_t b = 0; b < batches_.size(); ++b)
        std::visit(
            [&]<class Law>(const Law& law) {
                if constexpr (depends_on_depth<Law>) pack(b, law);
            },
            parts_[batches_[b].part].material);
}

UNDERTOW_KERNEL void set_lane(Symmetric<Lanes>& s, int lane, const Symmetric<double>& value) {
    s.xx[lane] = value.xx;
    s.yy[lane] = value.yy;
    s.zz[lane] = value.zz;
    s.xy[lane] = value.xy;
    s.yz[lane] = value.yz;
    s.zx[lane] = value.zx;
}
/// row += share s of a lane; xx yy zz xy yz zx
UNDERTOW_KERNEL void add_lane(const Symmetric<Lanes>& s, int lane, double share, double* row) {
    row[0] += share * s.xx[lane];
    row[1] += share * s.yy[lane];
    row[2] += share * s.zz[lane];
    row[3] += share * s.xy[lane];
    row[4] += share * s.yz[lane];
    row[5] += share * s.zx[lane];
}

}  // namespace undertow::fem
