#pragma once
// A document as a list: "sph.fluid.water.density", "1000", every value with all its digits.

#include <string>
#include <utility>
#include <vector>

#include "case/document.hpp"

namespace undertow {

/// In the order written. Entries of an array of tables go by their name, or by their number.
std::vector<std::pair<std::string, std::string>> written_keys(const Node& root);

}  // namespace undertow
