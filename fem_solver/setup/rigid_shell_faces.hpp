#pragma once
// Both faces of rigid shells that are coupled or touched: nodes of the body half a thickness off
// the middle surface on either side. A force there is a force and a moment on the body, as any
// other.

#include <map>
#include <string>
#include <vector>

#include "fem_solver/mesh.hpp"
#include "fem_solver/rigid/rigid_set.hpp"

namespace undertow::fem {

class RigidShellFaces {
 public:
    /// Adds the nodes of the faces to mesh and bodies: for every [[fem.surface]], and every surface
    /// of a [[fem.contact]], that has shells of rigid bodies. The faces take their nodes' masses,
    /// half of a shell's on each side. InputError where shells of one set look against each other.
    RigidShellFaces(const Case& c, Mesh& mesh, std::vector<RigidSet>& bodies);

    /// The facet set with both faces in the place of each such shell, normals outward.
    const std::vector<Quad>& facets_of(const Mesh& mesh, const std::string& set,
                                       const std::string& key) const;

    /// Per facet of that list the other face of the same shell, -1 of a solid; empty where the set
    /// has no such shells.
    std::vector<std::int32_t> opposites_of(const std::string& set) const;

 private:
    std::map<std::string, std::vector<Quad>> facets_;
    std::map<std::string, std::vector<std::int32_t>> opposite_;
};

}  // namespace undertow::fem
