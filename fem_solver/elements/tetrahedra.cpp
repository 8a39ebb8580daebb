#include "fem_solver/elements/tetrahedra.hpp"

#include <algorithm>

#include "fem_solver/elements/patches.hpp"

namespace undertow::fem {
namespace {

// With 8 a mesh has about as many patches as nodes: a third as many constraints as it has freedoms,
// as hexahedra have. 6 is as good, with fewer it locks.
constexpr int patch_size = 8;

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
    : BatchedGroup(mesh, parts, viscosity, ElementOrder::of_the_mesh) {
    for (std::size_t b = 0; b < batches_.size(); ++b)
        for (int l = 0; l < n_lanes; ++l) {
            const std::span<const std::int32_t> nodes = mesh.corners(batches_.element(b, l));
            double c[3][3];
            const double det =
                cofactors_of([&](int corner) { return mesh.x[nodes[corner]].data(); }, c);
            const ElementLaw law = law_of(b, l);
            const double mass = det / 6 / law.inverse_density;
            set_constants(b, l, mass,
                          tetrahedron_eigenvalue_bound(c, det, mass, law.lambda, law.mu));
        }
    number_patches(mesh, parts);
}

void Tetrahedra::number_patches(const Mesh& mesh, const std::vector<Part>& parts) {
    patch_of_.resize(batches_.size());
    std::vector<std::vector<std::int32_t>> slots;  // of each patch
    for (std::size_t first_of = 0; first_of < parts.size(); ++first_of) {
        // parts that mass scaling split, which lie side by side, average together
        const std::string& name = parts[first_of].name;
        std::vector<std::int32_t> elements = parts[first_of].elements;
        while (first_of + 1 < parts.size() && parts[first_of + 1].name == name) {
            const std::vector<std::int32_t>& more = parts[++first_of].elements;
            elements.insert(elements.end(), more.begin(), more.end());
            std::sort(elements.begin(), elements.end());
        }
        const std::vector<std::int32_t> patch = make_patches(mesh, elements, patch_size);
        const std::size_t first = slots.size();
        for (std::size_t i = 0; i < patch.size(); ++i) {
            const std::size_t p = first + std::size_t(patch[i]);
            slots.resize(std::max(slots.size(), p + 1));
            slots[p].push_back(batches_.slot(elements[i]));
            batches_.at_lanes_of(elements[i],
                                 [&](std::size_t b, int l) { patch_of_[b][l] = std::int32_t(p); });
        }
    }
    patch_begin_ = {0};
    for (const std::vector<std::int32_t>& of_patch : slots) {
        patch_slot_.insert(patch_slot_.end(), of_patch.begin(), of_patch.end());
        patch_begin_.push_back(std::int32_t(patch_slot_.size()));
    }
    dilatation_ = make_dilatation();
    for (const Part& part : parts)
        if (dilates(part.material)) {
            mean_stress_.resize(patches());
            start_mean_.resize(batches_.size(), Lanes{});
        }
}

Tetrahedra::Dilatation Tetrahedra::make_dilatation() const {
    Dilatation out;
    out.volume.resize(batches_.size());
    out.change.resize(batches_.size());
    out.of_patch.resize(patches());
    return out;
}

void Tetrahedra::set_stress(std::int32_t element, const Symmetric<double>& stress) {
    batches_.at_lanes_of(element, [&](std::size_t b, int l) {
        set_lane(state_[b].stress, l, stress);
        if (!start_mean_.empty()) start_mean_[b][l] = (stress.xx + stress.yy + stress.zz) / 3;
    });
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
