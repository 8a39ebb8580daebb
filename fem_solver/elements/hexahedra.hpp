#pragma once
// All hexahedra of the mesh: storage, and one step of all of them.
//
// Elements lie in batches of eight, one element per lane, each batch within one part. Batches form
// chunks of neighboring elements; chunks that share a node have different colors. A step walks the
// colors one after the other, and threads share the chunks of a color: forces on a node are always
// added in the same order, so results have the same bits for any number of threads.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fem_solver/elements/hexahedron.hpp"
#include "fem_solver/materials/material.hpp"
#include "fem_solver/mesh.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

/// One [[fem.part]] with its material.
struct Part {
    std::string name;                    // its volume set
    std::vector<std::int32_t> elements;  // of the mesh
    double density = 0;                  // [kg/m3]
    Material material;
    std::optional<double> weight_density{};  // [kg/m3] that gravity acts on; none = density
    bool implicit = false;  // limits no step, see fem_solver/implicit
};

/// By how their elements are stepped.
enum class WhichParts { all, with_explicit_step, with_implicit_step };

struct BulkViscosity {
    double linear = 0.06;    // b1: damps the ringing of the highest modes
    double quadratic = 1.2;  // b2: smears a shock over a few elements
};

/// One step of all elements, reduced.
struct ElementsReport {
    double strain_work = 0, hourglass_work = 0, viscous_work = 0;  // [J] of the step
    double omega2 = 0;           // [1/s2] largest eigenvalue bound, of explicit parts
    double stiffening = 0;       // of them: largest omega2 against the element's own reference
    double relative_volume = 1;  // smallest V/V0
    double compression = 0;      // largest Mach number at which an element closes
    double plastic_work = 0;     // [J] of the step, a part of strain_work
    double yielding = 0;         // elements that flowed in the step
};

class Hexahedra {
 public:
    /// Takes undeformed shapes from the mesh; every element in one part at most. One in none (of a
    /// rigid body) has no mass and no stress here.
    Hexahedra(const Mesh& mesh, const std::vector<Part>& parts, const BulkViscosity& viscosity);

    std::size_t size() const { return slot_of_.size(); }  // of the mesh
    std::size_t deformable() const;                       // of the parts
    /// [kg] lumped nodal masses: an eighth of the element's mass at each of its nodes.
    std::vector<double> nodal_masses(std::size_t n_nodes) const;
    /// [kg] the same of the masses that gravity acts on.
    std::vector<double> nodal_weight_masses(std::size_t n_nodes) const;
    /// Gives an element a stress [Pa] to start with.
    void set_stress(std::int32_t element, const Symmetric<double>& stress);

    /// Stress, hourglass and internal forces at n: subtracts them from nodes.f. dt is the step that
    /// led from n-1 to n (0 at the start).
    ElementsReport step(Nodes& nodes, double dt, int threads);

    /// f -= K u of the stress-free material in the present shape, for the largest frequency.
    void subtract_tangent_forces(const NodeRows& x, const NodeRows& u, NodeRows& f,
                                 WhichParts which = WhichParts::with_explicit_step) const;

    /// [1/s2] largest eigenvalue bound of such elements in the last step (or at the start).
    double largest_omega2(WhichParts which) const;
    /// Largest |stress|/(lambda + 2 mu) of such elements: by this share of its bound tension
    /// stiffens an element.
    double largest_stress_stiffness(WhichParts which) const;

    /// Makes the present eigenvalue bounds the reference of `stiffening`.
    void accept_shape();

    /// Element of an explicit part whose eigenvalue bound was the largest in the last step (or at
    /// the start).
    std::size_t stiffest() const;
    /// Element with the smallest V/V0 in the shape of `nodes`.
    std::size_t most_compressed(const Nodes& nodes) const;

    /// [1/s2] largest bound at the start, of explicit parts.
    double omega2_start() const { return omega2_start_; }
    const std::string& part_name(std::size_t element) const;
    double largest_wave_speed() const;  // [m/s] of any part

    /// [Pa] (n_elements, 6) xx yy zz xy yz zx, in the mesh's order; without bulk viscosity.
    std::vector<double> stress() const;
    bool any_plastic() const { return !plastic_strain_.empty(); }  // whether a part can yield
    /// Equivalent plastic strain (n_elements) so far, in the mesh's order; 0 of elastic parts.
    std::vector<double> plastic_strain() const;
    const HexahedronState<Lanes>& batch_state(std::size_t batch) const { return state_[batch]; }
    int colors() const { return int(color_begin_.size()) - 1; }

 private:
    struct alignas(64) Batch {
        std::int32_t node[8][n_lanes];  // corner, lane
        int valid = 0;                  // lanes in use; the others repeat the last one
        int part = 0;
        std::int32_t first_slot = 0;
    };
    struct Chunk {
        std::int32_t begin, end;  // batches, of one part
    };
    ElementsReport step_chunk(const Chunk& chunk, Nodes& nodes, double dt);
    template <class Law>
    ElementsReport step_chunk(const Chunk& chunk, Nodes& nodes, double dt, const Law& material);
    void build_batches(const Mesh& mesh, const std::vector<Part>& parts);
    void build_constants(const Mesh& mesh);
    void color_chunks(std::size_t n_nodes);
    bool is_among(std::size_t batch, WhichParts which) const;

    std::vector<Part> parts_;  // without their element lists
    std::vector<HexahedronLaw> law_;
    std::vector<Batch> batch_;
    std::vector<HexahedronConstants<Lanes>> constants_;
    std::vector<HexahedronState<Lanes>> state_;
    std::vector<Lanes> omega2_;             // [1/s2] of the last step
    std::vector<Lanes> plastic_strain_;     // [n_batches], empty when no part can yield
    std::vector<std::int32_t> slot_of_;     // element of the mesh -> batch * 8 + lane
    std::vector<std::int32_t> element_at_;  // and back; padding repeats its element
    std::vector<Chunk> chunk_;              // sorted by color
    std::vector<std::int32_t> color_begin_;
    std::vector<ElementsReport> chunk_report_;
    double omega2_start_ = 0;
};

}  // namespace undertow::fem
