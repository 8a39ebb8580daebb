#pragma once
// A motion given as a table, for walls of the fluid and for nodes of a structure.

#include <array>
#include <string>
#include <vector>

namespace undertow {

/// A table of positions as a cubic spline: acceleration is continuous, so that walls do not knock.
/// Before the first and after the last row the position stays. An end that is reached within the
/// run is met at rest; an end at t <= 0 or beyond the run is left open (natural).
class MotionTable {
 public:
    static constexpr int channels = 4;  // x, y, z [m], angle [rad]

    /// CSV: t [s], x, y, z and, if the body turns, angle; lines that begin with '#' or with a
    /// letter are skipped. InputError: not numbers, too few rows, t does not rise.
    MotionTable(const std::string& path, double t_end, const std::string& where);

    struct Value {
        double x, rate, second_rate;
    };
    Value operator()(int channel, double t) const;
    /// Some row turns the body.
    bool has_angle() const;

 private:
    void find_curvature(int channel, bool rest_first, bool rest_last);

    std::vector<double> t_;                                    // [s]
    std::array<std::vector<double>, channels> x_, curvature_;  // and second derivative
};

}  // namespace undertow
