#include "fem_solver/elements/tetrahedra.hpp"

namespace undertow::fem {
namespace {

/// Cofactors of the edges of at(corner)[d], and six times the volume.
template <class At>
double cofactors_of(At&& at, double (&c)[3][3]) {
    double x[3][4], A[3][3];
    for (int corner = 0; corner < 4; ++corner)
        for (int d = 0; d < 3; ++d) x[d][corner] = at(corner)[d];
    edges_of(x, A);
    return cofactors(A, c);
}

}  // namespace

Tetrahedra::Tetrahedra(const Mesh& mesh, const std::vector<Part>& parts,
                       const BulkViscosity& viscosity)
    : BatchedGroup(mesh, parts, viscosity) {
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < n_lanes; ++l) {
            const std::span<const std::int32_t> nodes = mesh.corners(batches_.element(b, l));
            double c[3][3];
            const double det =
                cofactors_of([&](int corner) { return mesh.x[nodes[corner]].data(); }, c);
            const ElementLaw& law = law_[batches_[b].part];
            const double mass = det / 6 / law.inverse_density;
            set_constants(b, l, mass,
                          tetrahedron_eigenvalue_bound(c, det, mass, law.lambda, law.mu));
        }
    number_patches(mesh, parts);
}

void Tetrahedra::number_patches(const Mesh& mesh, const std::vector<Part>& parts) {
    patch_nodes_.resize(batches_.size());
    std::int32_t count = 0;
    std::vector<std::int32_t> index(mesh.x.size());
    std::size_t b = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        std::fill(index.begin(), index.end(), -1);
        for (; b < batches_.size() && batches_[b].part == int(p); ++b)
            for (int corner = 0; corner < 4; ++corner)
                for (int l = 0; l < n_lanes; ++l) {
                    std::int32_t& patch = index[batches_[b].node[corner][l]];
                    if (patch < 0) patch = count++;
                    patch_nodes_[b].node[corner][l] = patch;
                }
    }
    patch_.resize(std::size_t(count));
}

void Tetrahedra::set_stress(std::int32_t element, const Symmetric<double>& stress) {
    batches_.at_lanes_of(element,
                         [&](std::size_t b, int l) { set_lane(state_[b].stress, l, stress); });
}

ExtremeElement Tetrahedra::most_compressed(const Nodes& nodes) const {
    return batches_.smallest([&](std::size_t b, int l) {
        double c[3][3];
        const double det =
            cofactors_of([&](int corner) { return nodes.x[batches_[b].node[corner][l]].c; }, c);
        return det / 6 / (constants_[b].mass[l] * law_[batches_[b].part].inverse_density);
    });
}

void Tetrahedra::write_stress(std::span<double> stress) const {
    batches_.for_each_element([&](std::size_t e, std::size_t b, int l) {
        add_lane(state_[b].stress, l, 1, &stress[6 * e]);
    });
}

}  // namespace undertow::fem
