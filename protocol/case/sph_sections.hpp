#pragma once
// The tables of [sph] that have a file of their own: walls, bodies, gauges, and the shapes in them.

#include "case/case.hpp"
#include "case/table_reader.hpp"

namespace undertow {

/// The axes in which a box has an extent that matters: "xyz", "xz" in 2D.
std::string axes_of(const CaseInfo& info);
void require_in_plane(TableReader& reader, const char* key, const Vec3& v, const CaseInfo& info);
/// A box must hold at least one particle across; round-off of decimal numbers is forgiven.
void require_one_spacing(TableReader& reader, const Box& box, double spacing, const CaseInfo& info);
/// The box of a fill holds a whole number of particles along each axis.
void require_whole_spacings(TableReader& reader, const Box& box, double spacing,
                            const CaseInfo& info);

/// from, to, radius or stl, scale, at; nothing if the table has none of them.
void read_cylinder_or_stl(TableReader& reader, Shape& shape, const CaseInfo& info);

void read_obstacle(TableReader& reader, Obstacle& obstacle, const CaseInfo& info);
void read_plane(TableReader& reader, PlaneWall& plane, const CaseInfo& info);
void read_body(TableReader& reader, Body& body, const SphSettings& sph, const CaseInfo& info);
/// To be read after planes and bodies, whose names it may use.
void read_gauge(TableReader& reader, SphGauge& gauge, const SphSettings& sph, const CaseInfo& info);

}  // namespace undertow
