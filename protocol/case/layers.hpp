#pragma once
// A case with its layers: the base, one [level.NAME], any [variant.NAME]s, then --set overrides.
//
//     [level.quick]                        tables merge key by key, arrays and values replace
//     sph.spacing = 0.02
//     [variant.rigid_wall]
//     fem = false                          false in place of a table removes it
//     [[variant.rigid_wall.append.sph.plane]]    append: adds entries to an array of tables
//     name = "wall"

#include <string>
#include <vector>

#include "case/case_file.hpp"
#include "case/document.hpp"

namespace undertow {

/// Tables merge recursively, everything else replaces, `false` removes a table or an array of
/// tables. The member "append" of `overlay` holds arrays to be added at the end of base's.
void lay_over(Node& base, const Node& overlay);

/// One "key=value" of --set: "sph.spacing=0.005", "sph.fluid.water.viscosity=0" (an entry of an
/// array of tables is named by its name or by its number from 0), "fem=false".
void apply_override(Node& base, const std::string& assignment);

/// Resolves a document: applies the options and removes the tables level and variant.
Node resolve_layers(Node document, const CaseOptions& options);

/// Names of the entries of [level.*] or [variant.*].
std::vector<std::string> layer_names(const Node& document, const std::string& kind);

}  // namespace undertow
