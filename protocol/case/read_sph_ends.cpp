// The ends of the fluid's world: periodic axes, openings, absorbing layers.

#include <cmath>

#include "case/sections.hpp"
#include "case/sph_sections.hpp"

namespace undertow {

namespace {

/// The axis of a vector that lies along one, -1 otherwise.
int axis_of(const Vec3& v) {
    for (int a = 0; a < 3; ++a)
        if (std::abs(std::abs(v[a]) - 1) < 1e-9) return a;
    return -1;
}

void read_along_axis(TableReader& reader, const char* key, Vec3& target, const CaseInfo& info) {
    reader.direction(key, target);
    const int axis = axis_of(target);
    if (axis < 0) reader.reject(key, "is slanted: it must lie along one axis, like [-1, 0, 0].");
    if (info.dimension == 2 && axis == 1)
        reader.reject(key, "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
}

/// A box that is flat along the normal and has an extent along the other axes.
void read_opening(TableReader& reader, Box& box, Vec3& normal, const CaseInfo& info) {
    reader.require("name", "a word for messages and the summary");
    reader.require("box", "the box { min, max } of the opening, flat along one axis");
    reader.require("normal", "the direction along that axis, into the fluid");
    read_along_axis(reader, "normal", normal, info);
    reader.box("box", box, "");
    if (!reader.has("box")) return;
    const int flat = axis_of(normal);
    for (const char name : axes_of(info)) {
        const int axis = name - 'x';
        const double extent = box.max[axis] - box.min[axis];
        if (axis == flat && extent != 0)
            reader.reject("box", std::string("must be flat along its normal: min and max must have "
                                             "the same ") +
                                     name + ".");
        if (axis != flat && !(extent > 0))
            reader.reject("box", std::string("has no extent: the ") + name +
                                     " of max must be > that of min.");
    }
}

void read_inflow(TableReader& reader, Inflow& inflow, const SphSettings& sph,
                 const CaseInfo& info) {
    reader.text("name", inflow.name);
    read_opening(reader, inflow.box, inflow.normal, info);
    reader.require("fluid", "the name of a [[sph.fluid]]");
    reader.require("velocity", "the speed along the normal in m/s, a number or a formula");
    std::vector<std::string> fluids;
    for (const Fluid& fluid : sph.fluid) fluids.push_back(fluid.name);
    reader.word("fluid", inflow.fluid, fluids);
    reader.formula("velocity", inflow.velocity, "xyzt", "m/s");
    double level = 0;
    reader.number("level", level, any("m"));
    if (!reader.has("level")) return;
    if (inflow.normal[2] != 0)
        reader.reject("level", "is not allowed: the opening is level itself.");
    inflow.level = level;
}

void read_outflow(TableReader& reader, Outflow& outflow, const CaseInfo& info) {
    reader.text("name", outflow.name);
    read_opening(reader, outflow.box, outflow.normal, info);
    double pressure = 0, level = 0;
    reader.number("pressure", pressure, any("Pa"));
    reader.number("level", level, any("m"));
    if (reader.has("pressure")) outflow.pressure = pressure;
    if (reader.has("level")) outflow.level = level;
    if (outflow.pressure && outflow.level)
        reader.reject("level", "is one pressure too many: `pressure` gives it already.");
}

void read_absorbing(TableReader& reader, AbsorbingLayer& layer, const CaseInfo& info) {
    reader.require("name", "a word for messages");
    reader.require("box", "the box { min, max } of the layer");
    reader.require("direction", "the direction along an axis toward the boundary");
    reader.text("name", layer.name);
    reader.box("box", layer.box, axes_of(info));
    read_along_axis(reader, "direction", layer.direction, info);
    reader.vector("velocity", layer.velocity, "m/s");
    if (info.dimension == 2 && layer.velocity[1] != 0)
        reader.reject("velocity",
                      "is not allowed: a 2D case lies in the x-z plane, so y must be 0.");
    reader.number("strength", layer.strength, closed(0, 50));
    reader.number("wave_speed", layer.wave_speed, at_least(0, "m/s"));
}

/// Nothing can end where the world goes on.
void require_not_periodic(const TableReader& reader, const std::string& key, const Vec3& direction,
                          const SphSettings& sph) {
    for (const std::string& name : sph.periodic)
        if (direction[name[0] - 'x'] != 0)
            reader.reject(key,
                          "lies along " + name + ", which sph.periodic repeats without an end.");
}

}  // namespace

void read_sph_ends(TableReader& reader, SphSettings& sph, const CaseInfo& info) {
    reader.words("periodic", sph.periodic,
                 info.dimension == 2 ? std::vector<std::string>{"x", "z"}
                                     : std::vector<std::string>{"x", "y", "z"});
    if (!sph.periodic.empty() && !sph.domain)
        reader.reject("periodic", "needs sph.domain, whose extent is the period.");
    reader.tables("inflow", [&](TableReader& entry) {
        Inflow& inflow = sph.inflow.emplace_back();
        read_inflow(entry, inflow, sph, info);
        require_not_periodic(entry, "normal", inflow.normal, sph);
    });
    reader.tables("outflow", [&](TableReader& entry) {
        Outflow& outflow = sph.outflow.emplace_back();
        read_outflow(entry, outflow, info);
        require_not_periodic(entry, "normal", outflow.normal, sph);
    });
    reader.tables("absorbing", [&](TableReader& entry) {
        AbsorbingLayer& layer = sph.absorbing.emplace_back();
        read_absorbing(entry, layer, info);
        require_not_periodic(entry, "direction", layer.direction, sph);
    });
}

}  // namespace undertow
