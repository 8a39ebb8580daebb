#include "fem_solver/elements/bbar_hexahedra.hpp"

namespace undertow::fem {
namespace {

/// A corner's coordinates at(corner)[d] as modes.
template <class At>
void modes_of(At&& at, Modes<double> (&modes)[3]) {
    double x[3][8];
    for (int corner = 0; corner < 8; ++corner)
        for (int d = 0; d < 3; ++d) x[d][corner] = at(corner)[d];
    for (int d = 0; d < 3; ++d) modes[d] = to_modes(x[d]);
}

}  // namespace

BbarHexahedra::BbarHexahedra(const Mesh& mesh, const std::vector<Part>& parts,
                             const BulkViscosity& viscosity)
    : BatchedGroup(mesh, parts, viscosity, ElementOrder::of_the_mesh) {
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < n_lanes; ++l) {
            const Hexahedron& nodes = mesh.hexahedra[batches_.element(b, l)];
            Modes<double> x[3];
            modes_of([&](int corner) { return mesh.x[nodes[corner]].data(); }, x);
            double C[6][3], D;
            mean_gradient(x, C, D);
            const ElementLaw law = law_of(b, l);
            const double mass = D / 64 / law.inverse_density;
            set_constants(b, l, mass,
                          bbar_eigenvalue_bound(C, D, mass, largest_metric(x), law.lambda, law.mu));
        }
}

void BbarHexahedra::set_stress(std::int32_t element, const Symmetric<double>& stress) {
    batches_.at_lanes_of(element, [&](std::size_t b, int l) {
        for (Symmetric<Lanes>& point : state_[b].stress) set_lane(point, l, stress);
    });
}

ExtremeElement BbarHexahedra::most_compressed(const Nodes& nodes) const {
    return batches_.smallest([&](std::size_t b, int l) {
        Modes<double> x[3];
        modes_of([&](int corner) { return nodes.x[batches_[b].node[corner][l]].c; }, x);
        double smallest = 1e300;
        for (int q = 0; q < n_gauss; ++q) {
            const GaussPoint at(q);
            double A[3][3], c[3][3];
            for (int i = 0; i < 3; ++i) gradient_at(x[i], at, A[i]);
            const double det = cofactors(A, c);
            if (!(det >= smallest)) smallest = det;
        }
        const double start = constants_[b].mass[l] * law_[batches_[b].part].inverse_density;
        return smallest / 64 / start;
    });
}

void BbarHexahedra::write_stress(std::span<double> stress) const {
    batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
        for (const Symmetric<Lanes>& point : state_[b].stress)
            add_lane(point, l, 1.0 / n_gauss, &stress[6 * e]);
    });
}

}  // namespace undertow::fem
