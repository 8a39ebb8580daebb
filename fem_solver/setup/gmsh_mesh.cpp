#include "fem_solver/setup/gmsh_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <unordered_map>
#include <utility>

#include "fem_solver/setup/mesh_words.hpp"
#include "fem_solver/setup/skin.hpp"

namespace undertow::fem {
namespace {

struct FileFacet {
    Quad node;  // indices into the nodes as they stand in the file
    std::int64_t tag;
};

using Entity = std::pair<int, std::int64_t>;  // dimension, tag
struct EntityHash {
    std::size_t operator()(const Entity& e) const {
        return std::hash<std::int64_t>{}(e.second * 4 + e.first);
    }
};

class GmshFile {
 public:
    GmshFile(const std::string& path, const std::vector<std::string>& immobile,
             const std::vector<std::string>& shells)
        : words_(path), immobile_(immobile), shells_(shells) {
        mesh_.source = path;
    }
    Mesh read();

 private:
    void read_format();
    void read_names();
    void read_entities();
    void read_nodes();
    void read_nodes_2();
    void read_elements();
    void read_elements_2();
    void add_node(std::int64_t tag);
    int corners_of_type(std::int64_t type) const;
    void add_element(int dimension, std::int64_t type, std::int64_t tag, const std::int32_t* n,
                     const std::vector<std::int64_t>& groups);
    void add_quad(const FileFacet& quad, const std::vector<std::int64_t>& groups);
    void number_elements();
    void orient_facets();
    void drop_unused_nodes();
    bool is_immobile(const std::string& set) const {
        return std::find(immobile_.begin(), immobile_.end(), set) != immobile_.end();
    }
    bool is_shell(const std::string& set) const {
        return std::find(shells_.begin(), shells_.end(), set) != shells_.end();
    }
    std::int32_t node(std::int64_t tag) {
        const auto found = node_of_tag_.find(tag);
        if (found == node_of_tag_.end())
            words_.fail("node " + std::to_string(tag) + " is not in $Nodes");
        return found->second;
    }
    std::string group_name(int dimension, std::int64_t group) const {
        const auto found = name_.find({dimension, group});
        return found == name_.end() ? std::to_string(group) : found->second;
    }

    MeshWords words_;
    bool version_2_ = false;             // 2.2, otherwise 4.1
    std::vector<std::string> immobile_;  // facet sets without elements
    std::vector<std::string> shells_;    // groups of surfaces whose quads are elements
    Mesh mesh_;
    std::unordered_map<Entity, std::string, EntityHash> name_;  // of physical groups
    std::unordered_map<Entity, std::vector<std::int64_t>, EntityHash> groups_;  // of entities
    std::unordered_map<std::int64_t, std::int32_t> node_of_tag_;
    std::map<std::string, std::vector<FileFacet>> facets_;
    // Tetrahedra and shells come after the hexahedra, whatever their order in the file:
    std::vector<std::int64_t> tetrahedron_tag_, shell_tag_;
    std::map<std::string, std::vector<std::int32_t>> tetrahedron_sets_, shell_sets_;
};

void GmshFile::read_format() {
    const std::string version(words_.next());
    version_2_ = version == "2.2";
    if (version != "4.1" && !version_2_)
        words_.fail("Gmsh format " + version +
                    " is not read; save as version 4.1 or 2.2 ASCII (Mesh.MshFileVersion = 4.1)");
    if (words_.integer() != 0)
        words_.fail("a binary .msh is not read; save it as ASCII (Mesh.Binary = 0)");
    words_.integer();  // size of the writer's size_t
    words_.expect("$EndMeshFormat");
}

void GmshFile::read_names() {
    const std::size_t n = words_.count();
    for (std::size_t i = 0; i < n; ++i) {
        const int dimension = int(words_.integer());
        const std::int64_t tag = words_.integer();
        name_[{dimension, tag}] = words_.quoted();
    }
    words_.expect("$EndPhysicalNames");
}

void GmshFile::read_entities() {
    std::size_t n[4];
    for (std::size_t& k : n) k = words_.count();
    for (int dimension = 0; dimension < 4; ++dimension)
        for (std::size_t i = 0; i < n[dimension]; ++i) {
            const std::int64_t tag = words_.integer();
            for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) words_.number<double>();  // box
            std::vector<std::int64_t> groups(words_.count());
            for (std::int64_t& g : groups) g = std::abs(words_.integer());  // sign: orientation
            groups_[{dimension, tag}] = std::move(groups);
            if (dimension > 0)
                for (std::size_t k = words_.count(); k > 0; --k) words_.integer();  // boundary
        }
    words_.expect("$EndEntities");
}

void GmshFile::add_node(std::int64_t tag) {
    if (!node_of_tag_.emplace(tag, std::int32_t(mesh_.x.size())).second)
        words_.fail("node " + std::to_string(tag) + " is defined twice");
    Vec3 x;
    for (double& c : x) c = words_.number<double>();
    mesh_.x.push_back(x);
}

/// Version 2.2: a count, then tag x y z.
void GmshFile::read_nodes_2() {
    const std::size_t n = words_.count();
    mesh_.x.reserve(n);
    for (std::size_t i = 0; i < n; ++i) add_node(words_.integer());
    words_.expect("$EndNodes");
}

void GmshFile::read_nodes() {
    const std::size_t blocks = words_.count(), n = words_.count();
    words_.integer();  // smallest and largest tag
    words_.integer();
    mesh_.x.reserve(n);
    for (std::size_t b = 0; b < blocks; ++b) {
        words_.integer();  // entity
        words_.integer();
        if (words_.integer() != 0) words_.fail("parametric nodes are not read");
        std::vector<std::int64_t> tags(words_.count());
        for (std::int64_t& tag : tags) tag = words_.integer();
        for (std::int64_t tag : tags) add_node(tag);
    }
    if (mesh_.x.size() != n)
        words_.fail("$Nodes announces " + std::to_string(n) + " nodes and holds " +
                    std::to_string(mesh_.x.size()));
    words_.expect("$EndNodes");
}

struct ElementType {
    const char* name;
    int nodes;  // 0: not read
};
ElementType element_type(std::int64_t type) {
    switch (type) {
        case 1:
            return {"line", 2};
        case 2:
            return {"triangle", 3};
        case 3:
            return {"quad", 4};
        case 4:
            return {"tetrahedron", 4};
        case 5:
            return {"hexahedron", 8};
        case 6:
            return {"6-node prism", 0};
        case 7:
            return {"5-node pyramid", 0};
        case 8:
            return {"second-order line", 0};
        case 9:
            return {"second-order triangle", 0};
        case 10:
            return {"second-order quad", 0};
        case 11:
            return {"second-order tetrahedron", 0};
        case 12:
            return {"second-order hexahedron", 0};
        case 15:
            return {"point", 1};
        default:
            return {"element", 0};
    }
}

/// Nodes of an element of that type; refuses types that are not read.
int GmshFile::corners_of_type(std::int64_t type) const {
    const ElementType element = element_type(type);
    if (element.nodes == 0)
        words_.fail(std::string(element.name) + "s (Gmsh type " + std::to_string(type) +
                    ") are not read; mesh with 8-node hexahedra (transfinite volumes or "
                    "extrusion with Recombine) or 4-node tetrahedra, Mesh.ElementOrder = 1");
    return element.nodes;
}

void GmshFile::read_elements() {
    const std::size_t blocks = words_.count();
    for (int k = 0; k < 3; ++k) words_.integer();  // number, smallest and largest tag
    for (std::size_t b = 0; b < blocks; ++b) {
        const int dimension = int(words_.integer());
        const std::int64_t entity = words_.integer(), type = words_.integer();
        const int corners = corners_of_type(type);
        const std::vector<std::int64_t>& groups = groups_[{dimension, entity}];
        for (std::size_t i = words_.count(); i > 0; --i) {
            const std::int64_t tag = words_.integer();
            std::int32_t n[8];
            for (int k = 0; k < corners; ++k) n[k] = node(words_.integer());
            add_element(dimension, type, tag, n, groups);
        }
    }
    words_.expect("$EndElements");
}

/// Version 2.2: a count, then tag, type, number of tags, physical group, other tags, nodes. An
/// element of several groups stands in the file once for each.
void GmshFile::read_elements_2() {
    std::map<std::vector<std::int32_t>, std::int32_t> again;
    const std::size_t count = words_.count();
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t tag = words_.integer(), type = words_.integer();
        const int corners = corners_of_type(type);
        const std::size_t tags = words_.count();
        if (tags == 0)
            words_.fail("element " + std::to_string(tag) +
                        " has no tags; save it with its physical group");
        const std::int64_t group = words_.integer();
        for (std::size_t k = 1; k < tags; ++k) words_.integer();
        std::int32_t n[8];
        for (int k = 0; k < corners; ++k) n[k] = node(words_.integer());
        const int dimension = type == 15 ? 0 : type == 1 ? 1 : type <= 3 ? 2 : 3;
        std::vector<std::int64_t> groups;
        if (group != 0) groups.push_back(group);
        if (dimension == 3) {  // once an element, whatever the number of its groups
            const std::vector<std::int32_t> key(n, n + corners);
            const auto found = again.find(key);
            if (found != again.end()) {
                auto& sets = type == 5 ? mesh_.volume_sets : tetrahedron_sets_;
                for (std::int64_t g : groups) sets[group_name(3, g)].push_back(found->second);
                continue;
            }
            again[key] = std::int32_t(type == 5 ? mesh_.hexahedra.size() : mesh_.tetrahedra.size());
        }
        add_element(dimension, type, tag, n, groups);
    }
    words_.expect("$EndElements");
}

void GmshFile::add_element(int dimension, std::int64_t type, std::int64_t tag,
                           const std::int32_t* n, const std::vector<std::int64_t>& groups) {
    if (type == 5) {
        for (std::int64_t g : groups)
            mesh_.volume_sets[group_name(3, g)].push_back(std::int32_t(mesh_.hexahedra.size()));
        mesh_.hexahedra.push_back({n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]});
        mesh_.element_tag.push_back(tag);
    } else if (type == 4) {
        for (std::int64_t g : groups)
            tetrahedron_sets_[group_name(3, g)].push_back(std::int32_t(mesh_.tetrahedra.size()));
        mesh_.tetrahedra.push_back({n[0], n[1], n[2], n[3]});
        tetrahedron_tag_.push_back(tag);
    } else if (type == 3) {
        add_quad({{n[0], n[1], n[2], n[3]}, tag}, groups);
    } else if (type == 2) {
        for (std::int64_t g : groups)
            facets_[group_name(2, g)].push_back({{n[0], n[1], n[2], n[2]}, tag});
    } else {
        for (std::int64_t g : groups) {
            auto& set = mesh_.node_sets[group_name(dimension, g)];
            set.insert(set.end(), n, n + (type == 1 ? 2 : 1));
        }
    }
}

/// A facet of every group it is in, and an element once if any of them is of shells.
void GmshFile::add_quad(const FileFacet& quad, const std::vector<std::int64_t>& groups) {
    bool element = false;
    for (std::int64_t g : groups) {
        const std::string name = group_name(2, g);
        facets_[name].push_back(quad);
        if (!is_shell(name)) continue;
        element = true;
        shell_sets_[name].push_back(std::int32_t(mesh_.shells.size()));
    }
    if (!element) return;
    mesh_.shells.push_back(quad.node);
    shell_tag_.push_back(quad.tag);
}

void GmshFile::number_elements() {
    const auto append = [&](const auto& sets, const std::vector<std::int64_t>& tags) {
        const std::int32_t first = std::int32_t(mesh_.element_tag.size());
        for (const auto& [name, elements] : sets)
            for (std::int32_t e : elements) mesh_.volume_sets[name].push_back(first + e);
        mesh_.element_tag.insert(mesh_.element_tag.end(), tags.begin(), tags.end());
    };
    append(tetrahedron_sets_, tetrahedron_tag_);
    append(shell_sets_, shell_tag_);
}

/// Facets of solids look outward; those of shells and immobile ones look as the file has them.
void GmshFile::orient_facets() {
    const Skin skin(mesh_);
    for (const auto& [name, facets] : facets_)
        for (const FileFacet& facet : facets) {
            const bool triangle = facet.node[2] == facet.node[3];
            const std::string what = (triangle ? "triangle " : "quad ") +
                                     std::to_string(facet.tag) + " of physical group \"" + name +
                                     "\"";
            if (is_shell(name) && triangle)
                words_.fail(what + " is of a shell; mesh shells with 4-node quads (Recombine)");
            mesh_.facet_sets[name].push_back(is_shell(name)      ? facet.node
                                             : is_immobile(name) ? skin.outside(facet.node, what)
                                                                 : skin.outward(facet.node, what));
        }
}

void GmshFile::drop_unused_nodes() {
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

Mesh GmshFile::read() {
    bool format = false, nodes = false, elements = false;
    while (words_.skip_space()) {
        std::string section(words_.next());
        if (section.size() < 2 || section[0] != '$')
            words_.fail("expected a section like $Nodes, found \"" + section + "\"");
        section.erase(0, 1);
        if (section == "MeshFormat") {
            read_format();
            format = true;
        } else if (!format) {
            words_.fail("not a Gmsh mesh: it must begin with $MeshFormat");
        } else if (section == "PhysicalNames") {
            read_names();
        } else if (section == "Entities") {
            read_entities();
        } else if (section == "Nodes") {
            version_2_ ? read_nodes_2() : read_nodes();
            nodes = true;
        } else if (section == "Elements") {
            version_2_ ? read_elements_2() : read_elements();
            elements = true;
        } else if (section == "PartitionedEntities") {
            words_.fail("a partitioned mesh is not read; save it unpartitioned");
        } else {
            words_.skip_section(section);
        }
    }
    if (!format || !nodes || !elements)
        words_.fail("the mesh lacks $MeshFormat, $Nodes or $Elements");
    if (mesh_.n_elements() == 0)
        words_.fail("the mesh has no 8-node hexahedra, no 4-node tetrahedra and no shells");
    number_elements();
    orient_facets();
    drop_unused_nodes();
    return std::move(mesh_);
}

}  // namespace

Mesh read_gmsh(const std::string& path, const std::vector<std::string>& immobile,
               const std::vector<std::string>& shells) {
    return GmshFile(path, immobile, shells).read();
}

}  // namespace undertow::fem
