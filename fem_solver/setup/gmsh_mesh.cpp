#include "fem_solver/setup/gmsh_mesh.hpp"

#include <cstdlib>
#include <map>
#include <unordered_map>
#include <utility>

#include "fem_solver/setup/mesh_builder.hpp"
#include "fem_solver/setup/mesh_words.hpp"

namespace undertow::fem {
namespace {

using Entity = std::pair<int, std::int64_t>;  // dimension, tag
struct EntityHash {
    std::size_t operator()(const Entity& e) const {
        return std::hash<std::int64_t>{}(e.second * 4 + e.first);
    }
};

class GmshFile {
 public:
    GmshFile(const std::string& path, SetsOfCase of_case)
        : words_(path), mesh_(path, "physical group", std::move(of_case)) {}
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
    void add_element(std::int64_t type, std::int64_t tag, const std::int32_t* n,
                     const MeshBuilder::Names& groups);
    std::int32_t node(std::int64_t tag) {
        const auto found = node_of_tag_.find(tag);
        if (found == node_of_tag_.end())
            words_.fail("node " + std::to_string(tag) + " is not in $Nodes");
        return found->second;
    }
    MeshBuilder::Names names_of(int dimension, const std::vector<std::int64_t>& groups) const {
        MeshBuilder::Names names;
        for (std::int64_t g : groups) names.push_back(group_name(dimension, g));
        return names;
    }
    std::string group_name(int dimension, std::int64_t group) const {
        const auto found = name_.find({dimension, group});
        return found == name_.end() ? std::to_string(group) : found->second;
    }

    MeshWords words_;
    bool version_2_ = false;  // 2.2, otherwise 4.1
    MeshBuilder mesh_;
    std::unordered_map<Entity, std::string, EntityHash> name_;  // of physical groups
    std::unordered_map<Entity, std::vector<std::int64_t>, EntityHash> groups_;  // of entities
    std::unordered_map<std::int64_t, std::int32_t> node_of_tag_;
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
    if (!node_of_tag_.emplace(tag, std::int32_t(mesh_.nodes())).second)
        words_.fail("node " + std::to_string(tag) + " is defined twice");
    Vec3 x;
    for (double& c : x) c = words_.number<double>();
    mesh_.add_node(x);
}

/// Version 2.2: a count, then tag x y z.
void GmshFile::read_nodes_2() {
    const std::size_t n = words_.count();
    for (std::size_t i = 0; i < n; ++i) add_node(words_.integer());
    words_.expect("$EndNodes");
}

void GmshFile::read_nodes() {
    const std::size_t blocks = words_.count(), n = words_.count();
    words_.integer();  // smallest and largest tag
    words_.integer();
    for (std::size_t b = 0; b < blocks; ++b) {
        words_.integer();  // entity
        words_.integer();
        if (words_.integer() != 0) words_.fail("parametric nodes are not read");
        std::vector<std::int64_t> tags(words_.count());
        for (std::int64_t& tag : tags) tag = words_.integer();
        for (std::int64_t tag : tags) add_node(tag);
    }
    if (mesh_.nodes() != n)
        words_.fail("$Nodes announces " + std::to_string(n) + " nodes and holds " +
                    std::to_string(mesh_.nodes()));
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
        const MeshBuilder::Names groups = names_of(dimension, groups_[{dimension, entity}]);
        for (std::size_t i = words_.count(); i > 0; --i) {
            const std::int64_t tag = words_.integer();
            std::int32_t n[8];
            for (int k = 0; k < corners; ++k) n[k] = node(words_.integer());
            add_element(type, tag, n, groups);
        }
    }
    words_.expect("$EndElements");
}

/// Version 2.2: a count, then tag, type, number of tags, physical group, other tags, nodes. An
/// element of several groups stands in the file once for each.
void GmshFile::read_elements_2() {
    std::map<std::vector<std::int32_t>, std::size_t> again;
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
                for (const std::string& set : names_of(3, groups))
                    type == 5 ? mesh_.add_hexahedron_to(set, found->second)
                              : mesh_.add_tetrahedron_to(set, found->second);
                continue;
            }
            again[key] = type == 5 ? mesh_.hexahedra() : mesh_.tetrahedra();
        }
        add_element(type, tag, n, names_of(dimension, groups));
    }
    words_.expect("$EndElements");
}

void GmshFile::add_element(std::int64_t type, std::int64_t tag, const std::int32_t* n,
                           const MeshBuilder::Names& groups) {
    if (type == 5)
        mesh_.add_hexahedron(tag, n, groups);
    else if (type == 4)
        mesh_.add_tetrahedron(tag, n, groups);
    else if (type == 3)
        mesh_.add_quad(tag, n, groups);
    else if (type == 2)
        mesh_.add_triangle(tag, n, groups);
    else
        for (const std::string& set : groups) mesh_.add_nodes(set, {n, type == 1 ? 2u : 1u});
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
    return mesh_.finish();
}

}  // namespace

Mesh read_gmsh(const std::string& path, SetsOfCase of_case) {
    return GmshFile(path, std::move(of_case)).read();
}

}  // namespace undertow::fem
