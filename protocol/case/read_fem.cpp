// [fem] with its mesh, materials, parts, supports, loads, surfaces and probes.

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "case/fem_sections.hpp"
#include "case/sections.hpp"
#include "wire/number_text.hpp"

namespace undertow {

const std::vector<std::string> block_facets{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
const std::vector<std::string> block_sets{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax", "block"};

void read_set(TableReader& reader, std::string& set, const FemSettings& fem,
              const std::vector<std::string>& of_block) {
    reader.require("set", "the name of a set of the mesh");
    if (fem.block && fem.block->cells == BlockCells::shells && &of_block == &block_facets)
        reader.word("set", set, {"block"});  // the sheet itself
    else if (fem.block)
        reader.word("set", set, of_block);
    else
        reader.text("set", set);
}

namespace {

/// Smallest box about the corners.
Box box_about(const std::vector<Vec3>& corners) {
    Box box{corners.front(), corners.front()};
    for (const Vec3& x : corners)
        for (std::size_t d = 0; d < 3; ++d) {
            box.min[d] = std::min(box.min[d], x[d]);
            box.max[d] = std::max(box.max[d], x[d]);
        }
    return box;
}

void read_block(TableReader& reader, FemBlock& block, const CaseInfo& info) {
    if (reader.has("corners")) {
        if (reader.has("box"))
            reader.reject("corners", "is one shape too many: the block has a box as well; keep one "
                                     "of the two.");
        reader.points("corners", block.corners, 8);
        block.box = box_about(block.corners);
    } else {
        reader.require("box", "the box { min, max } of the block, or its eight corners");
    }
    reader.require("divisions", "the number of elements [x, y, z]");
    reader.divisions("divisions", block.divisions);
    reader.choice<BlockCells>(
        "cells", block.cells,
        {{"hexahedra", BlockCells::hexahedra},
         {"tetrahedra", BlockCells::tetrahedra},
         {"shells", BlockCells::shells}});
    if (block.cells != BlockCells::shells &&
        std::count(block.divisions.begin(), block.divisions.end(), 0) > 0)
        reader.reject("divisions", "is not allowed: 0 along an axis is for cells = \"shells\".");
    std::string axes;  // along which the block extends
    for (std::size_t k = 0; k < 3; ++k)
        if (block.divisions[k] > 0) axes += "xyz"[k];
    reader.box("box", block.box, axes);
    if (info.dimension != 2) return;
    if (reader.has("divisions") && block.divisions[1] != 1)
        reader.reject("divisions",
                      "is not allowed: a 2D case has one element out of plane, [x, 1, z].");
    const double depth = block.box.max[1] - block.box.min[1];
    if ((reader.has("box") || !block.corners.empty()) && std::abs(depth - info.thickness) > 1e-9 * info.thickness)
        reader.reject(block.corners.empty() ? "box" : "corners",
                      "does not fit: its y extent must equal case.thickness, because contact "
                      "forces of a 2D case are scaled by it.");
}

/// yield_stress and hardening, or hardening_table.
void read_hardening(TableReader& reader, FemMaterial& material) {
    reader.number("yield_stress", material.yield_stress, positive("Pa"));
    reader.number("hardening", material.hardening, at_least(0, "Pa"));
    constexpr std::size_t most_rows = 16;
    reader.pairs("hardening_table", material.hardening_table, 2, most_rows,
                 "rows [plastic strain, yield stress in Pa]");
    if (material.kind != MaterialKind::j2) {
        for (const char* key : {"yield_stress", "hardening", "hardening_table"})
            if (reader.has(key)) reader.reject(key, "has no effect but on kind = \"j2\".");
        return;
    }
    if (!reader.has("hardening_table")) {
        reader.require("yield_stress", "the yield stress in uniaxial tension in Pa, or "
                                       "hardening_table = [[plastic strain, Pa], ...]");
        return;
    }
    for (const char* key : {"yield_stress", "hardening"})
        if (reader.has(key))
            reader.reject(key, "is one law too many: hardening_table has the yield stress at each "
                               "plastic strain; keep one of the two.");
    const auto& rows = material.hardening_table;
    bool allowed = rows[0][0] == 0 && rows[0][1] > 0;
    for (std::size_t k = 1; k < rows.size(); ++k)
        allowed &= rows[k][0] > rows[k - 1][0] && rows[k][1] >= rows[k - 1][1];
    if (!allowed)
        reader.reject("hardening_table",
                      "is not allowed: plastic strains must begin at 0 and increase, yield stresses "
                      "must be > 0 and never fall.");
    material.yield_stress = rows[0][1];
}

/// cohesion, friction_angle, dilation_angle, tension_cutoff.
void read_mohr_coulomb(TableReader& reader, FemMaterial& material) {
    constexpr double steepest = 80;  // [degrees] soils have up to 50, rock fill up to 60
    reader.number("cohesion", material.cohesion, at_least(0, "Pa"));
    reader.number("friction_angle", material.friction_angle, closed(0, steepest, "degrees"));
    reader.number("dilation_angle", material.dilation_angle, closed(0, steepest, "degrees"));
    double cutoff = 0;
    reader.number("tension_cutoff", cutoff, at_least(0, "Pa"));
    if (reader.has("tension_cutoff")) material.tension_cutoff = cutoff;
    if (material.kind != MaterialKind::mohr_coulomb) {
        for (const char* key : {"cohesion", "friction_angle", "dilation_angle", "tension_cutoff"})
            if (reader.has(key)) reader.reject(key, "has no effect but on kind = \"mohr_coulomb\".");
        return;
    }
    reader.require("cohesion", "the cohesion in Pa, or 0");
    reader.require("friction_angle", "the angle of internal friction in degrees, or 0");
    if (material.cohesion == 0 && material.friction_angle == 0 && !reader.has("strength_gradient"))
        reader.reject("cohesion", "is not allowed: without cohesion and friction_angle the material "
                                  "has no strength at all; give one of them.");
    if (material.dilation_angle > material.friction_angle)
        reader.reject("dilation_angle", "is not allowed: beyond friction_angle plastic flow would "
                                        "gain energy; usual are 0 to friction_angle - 30 degrees, "
                                        "and 0 for soil whose volume stays.");
    const double phi = material.friction_angle * std::acos(-1.0) / 180;
    if (cutoff > 0 && material.friction_angle > 0 && !reader.has("strength_gradient") &&
        cutoff > material.cohesion / std::tan(phi) * (1 + 1e-12))
        reader.reject("tension_cutoff", "is not allowed: no tension reaches it, for the cone ends at "
                                        "cohesion/tan(friction_angle); lower it, or leave it out.");
}

/// strength_gradient, strength_level, modulus_ratio: after the strength itself.
void read_depth(TableReader& reader, FemMaterial& material) {
    double gradient = 0;
    reader.number("strength_gradient", gradient, any("Pa/m"));
    if (reader.has("strength_gradient")) material.strength_gradient = gradient;
    reader.number("strength_level", material.strength_level, any("m"));
    reader.number("modulus_ratio", material.modulus_ratio, positive());
    const bool tresca = material.kind == MaterialKind::tresca;
    if (!tresca && material.kind != MaterialKind::mohr_coulomb)
        for (const char* key : {"strength_gradient", "strength_level"})
            if (reader.has(key))
                reader.reject(key, "has no effect but on kind = \"tresca\" and \"mohr_coulomb\".");
    if (reader.has("strength_gradient"))
        reader.require("strength_level", "the z in m below which the strength grows");
    else if (reader.has("strength_level"))
        reader.reject("strength_level", "has no effect without strength_gradient, in Pa per meter of "
                                        "depth below it; give both or none.");
    if (!reader.has("modulus_ratio")) {
        reader.require("young_modulus", tresca ? "Young's modulus in Pa, or modulus_ratio, its ratio "
                                                 "to shear_strength"
                                               : "Young's modulus in Pa");
        return;
    }
    if (!tresca)
        reader.reject("modulus_ratio", "has no effect but on kind = \"tresca\", where it is Young's "
                                       "modulus over shear_strength; give young_modulus.");
    if (reader.has("young_modulus"))
        reader.reject("modulus_ratio", "is one stiffness too many: young_modulus is there as well; "
                                       "keep one of the two.");
    material.young_modulus = material.modulus_ratio * material.shear_strength;
}

void read_material(TableReader& reader, FemMaterial& material) {
    reader.require("name", "a word that parts refer to");
    reader.require("density", "the density in kg/m3");
    reader.require("poisson_ratio", "Poisson's ratio");
    reader.text("name", material.name);
    reader.choice<MaterialKind>(
        "kind", material.kind,
        {{"linear_elastic", MaterialKind::linear_elastic},
         {"tresca", MaterialKind::tresca},
         {"j2", MaterialKind::j2},
         {"mohr_coulomb", MaterialKind::mohr_coulomb}});
    reader.number("density", material.density, positive("kg/m3"));
    double weight_density = 0;
    reader.number("weight_density", weight_density, any("kg/m3"));
    if (reader.has("weight_density")) material.weight_density = weight_density;
    reader.number("young_modulus", material.young_modulus, positive("Pa"));
    reader.number("poisson_ratio", material.poisson_ratio, between(-1, 0.5));
    // 0 at the level where it begins to grow
    reader.number("shear_strength", material.shear_strength,
                  reader.has("strength_gradient") ? at_least(0, "Pa") : positive("Pa"));
    if (material.kind == MaterialKind::tresca)
        reader.require("shear_strength", "the undrained shear strength s_u in Pa");
    else if (reader.has("shear_strength"))
        reader.reject("shear_strength", "has no effect but on kind = \"tresca\".");
    read_hardening(reader, material);
    read_mohr_coulomb(reader, material);
    read_depth(reader, material);
}

/// What a scene under water and on soil needs: static water, stress at rest, the far field.
void read_ground(TableReader& reader, FemSettings& fem) {
    FemWater water;
    if (reader.table("water", [&](TableReader& entry) {
            entry.require("level", "the z of the water's surface in m");
            entry.number("level", water.level, any("m"));
            entry.number("density", water.density, positive("kg/m3"));
        }))
        fem.water = water;
    FemGeostatic geostatic;
    if (reader.table("geostatic", [&](TableReader& entry) {
            read_set(entry, geostatic.set, fem, {"block"});
            entry.require("surface", "the z of the ground in m");
            entry.number("surface", geostatic.surface, any("m"));
            entry.number("earth_pressure", geostatic.earth_pressure, at_least(0));
        }))
        fem.geostatic = geostatic;
    FemSettle settle;
    if (reader.table("settle", [&](TableReader& entry) {
            entry.number("tolerance", settle.tolerance, above_up_to(0, 0.1));
            entry.whole("max_steps", settle.max_steps, 1, 100000000);
        }))
        fem.settle = settle;
    reader.tables("absorbing", [&](TableReader& entry) {
        FemAbsorbing& absorbing = fem.absorbing.emplace_back();
        read_set(entry, absorbing.set, fem, block_facets);
        Vec3 center{};
        entry.vector("center", center, "m");
        if (entry.has("center")) absorbing.center = center;
    });
}

void read_rigid(TableReader& reader, FemRigid& rigid, const FemSettings& fem) {
    reader.require("name", "a word for its columns");
    reader.text("name", rigid.name);
    read_set(reader, rigid.set, fem, {"block"});
    if (reader.has("free")) rigid.free.clear();
    reader.words("free", rigid.free, {"x", "y", "z", "rx", "ry", "rz"});
    reader.number("added_mass", rigid.added_mass, at_least(0, "kg"));
    reader.vector("added_at", rigid.added_at, "m");
}

void read_contact(TableReader& reader, FemContact& contact) {
    reader.require("name", "a word for messages and columns");
    reader.require("nodes", "a facet set whose nodes touch");
    reader.require("surface", "the facet set that they touch");
    reader.text("name", contact.name);
    reader.text("nodes", contact.nodes);
    reader.text("surface", contact.surface);
    reader.number("friction", contact.friction, at_least(0));
    reader.number("max_shear", contact.max_shear, at_least(0, "Pa"));
    reader.number("adhesion_factor", contact.adhesion_factor, closed(0, 1));
    if (contact.adhesion_factor > 0 && contact.max_shear > 0)
        reader.reject("adhesion_factor", "is one limit too many: max_shear is there as well; keep one "
                                         "of the two.");
    reader.require("gap", "the distance in m between the two in the mesh");
    reader.number("gap", contact.gap, positive("m"));
    reader.number("near", contact.near, positive("m"));
    if (reader.has("near") && contact.near < 2 * contact.gap)
        reader.reject("near", "= " + number_text(contact.near) +
                                  " must be two gaps or more (gap = " + number_text(contact.gap) +
                                  " m): it is the distance in m within which nodes are kept in "
                                  "sight; leave it out for two gaps.");
}

void read_mesh(TableReader& reader, FemSettings& fem, const CaseInfo& info,
               const std::string& folder) {
    reader.text("mesh", fem.mesh);
    FemBlock block;
    if (reader.table("block", [&](TableReader& entry) { read_block(entry, block, info); }))
        fem.block = block;
    if (fem.block && !fem.mesh.empty())
        reader.reject("mesh",
                      "is one mesh too many: the case has [fem.block] as well; keep one of "
                      "the two.");
    if (!fem.block && fem.mesh.empty())
        reader.require("block", "[fem.block] or mesh = \"FILE.msh\" (Gmsh) or \"FILE.inp\" (Abaqus)");
    if (!fem.mesh.empty() &&
        !std::filesystem::is_regular_file(std::filesystem::path(folder) / fem.mesh))
        reader.reject("mesh", "does not exist: the path is taken from the case file's folder, " +
                                  (folder.empty() ? std::string(".") : folder) + ".");
}

}  // namespace

void read_fem(TableReader& reader, FemSettings& fem, const CaseInfo& info,
              const std::string& folder) {
    fem.present = true;
    read_mesh(reader, fem, info, folder);
    reader.require("material", "at least one [[fem.material]]");
    reader.require("part", "at least one [[fem.part]]");
    reader.number("cfl", fem.cfl, above_up_to(0, 1));
    reader.number("damping_alpha", fem.damping_alpha, at_least(0, "1/s"));
    reader.number("damping_beta", fem.damping_beta, at_least(0, "s"));
    double step = 0;
    reader.number("mass_scaling", step, positive("s"));
    if (reader.has("mass_scaling")) fem.mass_scaling = step;
    reader.number("bulk_viscosity_linear", fem.bulk_viscosity_linear, at_least(0));
    reader.number("bulk_viscosity_quadratic", fem.bulk_viscosity_quadratic, at_least(0));
    reader.number("implicit_damping", fem.implicit_damping, closed(0, 1));

    reader.tables("material",
                  [&](TableReader& entry) { read_material(entry, fem.material.emplace_back()); });
    std::vector<std::string> materials;
    for (const FemMaterial& material : fem.material) materials.push_back(material.name);
    reader.tables("part", [&](TableReader& entry) {
        FemPart& part = fem.part.emplace_back();
        read_set(entry, part.set, fem, {"block"});
        entry.require("material", "the name of a [[fem.material]]");
        entry.word("material", part.material, materials);
        entry.choice<ElementFormulation>("element", part.element,
                                         {{"one_point", ElementFormulation::one_point},
                                          {"b_bar", ElementFormulation::b_bar},
                                          {"averaged_pressure",
                                           ElementFormulation::averaged_pressure},
                                          {"shell", ElementFormulation::shell}});
        entry.number("thickness", part.thickness, positive("m"));
        if (part.element == ElementFormulation::shell)
            entry.require("thickness", "the thickness of the shell in m");
        else if (entry.has("thickness"))
            entry.reject("thickness", "has no effect but with element = \"shell\".");
        if (fem.block && (part.element == ElementFormulation::shell) !=
                             (fem.block->cells == BlockCells::shells))
            entry.reject("element", "does not fit the block: \"shell\" goes with [fem.block] cells = "
                                    "\"shells\", every other element with solid cells.");
        Range factor = at_least(1);
        entry.number("mass_factor", part.mass_factor, factor);
        entry.flag("implicit", part.implicit);
        for (const FemMaterial& material : fem.material)
            if (part.implicit && material.name == part.material &&
                material.kind != MaterialKind::linear_elastic)
                entry.reject("implicit",
                             "needs a material that stays elastic: kind = \"linear_elastic\".");
        if (part.implicit && part.element != ElementFormulation::automatic &&
            part.element != ElementFormulation::one_point)
            entry.reject("implicit",
                         "is for hexahedra of element = \"one_point\" alone; leave element out, or "
                         "leave the part explicit.");
    });
    reader.tables("support", [&](TableReader& entry) {
        FemSupport& support = fem.support.emplace_back();
        read_set(entry, support.set, fem, block_sets);
        entry.require("fix", "a list of \"x\", \"y\", \"z\", and of shells \"rx\", \"ry\", \"rz\", "
                             "\"clamp\"");
        entry.words("fix", support.fix, {"x", "y", "z", "rx", "ry", "rz", "clamp"});
    });
    reader.tables("mass", [&](TableReader& entry) {
        FemMass& mass = fem.mass.emplace_back();
        entry.require("mass", "the mass in kg");
        entry.number("mass", mass.mass, positive("kg"));
        entry.vector("point", mass.point, "m");
        if (!entry.has("point")) {
            read_set(entry, mass.set, fem, block_sets);
        } else {
            entry.text("set", mass.set);
            if (entry.has("set"))
                entry.reject("set", "is one place too many: give set or point, not both.");
        }
    });
    reader.tables("pressure", [&](TableReader& entry) {
        FemPressure& pressure = fem.pressure.emplace_back();
        read_set(entry, pressure.set, fem, block_facets);
        entry.require("value", "the pressure in Pa");
        entry.number("value", pressure.value, any("Pa"));
        entry.number("ramp", pressure.ramp, at_least(0, "s"));
    });
    reader.tables("traction", [&](TableReader& entry) {
        FemTraction& traction = fem.traction.emplace_back();
        read_set(entry, traction.set, fem, block_facets);
        entry.require("value", "the force over undeformed area [x, y, z] in Pa");
        entry.vector("value", traction.value, "Pa");
        entry.number("ramp", traction.ramp, at_least(0, "s"));
    });
    reader.tables("surface", [&](TableReader& entry) {
        FemSurface& surface = fem.surface.emplace_back();
        entry.require("name", "a word that names its force");
        entry.text("name", surface.name);
        read_set(entry, surface.set, fem, block_facets);
        entry.flag("immobile", surface.immobile);
    });
    read_ground(reader, fem);
    reader.tables("rigid",
                  [&](TableReader& entry) { read_rigid(entry, fem.rigid.emplace_back(), fem); });
    reader.tables("motion", [&](TableReader& entry) {
        read_fem_motion(entry, fem.motion.emplace_back(), fem, info);
    });
    reader.tables("initial_velocity", [&](TableReader& entry) {
        read_initial_velocity(entry, fem.initial_velocity.emplace_back(), fem, info);
    });
    reader.tables("contact",
                  [&](TableReader& entry) { read_contact(entry, fem.contact.emplace_back()); });
    reader.tables("probe", [&](TableReader& entry) {
        FemProbe& probe = fem.probe.emplace_back();
        entry.require("name", "a word for its columns");
        entry.require("point", "a point [x, y, z] of the undeformed mesh");
        entry.text("name", probe.name);
        entry.vector("point", probe.point, "m");
    });
    reader.tables("history", [&](TableReader& entry) {
        read_fem_history(entry, fem.history.emplace_back(), fem);
    });
}

}  // namespace undertow
