#pragma once
// STL files, ASCII and binary.

#include <string>

#include "sph_solver/shapes/triangle_surface.hpp"

namespace undertow::sph {

/// Reads a surface, x = at + scale x_file [m], and joins the vertices that facets share (1e-6 of
/// the surface's size). InputError: no STL file, cut off, open, facets turned over, or inside out.
/// where: begins the sentence, `case.toml: sph.body "tank"`.
TriangleMesh read_stl(const std::string& path, double scale, const Vec3& at,
                      const std::string& where);

}  // namespace undertow::sph
