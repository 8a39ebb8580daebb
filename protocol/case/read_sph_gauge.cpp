// Gauges of [sph].

#include <cmath>

#include "case/sph_sections.hpp"

namespace undertow {

namespace {

void require_in_domain(TableReader& reader, const char* key, const Vec3& at, const SphSettings& sph,
                       const std::string& axes) {
    if (!sph.domain || !reader.has(key)) return;
    for (const char axis : axes) {
        const auto k = static_cast<std::size_t>(axis - 'x');
        if (at[k] >= sph.domain->min[k] && at[k] <= sph.domain->max[k]) continue;
        reader.reject(key, std::string("lies outside sph.domain in ") + axis +
                               ": there is never any fluid; move the gauge or enlarge sph.domain.");
    }
}

/// A rectangle is a box that is flat in one direction; in 2D it is a line and y does not count.
void read_rectangle(TableReader& reader, SphGauge& gauge, const SphSettings& sph,
                    const CaseInfo& info) {
    reader.require("box", "the rectangle { min, max }, flat in one direction, that is crossed");
    reader.table("box", [&](TableReader& corners) {
        corners.require("min", "[x, y, z], its lower corner");
        corners.require("max", "[x, y, z], its upper corner");
        corners.vector("min", gauge.box.min, "m");
        corners.vector("max", gauge.box.max, "m");
    });
    if (!reader.has_table("box")) return;
    int flat = 0;
    std::size_t normal = 0;
    for (const char axis : axes_of(info)) {
        const auto k = static_cast<std::size_t>(axis - 'x');
        if (gauge.box.min[k] > gauge.box.max[k])
            reader.reject("box", std::string("is not allowed: min is above max in ") + axis + ".");
        if (gauge.box.min[k] == gauge.box.max[k]) ++flat, normal = k;
        if (sph.domain &&
            (gauge.box.max[k] < sph.domain->min[k] || gauge.box.min[k] > sph.domain->max[k]))
            reader.reject("box", std::string("lies outside sph.domain in ") + axis +
                                     ": nothing ever crosses it.");
    }
    if (flat != 1)
        reader.reject("box",
                      "is not a rectangle: min and max must be equal in exactly one "
                      "direction, across which the flux is measured.");
    if (!reader.has("direction")) {
        gauge.direction = {};
        gauge.direction[normal] = 1;
    }
    if (std::abs(gauge.direction[normal]) < 1 - 1e-9)
        reader.reject("direction",
                      "does not fit: the flux counts across the flat side of the "
                      "rectangle; give its normal, or the opposite.");
}

void read_wall(TableReader& reader, SphGauge& gauge, const SphSettings& sph) {
    reader.require("wall", "the name of a [[sph.plane]] or [[sph.body]]");
    std::vector<std::string> walls;
    for (const PlaneWall& plane : sph.plane) walls.push_back(plane.name);
    for (const Body& body : sph.body) walls.push_back(body.name);
    if (walls.empty() && reader.has("wall"))
        reader.reject("wall",
                      "does not exist: the case has neither [[sph.plane]] nor [[sph.body]].");
    reader.word("wall", gauge.wall, walls);
}

}  // namespace

void read_gauge(TableReader& reader, SphGauge& gauge, const SphSettings& sph,
                const CaseInfo& info) {
    reader.require("name", "a word for the column of gauges.csv");
    reader.require("kind", "one of front, pressure, water_level, flux, force");
    reader.text("name", gauge.name);
    reader.choice<SphGaugeKind>("kind", gauge.kind,
                                {{"front", SphGaugeKind::front},
                                 {"pressure", SphGaugeKind::pressure},
                                 {"water_level", SphGaugeKind::water_level},
                                 {"flux", SphGaugeKind::flux},
                                 {"force", SphGaugeKind::force}});
    const bool pressure = gauge.kind == SphGaugeKind::pressure,
               level = gauge.kind == SphGaugeKind::water_level;
    if (pressure || level) reader.require("point", "where it measures, [x, y, z]");
    reader.vector("point", gauge.point, "m");
    reader.direction("direction", gauge.direction);
    reader.number("every", gauge.every, positive("s"));
    if (gauge.kind == SphGaugeKind::flux) read_rectangle(reader, gauge, sph, info);
    if (gauge.kind == SphGaugeKind::force) read_wall(reader, gauge, sph);
    const bool flat = info.dimension == 2;
    if (pressure) require_in_domain(reader, "point", gauge.point, sph, flat ? "xz" : "xyz");
    if (level) require_in_domain(reader, "point", gauge.point, sph, flat ? "x" : "xy");
}

}  // namespace undertow
