#pragma once
// Numbers of [fem] that no solid has: most likely in other units.

#include <string>
#include <vector>

#include "case/case.hpp"

namespace undertow::fem {

/// A sentence for each doubt. None where gravity is not the earth's: such cases may have no units.
std::vector<std::string> doubts(const Case& c);

}  // namespace undertow::fem
