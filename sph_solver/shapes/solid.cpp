#include "sph_solver/shapes/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sph_solver/shapes/stl_file.hpp"
#include "sph_solver/shapes/vectors.hpp"

namespace undertow::sph {

namespace {

using Polygon = std::vector<std::array<double, 2>>;

FromSurface from_box(const Box& box, const Vec3& x, bool flat) {
    Vec3 beyond{};  // of the box, per axis; 0 between its faces
    double outside2 = 0, nearest_face = -1e300;
    int nearest_axis = 0, side = 1;
    for (int a = 0; a < 3; ++a) {
        if (flat && a == 1) continue;
        const double low = box.min[a] - x[a], high = x[a] - box.max[a];
        beyond[a] = high > 0 ? high : low > 0 ? -low : 0;
        outside2 += beyond[a] * beyond[a];
        if (std::max(low, high) > nearest_face)
            nearest_face = std::max(low, high), nearest_axis = a, side = high > low ? 1 : -1;
    }
    if (outside2 == 0) {
        Vec3 away{};
        away[nearest_axis] = side;
        return {nearest_face, away};
    }
    const double d = std::sqrt(outside2);
    return {d, {beyond[0] / d, beyond[1] / d, beyond[2] / d}};
}

/// A solid with flat ends from the distances to its side and to its ends, and their directions.
FromSurface with_ends(double over_side, const Vec3& sideways, double over_end,
                      const Vec3& endways) {
    if (over_end > 0 && over_side > 0) {  // off the rim
        const double d = std::hypot(over_end, over_side);
        const Vec3 away = over_end * endways + over_side * sideways;
        return {d, {away[0] / d, away[1] / d, away[2] / d}};
    }
    if (over_end > over_side) return {over_end, endways};
    return {over_side, sideways};
}

FromSurface from_cylinder(const Shape& s, const Vec3& x, bool flat) {
    Vec3 axis = s.to - s.from, from_middle = x - 0.5 * (s.from + s.to);
    if (flat) from_middle[1] = 0;
    const double extent = std::hypot(axis[0], axis[1], axis[2]);
    for (double& c : axis) c /= extent;
    const double along = dot(axis, from_middle);
    Vec3 radial = from_middle - along * axis;
    const double r = std::hypot(radial[0], radial[1], radial[2]);
    for (double& c : radial) c /= r > 0 ? r : 1;
    if (!(r > 0))  // on the axis any direction will do
        radial = std::abs(axis[0]) < 0.5 ? cross(axis, {1, 0, 0}) : cross(axis, {0, 0, 1});
    if (flat) return {r - s.radius, radial};
    return with_ends(r - s.radius, radial, std::abs(along) - 0.5 * extent,
                     (along < 0 ? -1.0 : 1.0) * axis);
}

/// turn: +-1, see Solid::polygon_turn_.
FromSurface from_polygon(const Polygon& corner, double turn, const Vec3& x) {
    bool inside = false;  // even-odd rule
    double best2 = 1e300;
    Vec3 to_edge{}, edge_normal{};
    for (std::size_t a = 0, b = corner.size() - 1; a < corner.size(); b = a++) {
        const double xb = corner[b][0], zb = corner[b][1];
        const double ex = corner[a][0] - xb, ez = corner[a][1] - zb;
        const double length2 = ex * ex + ez * ez;
        const double share = std::clamp(((x[0] - xb) * ex + (x[2] - zb) * ez) / length2, 0.0, 1.0);
        const double dx = x[0] - xb - share * ex, dz = x[2] - zb - share * ez;
        const double d2 = dx * dx + dz * dz;
        if (d2 < best2) {
            best2 = d2, to_edge = {dx, 0, dz};
            edge_normal = (turn / std::sqrt(length2)) * Vec3{ez, 0, -ex};
        }
        if ((corner[a][1] > x[2]) != (zb > x[2]) && x[0] < ex * (x[2] - zb) / ez + xb)
            inside = !inside;
    }
    const double d = std::sqrt(best2);
    const double sign = inside ? -1 : 1;
    if (d < 1e-12) return {sign * d, edge_normal};
    return {sign * d, (sign / d) * to_edge};
}

FromSurface from_prism(const Shape& s, double turn, const Vec3& x, bool flat) {
    const FromSurface side = from_polygon(s.profile, turn, x);
    if (flat || !s.box) return side;
    const double low = s.box->min[1] - x[1], high = x[1] - s.box->max[1];
    return with_ends(side.distance, side.away, std::max(low, high),
                     {0, high > low ? 1.0 : -1.0, 0});
}

FromSurface from_triangles(const TriangleSurface& surface, const Vec3& x) {
    const TriangleSurface::Nearest nearest = surface.nearest(x);
    const double sign = surface.winding_number(x) > 0.5 ? -1 : 1;
    // on the surface itself the direction is the facet's
    if (nearest.distance < 1e-9) return {sign * nearest.distance, surface.normal(nearest.facet)};
    return {sign * nearest.distance, (sign / nearest.distance) * (x - nearest.point)};
}

}  // namespace

Solid::Solid(const Shape& shape, bool flat, const std::string& folder, const std::string& where)
    : shape_(shape), flat_(flat) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    if (!shape.stl.empty()) {
        const bool absolute = shape.stl[0] == '/' || folder.empty();
        surface_ = std::make_shared<TriangleSurface>(read_stl(
            absolute ? shape.stl : folder + "/" + shape.stl, shape.scale, shape.at, where));
        bounds_ = surface_->bounds();
    } else if (shape.radius > 0) {
        for (int a = 0; a < 3; ++a) {
            const double extent = length(shape.to - shape.from);
            const double along = (shape.to[a] - shape.from[a]) / extent;
            const double across = shape.radius * std::sqrt(std::max(0.0, 1 - along * along));
            bounds_.min[a] = std::min(shape.from[a], shape.to[a]) - across;
            bounds_.max[a] = std::max(shape.from[a], shape.to[a]) + across;
        }
    } else if (!shape.profile.empty()) {
        double area = 0;
        bounds_ = {{inf, shape.box ? shape.box->min[1] : -inf, inf},
                   {-inf, shape.box ? shape.box->max[1] : inf, -inf}};
        const Polygon& corner = shape.profile;
        for (std::size_t a = 0, b = corner.size() - 1; a < corner.size(); b = a++) {
            area += corner[b][0] * corner[a][1] - corner[a][0] * corner[b][1];
            for (int k = 0; k < 2; ++k) {
                bounds_.min[2 * k] = std::min(bounds_.min[2 * k], corner[a][k]);
                bounds_.max[2 * k] = std::max(bounds_.max[2 * k], corner[a][k]);
            }
        }
        polygon_turn_ = area > 0 ? 1 : -1;
    } else {
        bounds_ = *shape.box;
    }
    if (flat) bounds_.min[1] = bounds_.max[1] = 0;
}

FromSurface Solid::operator()(const Vec3& x) const {
    if (surface_) return from_triangles(*surface_, x);
    if (shape_.radius > 0) return from_cylinder(shape_, x, flat_);
    if (!shape_.profile.empty()) return from_prism(shape_, polygon_turn_, x, flat_);
    return from_box(*shape_.box, x, flat_);
}

}  // namespace undertow::sph
