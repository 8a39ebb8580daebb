#pragma once
// Parts of [fem] that have a file of their own.

#include "case/table_reader.hpp"

namespace undertow {

/// A set's name. Those of a block are `of_block`; those of a mesh file only the FEM solver knows.
void read_set(TableReader& reader, std::string& set, const FemSettings& fem,
              const std::vector<std::string>& of_block);

/// Facet sets of [fem.block], and all its sets.
extern const std::vector<std::string> block_facets, block_sets;

/// [[fem.motion]]; after [[fem.rigid]].
void read_fem_motion(TableReader& reader, FemMotion& motion, const FemSettings& fem,
                     const CaseInfo& info);

/// [[fem.initial_velocity]]; after [[fem.rigid]].
void read_initial_velocity(TableReader& reader, FemInitialVelocity& given, const FemSettings& fem,
                           const CaseInfo& info);

/// [[fem.history]]; after [[fem.contact]].
void read_fem_history(TableReader& reader, FemHistory& history, const FemSettings& fem);

}  // namespace undertow
