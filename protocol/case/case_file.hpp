#pragma once
// TOML case file -> typed tables. Every mistake is one sentence with file:line:column, the key, the
// value, what is allowed and the nearest known key (InputError, exit code 2).

#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow {

struct CaseOptions {
    std::string level{};                      // name of a [level.NAME] table laid over the case
    std::vector<std::string> variants{};      // names of [variant.NAME] tables, laid over in order
    std::vector<std::string> set{};           // "sph.spacing=0.005": overrides, last of all
};

/// Reads `path` (a .toml file, or a folder that holds case.toml).
Case read_case(const std::string& path, const CaseOptions& options = {});

}  // namespace undertow
