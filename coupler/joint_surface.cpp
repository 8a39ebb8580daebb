#include "coupler/joint_surface.hpp"

#include <algorithm>

#include "contact/surface.hpp"
#include "wire/errors.hpp"

namespace undertow::coupler {

namespace {

std::int32_t index_of(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return std::int32_t(found - names.begin());
    names.push_back(name);
    return std::int32_t(names.size() - 1);
}

void check(const wire::Mesh& mesh) {
    const std::string name = "Mesh '" + mesh.mesh + "': ";
    if (mesh.quad.empty())
        throw PeerError("E_MESH", name + "it has no facets; name a facet set in [[fem.surface]].");
    if (mesh.thickness != 0)
        throw PeerError("E_MESH", name + "a shell of thickness " + std::to_string(mesh.thickness) +
                                      " m cannot be coupled by its mid-surface; announce both of "
                                      "its faces with thickness 0.");
    const std::string defect = contact::find_defect(mesh.x, mesh.quad);
    if (!defect.empty()) throw PeerError("E_MESH", name + defect + ".");
}

}  // namespace

JointSurface join_surfaces(const std::vector<wire::Mesh>& meshes) {
    JointSurface joint;
    for (const wire::Mesh& mesh : meshes) {
        check(mesh);
        const std::int32_t first_node = std::int32_t(joint.mass.size());
        joint.x.insert(joint.x.end(), mesh.x.begin(), mesh.x.end());
        joint.mass.insert(joint.mass.end(), mesh.mass.begin(), mesh.mass.end());
        for (std::int32_t node : mesh.quad) joint.quad.push_back(first_node + node);
        std::vector<std::int32_t> number;
        for (const std::string& group : mesh.groups) number.push_back(index_of(joint.names, group));
        for (std::size_t facet = 0; facet < mesh.quad.size() / 4; ++facet)
            joint.group.push_back(mesh.group.empty() ? index_of(joint.names, mesh.mesh)
                                                     : number[mesh.group[facet]]);
    }
    return joint;
}

}  // namespace undertow::coupler
