#include "fem_solver/setup/skin.hpp"

#include <algorithm>

#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

Quad sorted(Quad q) {
    std::sort(q.begin(), q.end());
    return q;
}

}  // namespace

Skin::Skin(const Mesh& mesh) : source_(mesh.source) {
    for (const Hexahedron& h : mesh.hexahedra)
        for (const auto& corners : hexahedron_face) {
            const Quad q = {h[corners[0]], h[corners[1]], h[corners[2]], h[corners[3]]};
            Face& face = face_[sorted(q)];
            face.node = q;
            ++face.elements;
        }
}

Quad Skin::outward(const Quad& quad, const std::string& what) const {
    const auto found = face_.find(sorted(quad));
    if (found == face_.end())
        throw InputError(source_ + ": " + what +
                         " is not a face of any hexahedron; mesh surface and volume together.");
    if (found->second.elements > 1)
        throw InputError(source_ + ": " + what +
                         " lies between two hexahedra; a facet set must lie on the outer skin.");
    return found->second.node;
}

Quad Skin::outside(const Quad& quad, const std::string& what) const {
    if (face_.count(sorted(quad)) > 0)
        throw InputError(source_ + ": " + what +
                         " is a face of a hexahedron, but its [[fem.surface]] is immobile: that "
                         "is for facets of no element; remove immobile, or hold the elements by a "
                         "[[fem.support]].");
    return quad;
}

}  // namespace undertow::fem
