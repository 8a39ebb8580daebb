#pragma once
// A number as sentences show it.

#include <cstdio>
#include <string>

namespace undertow {

/// At most `digits` significant digits (up to 17, which tell any two doubles apart), without
/// trailing zeros: "0.25", "1e-13".
inline std::string number_text(double value, int digits = 6) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

}  // namespace undertow
