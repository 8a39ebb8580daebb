#include "fem_solver/mesh.hpp"

#include <algorithm>
#include <cstdio>

#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

template <class Sets>
void list_names(const Sets& sets, std::string& names) {
    for (const auto& [name, set] : sets) names += (names.empty() ? "\"" : ", \"") + name + "\"";
}

/// InputError when the file has the set, but not so that it can be used.
void check_refused(const Mesh& mesh, const std::string& set, const std::string& key) {
    if (const auto found = mesh.refused_sets.find(set); found != mesh.refused_sets.end())
        throw InputError(key + ": the set \"" + set + "\" of " + mesh.source +
                         " cannot be used: " + found->second);
}

std::vector<std::int32_t> sorted_unique(std::vector<std::int32_t> nodes) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

}  // namespace

std::vector<std::int32_t> Mesh::nodes_of(const std::string& set, const std::string& key) const {
    std::vector<std::int32_t> nodes;
    bool known = false;
    if (const auto found = node_sets.find(set); found != node_sets.end()) {
        nodes = found->second;
        known = true;
    }
    if (const auto found = facet_sets.find(set); found != facet_sets.end()) {
        for (const Quad& quad : found->second) nodes.insert(nodes.end(), quad.begin(), quad.end());
        known = true;
    }
    if (const auto found = volume_sets.find(set); found != volume_sets.end()) {
        for (std::int32_t e : found->second) {
            const std::span<const std::int32_t> n = corners(e);
            nodes.insert(nodes.end(), n.begin(), n.end());
        }
        known = true;
    }
    if (!known) {
        check_refused(*this, set, key);
        std::string names;
        list_names(node_sets, names);
        list_names(facet_sets, names);
        list_names(volume_sets, names);
        throw InputError(key + ": the mesh " + source + " has no set \"" + set + "\"; it has " +
                         (names.empty() ? "none" : names) + ".");
    }
    return sorted_unique(std::move(nodes));
}

const std::vector<Quad>& Mesh::facets_of(const std::string& set, const std::string& key) const {
    const auto found = facet_sets.find(set);
    if (found == facet_sets.end()) {
        check_refused(*this, set, key);
        std::string names;
        list_names(facet_sets, names);
        throw InputError(key + ": the mesh " + source + " has no facet set \"" + set +
                         "\"; it has " + (names.empty() ? "none" : names) + ".");
    }
    return found->second;
}

const std::vector<std::int32_t>& Mesh::elements_of(const std::string& set,
                                                   const std::string& key) const {
    const auto found = volume_sets.find(set);
    if (found == volume_sets.end()) {
        check_refused(*this, set, key);
        std::string names;
        list_names(volume_sets, names);
        throw InputError(key + ": the mesh " + source + " has no volume set \"" + set +
                         "\"; it has " + (names.empty() ? "none" : names) + ".");
    }
    return found->second;
}

ElementShape Mesh::shape_of(std::size_t element) const {
    if (element < hexahedra.size()) return ElementShape::hexahedron;
    return element < hexahedra.size() + tetrahedra.size() ? ElementShape::tetrahedron
                                                          : ElementShape::shell;
}

std::span<const std::int32_t> Mesh::corners(std::size_t element) const {
    if (element < hexahedra.size()) return hexahedra[element];
    element -= hexahedra.size();
    if (element < tetrahedra.size()) return tetrahedra[element];
    return shells[element - tetrahedra.size()];
}

std::string Mesh::element_name(std::size_t element) const {
    return std::string(name_of(shape_of(element))) + " " + std::to_string(element_tag[element]);
}

const char* name_of(ElementShape shape) {
    switch (shape) {
        case ElementShape::hexahedron:
            return "hexahedron";
        case ElementShape::tetrahedron:
            return "tetrahedron";
        default:
            return "shell";
    }
}

Quad sorted_facet(Quad facet) {
    // of a triangle the third node comes twice; which one that is depends on where it begins
    if (facet[2] == facet[3]) facet[3] = *std::min_element(facet.begin(), facet.begin() + 3);
    std::sort(facet.begin(), facet.end());
    return facet;
}

double height_of(const Mesh& mesh, std::size_t element) {
    const std::span<const std::int32_t> corners = mesh.corners(element);
    double z = 0;
    for (std::int32_t n : corners) z += mesh.x[n][2] / double(corners.size());
    return z;
}

std::string point_text(const Vec3& x) {
    char text[80];
    std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g) m", x[0], x[1], x[2]);
    return text;
}

}  // namespace undertow::fem
