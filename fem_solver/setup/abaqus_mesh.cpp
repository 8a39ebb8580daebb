#include "fem_solver/setup/abaqus_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "fem_solver/setup/abaqus_file.hpp"

namespace undertow::fem {
namespace {

/// Puts the parts of a file together, in the order in which they stand there.
class Assembly {
 public:
    Assembly(const std::string& path, SetsOfCase of_case)
        : file_(path), model_(file_.read()), mesh_(path, "element set", std::move(of_case)) {}
    Mesh build();

 private:
    void drop_parts_without_instance();
    void add_nodes();
    void find_sets();
    void add_elements();
    void add_element(const AbaqusPart& part, const AbaqusElement& element,
                     const MeshBuilder::Names& sets);
    void add_node_sets();
    void add_surfaces();
    void add_face(const AbaqusSurface& surface, const AbaqusSurface::Row& row,
                  const AbaqusRef& ref);
    void check_beams();
    void tell_what_was_skipped();

    /// The set's own name, or INSTANCE.NAME where another part has one of that name.
    template <class Sets>
    std::string full_name(const AbaqusPart& part, const std::string& key, const std::string& name,
                          Sets sets) const {
        int parts = 0;
        for (const AbaqusPart& p : model_.part) parts += int((p.*sets).count(key));
        return parts < 2 || part.instance.empty() ? name : part.instance + "." + name;
    }
    std::int32_t node(std::int32_t part, std::int64_t id, int line) const {
        const auto found = model_.part[part].node_of_id.find(id);
        if (found == model_.part[part].node_of_id.end())
            file_.fail(line, "node " + std::to_string(id) + " is not in *NODE");
        return first_node_[part] + found->second;
    }
    const AbaqusElement* element(const AbaqusRef& ref) const {
        const AbaqusPart& part = model_.part[ref.part];
        const auto found = part.element_of_id.find(ref.id);
        return found == part.element_of_id.end() ? nullptr : &part.element[found->second];
    }
    static std::string unknown_member(const char* kind, const AbaqusRef& ref) {
        return std::string("it holds ") + kind + " " + std::to_string(ref.id) + " (line " +
               std::to_string(ref.line) + " of the file), which there is not.";
    }

    AbaqusFile file_;
    AbaqusModel model_;
    MeshBuilder mesh_;
    std::vector<std::int32_t> first_node_;                // [parts]
    std::vector<std::string> set_name_;                   // of element sets
    std::vector<std::vector<std::vector<int>>> sets_of_;  // [parts][elements] into set_name_
};

/// x shifted, then turned about the axis through a and b.
Vec3 placed(const AbaqusPart& part, Vec3 x) {
    for (int d = 0; d < 3; ++d) x[d] += part.shift[d];
    if (part.angle == 0) return x;
    Vec3 e, r;
    double length = 0;
    for (int d = 0; d < 3; ++d) {
        e[d] = part.b[d] - part.a[d];
        r[d] = x[d] - part.a[d];
        length += e[d] * e[d];
    }
    for (double& c : e) c /= std::sqrt(length);
    const double turn = part.angle * std::acos(-1.0) / 180;
    const double c = std::cos(turn), s = std::sin(turn);
    const double along = e[0] * r[0] + e[1] * r[1] + e[2] * r[2];
    for (int d = 0; d < 3; ++d) {
        const int g = (d + 1) % 3, h = (d + 2) % 3;
        x[d] = part.a[d] + c * r[d] + s * (e[g] * r[h] - e[h] * r[g]) + (1 - c) * along * e[d];
    }
    return x;
}

Mesh Assembly::build() {
    drop_parts_without_instance();
    add_nodes();
    find_sets();
    add_elements();
    add_node_sets();
    add_surfaces();
    check_beams();
    tell_what_was_skipped();
    return mesh_.finish();
}

void Assembly::drop_parts_without_instance() {
    if (!model_.instances) return;
    for (std::size_t p = 1; p < model_.part.size(); ++p) {
        AbaqusPart& part = model_.part[p];
        if (!part.instance.empty()) continue;
        mesh_.remarks().push_back("*PART " + part.name + " has no *INSTANCE and is left out");
        part = {};
    }
}

void Assembly::add_nodes() {
    for (const AbaqusPart& part : model_.part) {
        first_node_.push_back(std::int32_t(mesh_.nodes()));
        for (const Vec3& x : part.x) mesh_.add_node(placed(part, x));
    }
}

void Assembly::find_sets() {
    for (const AbaqusPart& part : model_.part) sets_of_.emplace_back(part.element.size());
    for (const AbaqusPart& part : model_.part)
        for (const auto& [key, set] : part.element_set) {
            const std::string name = full_name(part, key, set.name, &AbaqusPart::element_set);
            const int number = int(set_name_.size());
            std::string trouble = set.trouble;
            for (const AbaqusRef& ref : set.member)
                if (!element(ref) && trouble.empty()) trouble = unknown_member("element", ref);
            if (!trouble.empty()) {
                mesh_.refuse_set(name, trouble);
                continue;
            }
            set_name_.push_back(name);
            for (const AbaqusRef& ref : set.member) {
                const std::size_t e = std::size_t(model_.part[ref.part].element_of_id.at(ref.id));
                std::vector<int>& sets = sets_of_[ref.part][e];
                if (sets.empty() || sets.back() != number) sets.push_back(number);
            }
        }
}

void Assembly::add_elements() {
    MeshBuilder::Names names;
    for (std::size_t p = 0; p < model_.part.size(); ++p)
        for (std::size_t e = 0; e < model_.part[p].element.size(); ++e) {
            names.clear();
            for (int set : sets_of_[p][e]) names.push_back(set_name_[set]);
            add_element(model_.part[p], model_.part[p].element[e], names);
        }
}

void Assembly::add_element(const AbaqusPart& part, const AbaqusElement& element,
                           const MeshBuilder::Names& sets) {
    const std::int32_t p = std::int32_t(&part - model_.part.data());
    std::int32_t n[8];
    const int corners = corners_of(element.shape);
    for (int k = 0; k < corners; ++k) n[k] = node(p, element.node[k], element.line);
    const bool shell =
        element.shape == AbaqusShape::shell || element.shape == AbaqusShape::shell_triangle;
    if (shell && sets.empty())
        file_.fail(element.line, "shell " + std::to_string(element.id) +
                                     " is in no element set; give it one that a [[fem.part]] with "
                                     "element = \"shell\" can name");
    const OffSkin off = shell ? OffSkin::shell : OffSkin::refuse_set;
    switch (element.shape) {
        case AbaqusShape::hexahedron:
            return mesh_.add_hexahedron(element.id, n, sets);
        case AbaqusShape::tetrahedron:
            return mesh_.add_tetrahedron(element.id, n, sets);
        case AbaqusShape::shell:
        case AbaqusShape::quad:
            return mesh_.add_quad(element.id, n, sets, off);
        case AbaqusShape::shell_triangle:
        case AbaqusShape::triangle:
            return mesh_.add_triangle(element.id, n, sets, off);
        default:
            for (const std::string& set : sets) mesh_.add_nodes(set, {n, 2});
    }
}

void Assembly::add_node_sets() {
    for (const AbaqusPart& part : model_.part)
        for (const auto& [key, set] : part.node_set) {
            const std::string name = full_name(part, key, set.name, &AbaqusPart::node_set);
            std::string trouble = set.trouble;
            std::vector<std::int32_t> nodes;
            for (const AbaqusRef& ref : set.member) {
                const auto& known = model_.part[ref.part].node_of_id;
                if (known.count(ref.id) > 0)
                    nodes.push_back(node(ref.part, ref.id, ref.line));
                else if (trouble.empty())
                    trouble = unknown_member("node", ref);
            }
            if (trouble.empty())
                mesh_.add_nodes(name, nodes);
            else
                mesh_.refuse_set(name, trouble);
        }
}

void Assembly::add_surfaces() {
    for (const AbaqusPart& part : model_.part)
        for (const auto& [key, read] : part.surface) {
            AbaqusSurface surface = read;
            surface.name = full_name(part, key, read.name, &AbaqusPart::surface);
            for (const AbaqusSurface::Row& row : surface.row)
                for (const AbaqusRef& ref : row.elements)
                    if (!element(ref) && surface.trouble.empty())
                        surface.trouble = unknown_member("element", ref);
            if (!surface.trouble.empty()) {
                mesh_.refuse_set(surface.name, surface.trouble);
                continue;
            }
            for (const AbaqusSurface::Row& row : surface.row)
                for (const AbaqusRef& ref : row.elements) add_face(surface, row, ref);
        }
}

void Assembly::add_face(const AbaqusSurface& surface, const AbaqusSurface::Row& row,
                        const AbaqusRef& ref) {
    const AbaqusElement& e = *element(ref);
    const std::string what = "face " + row.face + " of element " + std::to_string(e.id) +
                             " of surface \"" + surface.name + "\"";
    const auto at = [&](int corner) { return node(ref.part, e.node[corner], e.line); };
    const auto face = [&](int f) {
        if (e.shape == AbaqusShape::hexahedron) {
            const int* n = abaqus_hexahedron_face[f];
            return Quad{at(n[0]), at(n[1]), at(n[2]), at(n[3])};
        }
        const int* n = abaqus_tetrahedron_face[f];
        return Quad{at(n[0]), at(n[1]), at(n[2]), at(n[2])};
    };
    const int faces = e.shape == AbaqusShape::hexahedron    ? 6
                      : e.shape == AbaqusShape::tetrahedron ? 4
                                                            : 0;
    if (faces > 0 && row.face.empty()) {
        for (int f = 0; f < faces; ++f) mesh_.add_face_if_free(surface.name, face(f));
    } else if (faces > 0 && row.face.size() == 2 && row.face[0] == 'S' && row.face[1] >= '1' &&
               row.face[1] < '1' + faces) {
        mesh_.add_facet(surface.name, face(row.face[1] - '1'), what);
    } else if (e.shape == AbaqusShape::shell || e.shape == AbaqusShape::quad) {
        if (row.face != "SNEG" && row.face != "SPOS" && !row.face.empty())
            file_.fail(row.line, what + " is not known: a shell has SPOS and SNEG");
        mesh_.add_facet(surface.name,
                        row.face == "SNEG" ? Quad{at(0), at(3), at(2), at(1)}
                                           : Quad{at(0), at(1), at(2), at(3)},
                        what);
    } else {
        file_.fail(row.line, what +
                                 " is not known: a hexahedron has S1 to S6, a tetrahedron S1 "
                                 "to S4, a shell SPOS and SNEG");
    }
}

/// Beams along the edges of other elements may be a mesh generator's curves; beams that stand alone
/// are parts of a structure that would be missing.
void Assembly::check_beams() {
    std::set<std::pair<std::int32_t, std::int64_t>> used;
    std::int64_t beams = 0;
    for (std::size_t p = 0; p < model_.part.size(); ++p)
        for (const AbaqusElement& e : model_.part[p].element) {
            if (e.shape == AbaqusShape::beam) ++beams;
        }
    if (beams == 0) return;
    for (std::size_t p = 0; p < model_.part.size(); ++p)
        for (const AbaqusElement& e : model_.part[p].element)
            if (e.shape != AbaqusShape::beam && e.shape != AbaqusShape::curve)
                for (int k = 0; k < corners_of(e.shape); ++k)
                    used.emplace(std::int32_t(p), e.node[k]);
    for (std::size_t p = 0; p < model_.part.size(); ++p)
        for (const AbaqusElement& e : model_.part[p].element)
            if (e.shape == AbaqusShape::beam)
                for (int k = 0; k < 2; ++k)
                    if (used.count({std::int32_t(p), e.node[k]}) == 0)
                        file_.fail(e.line, "element " + std::to_string(e.id) +
                                               " is a beam, and there are no beams: mesh its "
                                               "plates with shells (S4) or its volume with "
                                               "hexahedra (C3D8)");
    mesh_.remarks().push_back(
        std::to_string(beams) +
        " beam elements along the edges of others are not computed with: there are no beams; "
        "their element sets are sets of nodes");
}

void Assembly::tell_what_was_skipped() {
    if (model_.skipped.empty()) return;
    std::string list;
    for (const std::string& keyword : model_.skipped) list += (list.empty() ? "" : ", ") + keyword;
    mesh_.remarks().push_back("of the mesh file only nodes, elements and sets are read; skipped: " +
                              list);
}

}  // namespace

Mesh read_abaqus(const std::string& path, SetsOfCase of_case) {
    return Assembly(path, std::move(of_case)).build();
}

}  // namespace undertow::fem
