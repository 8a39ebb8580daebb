#include "fem_solver/elements/hexahedra.hpp"

#include <cmath>

namespace undertow::fem {
namespace {

/// A corner's coordinates at(corner)[d] as modes, gradient and volume.
struct Shape {
    Modes<double> modes[3];
    double C[6][3], D;

    template <class At>
    explicit Shape(At&& at) {
        double x[3][8];
        for (int corner = 0; corner < 8; ++corner)
            for (int d = 0; d < 3; ++d) x[d][corner] = at(corner)[d];
        for (int d = 0; d < 3; ++d) modes[d] = to_modes(x[d]);
        mean_gradient(modes, C, D);
    }
};

}  // namespace

Hexahedra::Hexahedra(const Mesh& mesh, const std::vector<Part>& parts,
                     const BulkViscosity& viscosity)
    : BatchedGroup(mesh, parts, viscosity, ElementOrder::lumps) {
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < n_lanes; ++l) {
            const Hexahedron& nodes = mesh.hexahedra[batches_.element(b, l)];
            const Shape shape([&](int corner) { return mesh.x[nodes[corner]].data(); });
            const ElementLaw law = law_of(b, l);
            const double mass = shape.D / 64 / law.inverse_density;
            set_constants(b, l, mass, eigenvalue_bound(shape.C, shape.D, mass, law.lambda, law.mu));
            for (int k = 0; k < 3; ++k) {
                double squared = 0;
                for (int d = 0; d < 3; ++d)
                    squared += shape.modes[d].linear[k] * shape.modes[d].linear[k];
                constants_[b].axis_weight[k][l] = 1 / squared;
            }
        }
}

void Hexahedra::set_stress(std::int32_t element, const Symmetric<double>& stress) {
    batches_.at_lanes_of(element,
                         [&](std::size_t b, int l) { set_lane(state_[b].stress, l, stress); });
}

ExtremeElement Hexahedra::most_compressed(const Nodes& nodes) const {
    return batches_.smallest([&](std::size_t b, int l) {
        const Shape shape([&](int corner) { return nodes.x[batches_[b].node[corner][l]].c; });
        return shape.D / 64 / (constants_[b].mass[l] * law_[batches_[b].part].inverse_density);
    });
}

void Hexahedra::write_stress(std::span<double> stress) const {
    batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
        add_lane(state_[b].stress, l, 1, &stress[6 * e]);
    });
}

double Hexahedra::largest_stress_stiffness() const {
    double largest2 = 0;
    for (std::size_t b = 0; b < batches_.size(); ++b) {
        const Symmetric<Lanes>& s = state_[b].stress;
        const double modulus = law_[batches_[b].part].lambda + 2 * law_[batches_[b].part].mu;
        const Lanes norm2 = (s.xx * s.xx + s.yy * s.yy + s.zz * s.zz) +
                            2.0 * (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx);
        largest2 = std::max(largest2, largest_lane(norm2) / (modulus * modulus));
    }
    return std::sqrt(largest2);
}

}  // namespace undertow::fem
