#pragma once
// A case with what the C++ programs do not read themselves: the free-form tables and the names of
// its layers.

#include "case/case_file.hpp"
#include "case/document.hpp"

namespace undertow {

struct ResolvedCase {
    Case values;
    Node backend, report;                        // free-form tables, empty if absent
    bool coupled = false;                        // [sph] with [fem], or with [coupling] and a backend
    std::vector<std::string> levels, variants;   // known names
};

ResolvedCase resolve_case(const std::string& path, const CaseOptions& options = {});

/// Everything as one JSON object with the keys of the case file, defaults filled in; infinity is
/// null. Also "file", "folder", "coupled", "known_levels", "known_variants".
std::string case_json(const ResolvedCase& resolved);

}  // namespace undertow
