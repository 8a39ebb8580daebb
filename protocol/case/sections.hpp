#pragma once
// One function per top-level table of a case. Each checks its own keys; rules that span tables are
// in case_file.cpp.

#include "case/table_reader.hpp"

namespace undertow {

void read_info(TableReader& reader, CaseInfo& info);
void read_time(TableReader& reader, TimeSettings& time);
void read_start(TableReader& reader, StartSettings& start);
void read_output(TableReader& reader, OutputSettings& output);
void read_checkpoint(TableReader& reader, CheckpointSettings& checkpoint);
void read_sph(TableReader& reader, SphSettings& sph, const CaseInfo& info);
/// The ends of the fluid's world: sph.periodic, sph.inflow, sph.outflow, sph.absorbing.
void read_sph_ends(TableReader& reader, SphSettings& sph, const CaseInfo& info);
void read_fem(TableReader& reader, FemSettings& fem, const CaseInfo& info,
              const std::string& folder);
void read_coupling(TableReader& reader, CouplingSettings& coupling);

}  // namespace undertow
