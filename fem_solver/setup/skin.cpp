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

bool Skin::has(const Quad& quad) const {
    return face_.count(sorted_facet(quad)) > 0 || shell_.count(sorted_facet(quad)) > 0;
}

bool Skin::between_two(const Quad& quad) const {
    const auto found = face_.find(sorted_facet(quad));
    return found != face_.end() && found->second.elements > 1;
}

std::string Skin::trouble(const Quad& quad) const {
    if (!has(quad))
        return " is not a face of any solid element, and no shell; mesh surface and volume "
               "together.";
    if (between_two(quad))
        return " lies between two elements; a facet set must lie on the outer skin.";
    return "";
}

Quad Skin::outward(const Quad& quad, const std::string& what) const {
    if (const std::string why = trouble(quad); !why.empty())
        throw InputError(source_ + ": " + what + why);
    const auto found = face_.find(sorted_facet(quad));
    return found == face_.end() ? quad : found->second.node;
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
