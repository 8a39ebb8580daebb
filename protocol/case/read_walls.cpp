// Rigid walls of [sph]: planes, bodies of any shape, and obstacles that fills leave free.

#include <cmath>
#include <cstdio>

#include "case/sph_sections.hpp"

namespace undertow {

namespace {

constexpr double most_of_a_spacing =
    0.01;  // that a fill may be longer or shorter than its particles

const std::vector<std::pair<std::string, Slip>> slip_names{{"free", Slip::free_slip},
                                                           {"free_slip", Slip::free_slip},
                                                           {"no_slip", Slip::no_slip},
                                                           {"friction", Slip::friction}};

void read_slip(TableReader& reader, Slip& slip, double& friction, bool* symmetry = nullptr) {
    auto names = slip_names;
    if (symmetry) names.emplace_back("symmetry", Slip::free_slip);   // a mirror without friction
    reader.choice<Slip>("slip", slip, names);
    std::string text;
    reader.text("slip", text);
    if (symmetry) *symmetry = text == "symmetry";
    reader.number("friction", friction, closed(0, 2));
    if (slip == Slip::friction && !reader.has("friction"))
        reader.reject("slip",
                      "needs friction, the Coulomb coefficient, for example friction = 0.3.");
    if (slip != Slip::friction && reader.has("friction"))
        reader.reject("friction", "has no effect: give slip = \"friction\" beside it.");
}

void require_one_shape(TableReader& reader, const Shape& shape) {
    const std::string allowed =
        "a box { min, max }, a profile [[x, z], ...], a cylinder (from, to, radius) or an stl file";
    const bool cylinder = reader.has("from") || reader.has("to") || reader.has("radius");
    const int shapes =
        int(shape.box || !shape.profile.empty()) + int(cylinder) + int(reader.has("stl"));
    if (shapes == 0) reader.require("box", "its shape: " + allowed);
    if (shapes > 1)
        reader.reject(reader.has("stl") ? "stl" : "radius",
                      "is one shape too many: give one of " + allowed + ".");
}

void read_shape(TableReader& reader, Shape& shape, const CaseInfo& info) {
    Box box;
    reader.box("box", box, axes_of(info));
    if (reader.has_table("box")) shape.box = box;
    reader.polygon("profile", shape.profile);
    read_cylinder_or_stl(reader, shape, info);
    require_one_shape(reader, shape);
}

/// velocity, displacement or motion, and angle.
void read_motion(TableReader& reader, Body& body, const CaseInfo& info) {
    reader.vector("velocity", body.velocity, "m/s");
    require_in_plane(reader, "velocity", body.velocity, info);
    reader.number("start", body.start, at_least(0, "s"));
    Range stop = at_least(0, "s");
    stop.infinite = true;
    reader.number("stop", body.stop, stop);
    if (body.stop < body.start)
        reader.reject("stop", "is not allowed: the motion must not end before it starts.");
    Vec3 constant{};
    reader.vector("displacement", constant, body.displacement, "t", "m");
    if (reader.has("displacement") && body.displacement.empty())
        reader.reject("displacement",
                      "does not move anything: give formulas of t, for example "
                      "[\"0.1*sin(2*pi*t)\", 0, 0].");
    if (info.dimension == 2 && !body.displacement.empty() && body.displacement[1].text() != "0")
        reader.reject("displacement",
                      "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
    reader.text("motion", body.motion);
    reader.formula("angle", body.angle, "t", "rad");
    reader.direction("axis", body.axis);
    reader.vector("center", body.center, "m");
    if (info.dimension == 2 && (body.axis[0] != 0 || body.axis[2] != 0))
        reader.reject("axis", "is not allowed: in a 2D case a body turns about y, [0, 1, 0].");
    if (reader.has("velocity") + reader.has("displacement") + reader.has("motion") > 1)
        reader.reject(reader.has("motion") ? "motion" : "displacement",
                      "is one law too many: velocity, displacement and motion exclude each other.");
    for (const char* key : {"start", "stop"})
        if (reader.has(key) && !reader.has("velocity"))
            reader.reject(key,
                          "has no effect: it belongs to velocity; a formula or a table says "
                          "itself when it moves.");
    if (reader.has("motion") && reader.has("angle"))
        reader.reject("angle", "is one law too many: a motion file may have a column for it.");
    for (const char* key : {"axis", "center"})
        if (reader.has(key) && !reader.has("angle") && !reader.has("motion"))
            reader.reject(key, "has no effect: give angle, or a motion file that has one.");
}

}  // namespace

/// The axes in which a box has an extent that matters.
std::string axes_of(const CaseInfo& info) {
    return info.dimension == 2 ? "xz" : "xyz";
}

void require_in_plane(TableReader& reader, const char* key, const Vec3& v, const CaseInfo& info) {
    if (info.dimension == 2 && v[1] != 0)
        reader.reject(key, "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
}

/// A box must hold at least one particle across; round-off of decimal numbers is forgiven.
void require_one_spacing(TableReader& reader, const Box& box, double spacing,
                         const CaseInfo& info) {
    if (!reader.has("box") || spacing <= 0) return;
    for (const char axis : axes_of(info)) {
        const auto k = static_cast<std::size_t>(axis - 'x');
        const double extent = box.max[k] - box.min[k];
        if (extent >= spacing * (1 - 1e-9)) continue;
        char text[160];
        std::snprintf(
            text, sizeof text,
            "is %.6g m thin in %c: it must be at least one spacing, sph.spacing = %.6g m; "
            "use a finer spacing or a thicker box.",
            extent, axis, spacing);
        reader.reject("box", text);
    }
}

void require_whole_spacings(TableReader& reader, const Box& box, double spacing,
                            const CaseInfo& info) {
    if (!reader.has("box") || spacing <= 0) return;
    for (const char axis : axes_of(info)) {
        const auto k = static_cast<std::size_t>(axis - 'x');
        const double extent = box.max[k] - box.min[k], cells = extent / spacing;
        if (std::abs(cells - std::round(cells)) <= most_of_a_spacing) continue;
        char text[200];
        std::snprintf(
            text, sizeof text,
            "is %.6g m along %c, %.3f spacings of %.6g m; it must be a whole number: %.6g "
            "or %.6g m.",
            extent, axis, cells, spacing, std::floor(cells) * spacing, std::ceil(cells) * spacing);
        reader.reject("box", text);
    }
}

void read_cylinder_or_stl(TableReader& reader, Shape& shape, const CaseInfo& info) {
    reader.vector("from", shape.from, "m");
    reader.vector("to", shape.to, "m");
    reader.number("radius", shape.radius, positive("m"));
    reader.text("stl", shape.stl);
    reader.number("scale", shape.scale, positive());
    reader.vector("at", shape.at, "m");
    if (reader.has("from") || reader.has("to") || reader.has("radius")) {
        reader.require("from", "one end [x, y, z] of the cylinder's axis");
        reader.require("to", "the other end of the axis");
        reader.require("radius", "the cylinder's radius in m");
        if (reader.has("from") && reader.has("to") && shape.from == shape.to)
            reader.reject("to", "is not allowed: the axis has no length.");
        if (info.dimension == 2 && reader.has("from") && reader.has("to") &&
            (shape.from[0] != shape.to[0] || shape.from[2] != shape.to[2]))
            reader.reject("to",
                          "is not allowed: in a 2D case, the x-z plane, a cylinder is a disc "
                          "and its axis runs along y; give to the x and z of from.");
    }
    if (reader.has("stl") && info.dimension == 2)
        reader.reject("stl",
                      "is not allowed: a 2D case lies in the x-z plane; give a profile "
                      "[[x, z], ...] instead.");
    for (const char* key : {"scale", "at"})
        if (reader.has(key) && !reader.has("stl"))
            reader.reject(key, "has no effect: it belongs to an stl file.");
}

void read_obstacle(TableReader& reader, Obstacle& obstacle, const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.text("name", obstacle.name);
    read_shape(reader, obstacle.shape, info);
}

void read_plane(TableReader& reader, PlaneWall& plane, const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.require("point", "a point [x, y, z] of the plane");
    reader.require("normal", "the direction [x, y, z] that points into the fluid");
    reader.text("name", plane.name);
    reader.vector("point", plane.point, "m");
    reader.direction("normal", plane.normal);
    require_in_plane(reader, "normal", plane.normal, info);
    read_slip(reader, plane.slip, plane.friction, &plane.symmetry);
    reader.vector("velocity", plane.velocity, "m/s");
    require_in_plane(reader, "velocity", plane.velocity, info);
    if (!reader.has("velocity")) return;
    const Vec3 &n = plane.normal, &v = plane.velocity;
    const double across = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    if (std::abs(across) > 1e-9 * std::hypot(n[0], n[1], n[2]) * std::hypot(v[0], v[1], v[2]))
        reader.reject("velocity",
                      "is not allowed: a plane moves only along itself; a wall that pushes is an "
                      "[[sph.body]].");
    if (plane.slip != Slip::no_slip)
        reader.reject("velocity", "has no effect on a free-slip plane: set slip = \"no_slip\".");
}

void read_body(TableReader& reader, Body& body, const SphSettings& sph, const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.text("name", body.name);
    for (const PlaneWall& plane : sph.plane)
        if (plane.name == body.name)
            reader.reject("name", "is taken by a [[sph.plane]]: forces are written by name.");
    read_shape(reader, body.shape, info);
    if (body.shape.box && body.shape.profile.empty())
        require_one_spacing(reader, *body.shape.box, sph.spacing, info);
    reader.flag("inside", body.inside);
    read_motion(reader, body, info);
    read_slip(reader, body.slip, body.friction);
}

}  // namespace undertow
