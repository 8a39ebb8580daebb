#pragma once
// What an Abaqus input file says about its mesh, before sets and parts are put together.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "fem_solver/setup/abaqus_elements.hpp"

namespace undertow::fem {

struct AbaqusElement {
    std::int64_t id = 0;
    AbaqusShape shape = AbaqusShape::none;
    std::array<std::int64_t, 8> node{};  // numbers of the file
    int line = 0;
};

/// An element or a node of a part.
struct AbaqusRef {
    std::int32_t part = 0;
    std::int64_t id = 0;
    int line = 0;
};

struct AbaqusSet {
    std::string name;  // as it was first written
    std::vector<AbaqusRef> member;
    std::string trouble;  // why it cannot be used; mostly empty
};

/// *SURFACE: faces of elements or of sets of them.
struct AbaqusSurface {
    struct Row {
        std::vector<AbaqusRef> elements;
        std::string face;  // "S1" to "S6", "SPOS", "SNEG"; "": all that are free
        int line = 0;
    };
    std::string name;
    std::vector<Row> row;
    std::string trouble;
};

/// Names in capitals to what they stand for.
template <class Named>
using AbaqusNames = std::map<std::string, Named>;

/// A *PART in its instance, or the whole of a file without parts; of an assembly only the sets.
struct AbaqusPart {
    std::string name;      // of the *PART
    std::string instance;  // "" without one
    int line = 0;
    std::vector<std::int64_t> node_id;
    std::vector<Vec3> x;  // [m] in the part's own axes
    std::unordered_map<std::int64_t, std::int32_t> node_of_id, element_of_id;
    std::vector<AbaqusElement> element;
    AbaqusNames<AbaqusSet> element_set, node_set;
    AbaqusNames<AbaqusSurface> surface;
    // Where the instance stands: moved by shift, then turned about the axis from a to b.
    Vec3 shift{}, a{}, b{};  // [m]
    double angle = 0;        // [degrees]
};

struct AbaqusModel {
    std::vector<AbaqusPart> part{1};   // the first is of what stands outside of parts
    bool instances = false;            // without any, parts stand as they are
    std::vector<std::string> skipped;  // keywords, each once
};

}  // namespace undertow::fem
