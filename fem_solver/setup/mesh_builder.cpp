#include "fem_solver/setup/mesh_builder.hpp"

#include <algorithm>
#include <utility>

#include "fem_solver/setup/skin.hpp"
#include "wire/errors.hpp"

namespace undertow::fem {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

MeshBuilder::MeshBuilder(std::string source, std::string set_word, SetsOfCase of_case)
    : set_word_(std::move(set_word)), of_case_(std::move(of_case)) {
    mesh_.source = std::move(source);
}

bool MeshBuilder::is_immobile(const std::string& set) const {
    return holds(of_case_.immobile, set);
}
bool MeshBuilder::is_shell(const std::string& set) const {
    return holds(of_case_.shells, set);
}

std::int32_t MeshBuilder::add_node(const Vec3& x) {
    mesh_.x.push_back(x);
    return std::int32_t(mesh_.x.size() - 1);
}

void MeshBuilder::add_hexahedron(std::int64_t tag, const std::int32_t* n, const Names& sets) {
    for (const std::string& set : sets) add_hexahedron_to(set, mesh_.hexahedra.size());
    mesh_.hexahedra.push_back({n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]});
    mesh_.element_tag.push_back(tag);
}

void MeshBuilder::add_tetrahedron(std::int64_t tag, const std::int32_t* n, const Names& sets) {
    for (const std::string& set : sets) add_tetrahedron_to(set, mesh_.tetrahedra.size());
    mesh_.tetrahedra.push_back({n[0], n[1], n[2], n[3]});
    tetrahedron_tag_.push_back(tag);
}

void MeshBuilder::add_hexahedron_to(const std::string& set, std::size_t hexahedron) {
    mesh_.volume_sets[set].push_back(std::int32_t(hexahedron));
}
void MeshBuilder::add_tetrahedron_to(const std::string& set, std::size_t tetrahedron) {
    tetrahedron_sets_[set].push_back(std::int32_t(tetrahedron));
}

void MeshBuilder::add_quad(std::int64_t tag, const std::int32_t* n, const Names& sets,
                           OffSkin off) {
    const Quad quad{n[0], n[1], n[2], n[3]};
    bool element = false;
    for (const std::string& set : sets) {
        facets_[set].push_back({quad, tag, off, false, {}});
        if (!is_shell(set)) continue;
        element = true;
        shell_sets_[set].push_back(std::int32_t(mesh_.shells.size()));
    }
    if (!element) return;
    mesh_.shells.push_back(quad);
    shell_tag_.push_back(tag);
}

void MeshBuilder::add_triangle(std::int64_t tag, const std::int32_t* n, const Names& sets,
                               OffSkin off) {
    for (const std::string& set : sets)
        facets_[set].push_back({{n[0], n[1], n[2], n[2]}, tag, off, false, {}});
}

void MeshBuilder::add_facet(const std::string& set, const Quad& facet, std::string what) {
    facets_[set].push_back({facet, 0, OffSkin::refuse_set, false, std::move(what)});
}

void MeshBuilder::add_face_if_free(const std::string& set, const Quad& face) {
    facets_[set].push_back({face, 0, OffSkin::refuse_set, true, {}});
}

void MeshBuilder::refuse_set(const std::string& set, const std::string& why) {
    mesh_.refused_sets[set] = why;
    facets_.erase(set);
    for (auto* sets : {&mesh_.volume_sets, &mesh_.node_sets, &tetrahedron_sets_, &shell_sets_})
        sets->erase(set);
}

void MeshBuilder::add_nodes(const std::string& set, std::span<const std::int32_t> n) {
    std::vector<std::int32_t>& nodes = mesh_.node_sets[set];
    nodes.insert(nodes.end(), n.begin(), n.end());
}

void MeshBuilder::number_elements() {
    const auto append = [&](const auto& sets, const std::vector<std::int64_t>& tags) {
        const std::int32_t first = std::int32_t(mesh_.element_tag.size());
        for (const auto& [name, elements] : sets)
            for (std::int32_t e : elements) mesh_.volume_sets[name].push_back(first + e);
        mesh_.element_tag.insert(mesh_.element_tag.end(), tags.begin(), tags.end());
    };
    append(tetrahedron_sets_, tetrahedron_tag_);
    append(shell_sets_, shell_tag_);
}

std::string MeshBuilder::name_of_facet(const std::string& set, const Facet& facet) const {
    if (!facet.what.empty()) return facet.what;
    const bool triangle = facet.node[2] == facet.node[3];
    return (triangle ? "triangle " : "quad ") + std::to_string(facet.tag) + " of " + set_word_ +
           " \"" + set + "\"";
}

/// Facets of solids look outward; those of shells and immobile ones look as the file has them.
void MeshBuilder::orient(const std::string& set, const std::vector<Facet>& facets,
                         const Skin& skin) {
    const bool shell = is_shell(set), immobile = is_immobile(set);
    std::vector<Quad> oriented;
    for (const Facet& facet : facets) {
        if (facet.only_free && skin.between_two(facet.node)) continue;
        const std::string what = name_of_facet(set, facet);
        if (shell && facet.node[2] == facet.node[3])
            throw InputError(mesh_.source + ": " + what +
                             " is of a shell; mesh shells with 4-node quads.");
        if (facet.off == OffSkin::shell && !shell && !skin.has(facet.node))
            throw InputError(mesh_.source + ": " + what +
                             " is a shell of no part; name one of its sets in a [[fem.part]] with "
                             "element = \"shell\" (4-node quads), or take it out.");
        if (!shell && facet.off == OffSkin::refuse_set && !immobile) {
            const std::string trouble = skin.trouble(facet.node);
            if (!trouble.empty()) return refuse_facets(set, facets, what + trouble);
        }
        oriented.push_back(shell      ? facet.node
                           : immobile ? skin.outside(facet.node, what)
                                      : skin.outward(facet.node, what));
    }
    mesh_.facet_sets[set] = std::move(oriented);
}

void MeshBuilder::orient_facets() {
    const Skin skin(mesh_);
    for (const auto& [name, facets] : facets_) orient(name, facets, skin);
}

void MeshBuilder::refuse_facets(const std::string& set, const std::vector<Facet>& facets,
                                const std::string& why) {
    mesh_.refused_sets[set] = why;
    for (const Facet& facet : facets) add_nodes(set, facet.node);
}

void MeshBuilder::drop_unused_nodes() {
    std::vector<std::int32_t> renumbered(mesh_.x.size(), -1);
    for (std::size_t e = 0; e < mesh_.n_elements(); ++e)
        for (std::int32_t n : mesh_.corners(e)) renumbered[n] = 0;
    for (const auto& [name, quads] : mesh_.facet_sets)
        if (is_immobile(name))
            for (const Quad& q : quads)
                for (std::int32_t n : q) renumbered[n] = 0;
    std::vector<Vec3> used;
    for (std::size_t n = 0; n < renumbered.size(); ++n)
        if (renumbered[n] == 0) {
            renumbered[n] = std::int32_t(used.size());
            used.push_back(mesh_.x[n]);
        }
    mesh_.x = std::move(used);
    const auto renumber = [&](auto& elements) {
        for (auto& element : elements)
            for (std::int32_t& n : element) n = renumbered[n];
    };
    renumber(mesh_.hexahedra);
    renumber(mesh_.tetrahedra);
    renumber(mesh_.shells);
    for (auto& [name, quads] : mesh_.facet_sets)  // on the skin or immobile: in use
        for (Quad& q : quads)
            for (std::int32_t& n : q) n = renumbered[n];
    for (auto& [name, set] : mesh_.node_sets) {
        std::vector<std::int32_t> kept;
        for (std::int32_t n : set)
            if (renumbered[n] >= 0) kept.push_back(renumbered[n]);
        std::sort(kept.begin(), kept.end());
        kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
        set = std::move(kept);
    }
}

Mesh MeshBuilder::finish() {
    if (mesh_.n_elements() == 0)
        throw InputError(mesh_.source +
                         ": the mesh has no 8-node hexahedra, no 4-node tetrahedra and no shells.");
    number_elements();
    orient_facets();
    drop_unused_nodes();
    return std::move(mesh_);
}

}  // namespace undertow::fem
