// The spline through a table of positions.

#include "case/motion_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>

#include "wire/errors.hpp"
#include "wire/number_text.hpp"

namespace undertow {

MotionTable::MotionTable(const std::string& path, double t_end, const std::string& where) {
    std::ifstream file(path);
    if (!file)
        throw InputError(where + ": motion = \"" + path +
                         "\" could not be opened; the path is relative to the case file.");
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        const auto first = line.find_first_not_of(" \t\r\"");
        if (first == std::string::npos || line[first] == '#' ||
            std::isalpha(static_cast<unsigned char>(line[first])))
            continue;
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream words(line);
        std::vector<double> row;
        for (double value; words >> value;) row.push_back(value);
        const bool whole = words.eof() && (row.size() == 4 || row.size() == 5);
        if (!whole)
            throw InputError(where + ": " + path + ":" + std::to_string(number) + ": \"" + line +
                             "\" is not a row of t [s], x, y, z [m] and, if the body turns, "
                             "angle [rad].");
        if (!t_.empty() && !(row[0] > t_.back()))
            throw InputError(where + ": " + path + ":" + std::to_string(number) + ": t = " +
                             number_text(row[0]) + " s must be > " + number_text(t_.back()) +
                             " s, that of the row before: times must rise.");
        t_.push_back(row[0]);
        for (int c = 0; c < channels; ++c)
            x_[c].push_back(c + 1 < static_cast<int>(row.size()) ? row[c + 1] : 0);
    }
    if (t_.size() < 2)
        throw InputError(where + ": \"" + path + "\" has " + std::to_string(t_.size()) +
                         " row of a motion; it takes two at least.");
    for (int c = 0; c < channels; ++c) find_curvature(c, t_.front() > 0, t_.back() < t_end);
}

/// Second derivatives at the rows: a tridiagonal system, continuity of the first derivative.
/// [Press et al. 2007, Numerical Recipes, 3.3; clamped with zero slope where it rests]
void MotionTable::find_curvature(int channel, bool rest_first, bool rest_last) {
    const std::vector<double>& x = x_[channel];
    const std::size_t n = t_.size();
    std::vector<double>& m = curvature_[channel];
    std::vector<double> upper(n, 0.0);
    m.assign(n, 0.0);
    const auto slope = [&](std::size_t k) { return (x[k + 1] - x[k]) / (t_[k + 1] - t_[k]); };
    if (rest_first) upper[0] = 0.5, m[0] = 3 / (t_[1] - t_[0]) * slope(0);
    for (std::size_t k = 1; k + 1 < n; ++k) {
        const double left = t_[k] - t_[k - 1], right = t_[k + 1] - t_[k];
        const double pivot = 2 * (left + right) - left * upper[k - 1];
        upper[k] = right / pivot;
        m[k] = (6 * (slope(k) - slope(k - 1)) - left * m[k - 1]) / pivot;
    }
    if (rest_last) {
        const double last = t_[n - 1] - t_[n - 2];
        m[n - 1] = (-6 * slope(n - 2) - last * m[n - 2]) / (2 * last - last * upper[n - 2]);
    }
    for (std::size_t k = n - 1; k-- > 0;) m[k] -= upper[k] * m[k + 1];
}

bool MotionTable::has_angle() const {
    return std::any_of(x_[3].begin(), x_[3].end(), [](double angle) { return angle != 0; });
}

MotionTable::Value MotionTable::operator()(int channel, double t) const {
    const std::vector<double>&x = x_[channel], &m = curvature_[channel];
    if (t <= t_.front() && t_.front() > 0) return {x.front(), 0, 0};
    if (t >= t_.back()) return {x.back(), 0, 0};
    const auto after = std::upper_bound(t_.begin(), t_.end(), t);
    const auto k = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - t_.begin() - 1, 0, std::ptrdiff_t(t_.size()) - 2));
    const double h = t_[k + 1] - t_[k];
    // at the very start of a table that begins at t = 0
    const double b = std::max(0.0, (t - t_[k]) / h), a = 1 - b;
    return {
        a * x[k] + b * x[k + 1] + ((a * a * a - a) * m[k] + (b * b * b - b) * m[k + 1]) * h * h / 6,
        (x[k + 1] - x[k]) / h + ((3 * b * b - 1) * m[k + 1] - (3 * a * a - 1) * m[k]) * h / 6,
        a * m[k] + b * m[k + 1]};
}

}  // namespace undertow
