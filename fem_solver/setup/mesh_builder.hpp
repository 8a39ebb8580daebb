#pragma once
// What a mesh file holds, whatever its format, on its way to a Mesh: readers add nodes, elements
// and facets as they stand in the file, finish() numbers elements shape by shape, turns facets
// outward and drops nodes that nothing uses.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

class Skin;

/// Sets that mean more than their elements say, as the case has them.
struct SetsOfCase {
    std::vector<std::string> immobile;  // facet sets without elements, kept as the file has them
    std::vector<std::string> shells;    // sets whose quads are elements
};

/// What happens to a facet that is not on the skin of a solid and no shell.
enum class OffSkin {
    stop,       // InputError
    shell,      // the same: it is a shell that the case gives no part
    refuse_set  // the set stays as nodes alone; InputError when the case uses its facets
};

class MeshBuilder {
 public:
    using Names = std::vector<std::string>;

    /// `set_word` is what the format calls a set, for messages: "physical group".
    MeshBuilder(std::string source, std::string set_word, SetsOfCase of_case);

    /// Index of the node among those added.
    std::int32_t add_node(const Vec3& x);
    std::size_t nodes() const { return mesh_.x.size(); }
    std::size_t hexahedra() const { return mesh_.hexahedra.size(); }
    std::size_t tetrahedra() const { return mesh_.tetrahedra.size(); }

    /// Elements of the file, `tag` their number in it, `n` their nodes; each in all of `sets`.
    void add_hexahedron(std::int64_t tag, const std::int32_t* n, const Names& sets);
    void add_tetrahedron(std::int64_t tag, const std::int32_t* n, const Names& sets);
    /// A facet of every set, and an element once if any of them is of shells.
    void add_quad(std::int64_t tag, const std::int32_t* n, const Names& sets,
                  OffSkin off = OffSkin::stop);
    void add_triangle(std::int64_t tag, const std::int32_t* n, const Names& sets,
                      OffSkin off = OffSkin::stop);
    /// A facet of one set; `what` names it in messages. One of a shell looks as it is given.
    void add_facet(const std::string& set, const Quad& facet, std::string what);
    /// The same of a face that does not count where it lies between two elements.
    void add_face_if_free(const std::string& set, const Quad& face);
    void refuse_set(const std::string& set, const std::string& why);
    void add_nodes(const std::string& set, std::span<const std::int32_t> n);
    /// Puts an element that is there already into one more set.
    void add_hexahedron_to(const std::string& set, std::size_t hexahedron);
    void add_tetrahedron_to(const std::string& set, std::size_t tetrahedron);

    bool is_shell(const std::string& set) const;
    /// InputError where facets do not lie on the skin. Once, at the end.
    Mesh finish();
    std::vector<std::string>& remarks() { return mesh_.remarks; }

 private:
    struct Facet {
        Quad node;         // indices into the nodes as they were added
        std::int64_t tag;  // of the file's element
        OffSkin off;
        bool only_free;    // leave it out when it lies between two elements
        std::string what;  // instead of the tag, for faces of elements; mostly empty
    };
    bool is_immobile(const std::string& set) const;
    std::string name_of_facet(const std::string& set, const Facet& facet) const;
    void number_elements();
    void orient_facets();
    void orient(const std::string& set, const std::vector<Facet>& facets, const Skin& skin);
    void refuse_facets(const std::string& set, const std::vector<Facet>& facets,
                       const std::string& why);
    void drop_unused_nodes();

    std::string set_word_;
    SetsOfCase of_case_;
    Mesh mesh_;
    std::map<std::string, std::vector<Facet>> facets_;
    // Tetrahedra and shells come after the hexahedra, whatever their order in the file:
    std::vector<std::int64_t> tetrahedron_tag_, shell_tag_;
    std::map<std::string, std::vector<std::int32_t>> tetrahedron_sets_, shell_sets_;
};

}  // namespace undertow::fem
