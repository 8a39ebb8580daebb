#pragma once
// The outer faces of the mesh, to turn a quad so that its normal points out of the solid.

#include <string>
#include <unordered_map>
#include <unordered_set>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

class Skin {
 public:
    explicit Skin(const Mesh& mesh);

    /// The quad, counter-clockwise seen from outside; that of a shell as it is. InputError when it
    /// is no face of an element or lies between two; `what` names it.
    Quad outward(const Quad& quad, const std::string& what) const;
    bool has(const Quad& quad) const;          // of an element, or a shell
    bool between_two(const Quad& quad) const;  // elements
    /// Why outward() would refuse it, to follow its name; "" when it does not.
    std::string trouble(const Quad& quad) const;
    /// The quad as it is. InputError when it is a face of an element.
    Quad outside(const Quad& quad, const std::string& what) const;

 private:
    struct Hash {
        std::size_t operator()(const Quad& q) const {
            std::size_t h = 1469598103934665603ull;
            for (std::int32_t n : q) h = (h ^ std::size_t(n)) * 1099511628211ull;
            return h;
        }
    };
    struct Face {
        Quad node;  // counter-clockwise seen from outside
        int elements = 0;
    };
    std::string source_;
    std::unordered_map<Quad, Face, Hash> face_;  // by sorted nodes
    std::unordered_set<Quad, Hash> shell_;
};

}  // namespace undertow::fem
