#pragma once
// All elements of one kind, as the structure sees them: virtual calls once per step and group,
// never per element. Elements go by their number in the mesh.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "fem_solver/materials/linear_elastic.hpp"
#include "fem_solver/nodes.hpp"

namespace undertow::fem {

/// One step of all elements, reduced.
struct ElementsReport {
    double strain_work = 0, hourglass_work = 0, viscous_work = 0;  // [J] of the step
    double omega2 = 0;           // [1/s2] largest eigenvalue bound
    double stiffening = 0;       // largest omega2 against the element's own reference
    double relative_volume = 1;  // smallest V/V0
    double compression = 0;      // largest Mach number at which an element closes
    double plastic_work = 0;     // [J] of the step, a part of strain_work
    double yielding = 0;         // elements that flowed in the step

    ElementsReport& operator+=(const ElementsReport& r) {
        strain_work += r.strain_work;
        hourglass_work += r.hourglass_work;
        viscous_work += r.viscous_work;
        omega2 = std::max(omega2, r.omega2);
        stiffening = std::max(stiffening, r.stiffening);
        compression = std::max(compression, r.compression);
        relative_volume = std::min(relative_volume, r.relative_volume);
        plastic_work += r.plastic_work;
        yielding += r.yielding;
        return *this;
    }
};

/// An element and the figure for which it stands out.
struct ExtremeElement {
    std::size_t element = 0;  // of the mesh
    double value = 0;
};

struct TurningNodes;

class ElementGroup {
 public:
    virtual ~ElementGroup() = default;

    virtual std::size_t size() const = 0;  // elements
    /// [kg] adds the lumped masses of the elements to those of their nodes.
    virtual void add_nodal_masses(std::vector<double>& mass) const = 0;
    /// [kg] the same of the masses that gravity acts on.
    virtual void add_nodal_weight_masses(std::vector<double>& mass) const = 0;
    /// Gives an element of the group a stress [Pa] to start with.
    virtual void set_stress(std::int32_t element, const Symmetric<double>& stress) = 0;
    virtual double omega2_start() const = 0;  // [1/s2] largest bound of any element
    /// [1/s2] present bounds (elements of the mesh); fills its own.
    virtual void write_omega2(std::span<double> omega2) const = 0;

    /// Stress and internal forces at n: subtracts them from nodes.f. dt is the step that led from
    /// n-1 to n; with 0 the forces of the present stresses, at rest. The same bits for any number
    /// of threads.
    virtual ElementsReport step(Nodes& nodes, double dt, int threads) = 0;
    /// f -= K u of the stress-free material in the present shape, for the largest frequency. Rows of
    /// u and f beyond those of x are rotations and moments of the nodes that turn.
    virtual void subtract_tangent_forces(const NodeRows& x, const NodeRows& u,
                                         NodeRows& f) const = 0;
    /// Makes the present eigenvalue bounds the reference of `stiffening`.
    virtual void accept_shape() = 0;

    // Nodes that turn: groups without rotations have nothing to do.
    virtual bool rotates() const { return false; }
    virtual TurningNodes* turning_nodes() { return nullptr; }
    /// [1/(kg m2)] of the nodes that turn, per direction; 0 where a support holds it.
    virtual std::span<const NodeRow> inverse_inertia() const { return {}; }
    /// Angular velocities, with the nodes' own kick; the report's kinetic energy is that of
    /// turning.
    virtual KickReport kick(const Kick& /*step*/, int /*threads*/) { return {}; }
    virtual void drift(double /*dt*/, int /*threads*/) {}  // rotations
    virtual void hold() {}  // instead of kick and drift: moments of the step are forgotten
    virtual void stop() {}  // all turning ends
    /// A support holds the rotation of a node of the mesh about x, y or z (0, 1, 2).
    virtual void hold_rotation(std::int32_t /*node*/, int /*axis*/) {}

    /// Largest eigenvalue bound [1/s2] in the last step (or at the start).
    virtual ExtremeElement stiffest() const = 0;
    /// Smallest V/V0 in the shape of `nodes`; one that is not a number is the worst.
    virtual ExtremeElement most_compressed(const Nodes& nodes) const = 0;
    /// [Pa] (elements of the mesh, 6) xx yy zz xy yz zx; fills the rows of its own elements.
    virtual void write_stress(std::span<double> stress) const = 0;
    /// The same on the faces of shells that their normals point out of (top) and into.
    virtual void write_face_stress(std::span<double> /*top*/, std::span<double> /*bottom*/) const {}
    /// Equivalent plastic strain so far (elements of the mesh); fills its own.
    virtual void write_plastic_strain(std::span<double> strain) const = 0;
    /// All that steps change.
    virtual void archive(Archive& a) = 0;
};

}  // namespace undertow::fem
