#pragma once
// Element types of Abaqus that the solver has, and the numbering of their faces.

#include <string_view>

#include "fem_solver/mesh.hpp"

namespace undertow::fem {

/// What becomes of an element. Facets and curves mark places of the mesh; the formulation (R, I, H,
/// ...) is the case's, not the file's.
enum class AbaqusShape {
    hexahedron,      // C3D8*
    tetrahedron,     // C3D4*
    shell,           // S4*
    shell_triangle,  // S3*, STRI3: not computed with, but named
    quad,            // SFM3D4*, CPS4*, CPE4*, CAX4*
    triangle,        // SFM3D3*, CPS3*, CPE3*, CAX3*
    curve,           // T2D2*, T3D2*
    beam,            // B21*, B31*, B33*: not computed with, but named
    none
};

/// `type` in capitals.
inline AbaqusShape shape_of_type(std::string_view type) {
    struct Kind {
        std::string_view prefix;
        AbaqusShape shape;
    };
    constexpr Kind kinds[] = {{"C3D8", AbaqusShape::hexahedron},
                              {"C3D4", AbaqusShape::tetrahedron},
                              {"S4", AbaqusShape::shell},
                              {"S3", AbaqusShape::shell_triangle},
                              {"STRI3", AbaqusShape::shell_triangle},
                              {"SFM3D4", AbaqusShape::quad},
                              {"CPS4", AbaqusShape::quad},
                              {"CPE4", AbaqusShape::quad},
                              {"CAX4", AbaqusShape::quad},
                              {"SFM3D3", AbaqusShape::triangle},
                              {"CPS3", AbaqusShape::triangle},
                              {"CPE3", AbaqusShape::triangle},
                              {"CAX3", AbaqusShape::triangle},
                              {"T2D2", AbaqusShape::curve},
                              {"T3D2", AbaqusShape::curve},
                              {"B21", AbaqusShape::beam},
                              {"B31", AbaqusShape::beam},
                              {"B33", AbaqusShape::beam}};
    for (const Kind& kind : kinds)
        if (type.substr(0, kind.prefix.size()) == kind.prefix) return kind.shape;
    return AbaqusShape::none;
}

inline int corners_of(AbaqusShape shape) {
    switch (shape) {
        case AbaqusShape::hexahedron:
            return 8;
        case AbaqusShape::tetrahedron:
        case AbaqusShape::shell:
        case AbaqusShape::quad:
            return 4;
        case AbaqusShape::shell_triangle:
        case AbaqusShape::triangle:
            return 3;
        default:
            return 2;
    }
}

/// Faces S1 to S6 and S1 to S4.  [Abaqus Analysis User's Guide, "Three-dimensional solid elements"]
inline constexpr int abaqus_hexahedron_face[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                                     {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
inline constexpr int abaqus_tetrahedron_face[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

}  // namespace undertow::fem
