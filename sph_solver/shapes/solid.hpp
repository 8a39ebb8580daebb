#pragma once
// Shapes of a case as signed distances.

#include <memory>
#include <string>

#include "case/case.hpp"
#include "sph_solver/shapes/triangle_surface.hpp"

namespace undertow::sph {

/// Where a point is as seen from a surface.
struct FromSurface {
    double distance;  // [m] negative inside
    Vec3 away;        // unit vector from the inside to the outside, along which distance grows
};

class Solid {
 public:
    /// flat: a 2D case, y does not count. folder: of the case file; where: begins the sentence of
    /// an InputError, `case.toml: sph.body "tank"`.
    Solid(const Shape& shape, bool flat, const std::string& folder, const std::string& where);

    FromSurface operator()(const Vec3& x) const;

    /// Holds the solid [m]; infinite along y where the solid is (a prism or disc without ends).
    const Box& bounds() const { return bounds_; }
    /// Facets of an STL file, else null.
    const TriangleSurface* surface() const { return surface_.get(); }

 private:
    Shape shape_;
    bool flat_;
    double polygon_turn_ = 1;  // 1: the profile's corners run counterclockwise in x, z; else -1
    std::shared_ptr<const TriangleSurface> surface_;
    Box bounds_;
};

}  // namespace undertow::sph
