#pragma once
// Help for the mistyped: lists of what is known, and the nearest of it.

#include <string>
#include <vector>

namespace undertow {

/// "a, b, c"
std::string list_text(const std::vector<std::string>& names);

/// The end of a sentence: "; did you mean \"spacing\"?" when one of `known` is near enough, else ".".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

}  // namespace undertow
