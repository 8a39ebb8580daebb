#include "fem_solver/setup/skin.hpp"

#include "wire/errors.hpp"

namespace undertow::fem {
Skin::Skin(const Mesh& mesh) : source_(mesh.source) {
    for_each_face(mesh, [&](std::size_t, const Quad& q) {
        Face& face = face_[sorted_facet(q)];
        face.node = q;
        ++face.elements;
    });
    for (const Quad& q : mesh.shells) shell_.insert(sorted_facet(q));
}

Quad Skin::outward(const Quad& quad, const std::string& what) const {
    const auto found = face_.find(sorted_facet(quad));
    if (shell_.count(sorted_facet(quad)) > 0 && found == face_.end()) return quad;
    if (found == face_.end())
        throw InputError(source_ + ": " + what +
                         " is not a face of any solid element, and no shell; mesh surface and "
                         "volume together.");
    if (found->second.elements > 1)
        throw InputError(source_ + ": " + what +
                         " lies between two elements; a facet set must lie on the outer skin.");
    return found->second.node;
}

Quad Skin::outside(const Quad& quad, const std::string& what) const {
    if (face_.count(sorted_facet(quad)) > 0)
        throw InputError(source_ + ": " + what +
                         " is a face of an element, but its [[fem.surface]] is immobile: that "
                         "is for facets of no element; remove immobile, or hold the elements by a "
                         "[[fem.support]].");
    return quad;
}

}  // namespace undertow::fem
