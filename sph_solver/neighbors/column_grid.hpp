#pragma once
// Cells that stand in columns: wide in x and y, thin in z. Particles sorted by cell number walk up one
// column and down the next (and the rows of columns back and forth), so that any eight consecutive
// ones lie close together: they form a cluster, the lanes of the pair loop. Rows run along the shorter
// of x and y, and wide floors are sorted in strips of short rows: the rows that a kernel reaches
// (five of them) then stay in a core's cache while the pair loop walks over them.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace undertow {
class Archive;
}

namespace undertow::sph {

class ColumnGrid {
 public:
    /// lo, hi [m]: bounds of everything that will be binned; width, height of a cell [m].
    void lay_out(const double lo[3], const double hi[3], double width, double height) {
        x0_ = lo[0], y0_ = lo[1], z0_ = lo[2];
        width_ = width, inverse_width_ = 1 / width, inverse_height_ = 1 / height;
        nx_ = count(hi[0] - x0_, inverse_width_);
        ny_ = count(hi[1] - y0_, inverse_width_);
        nz_ = count(hi[2] - z0_, inverse_height_);
        along_y_ = ny_ < nx_;
    }

    void archive(Archive& a);
    std::int64_t cells() const { return std::int64_t(nx_) * ny_ * nz_; }
    int columns_x() const { return nx_; }
    int columns_y() const { return ny_; }

    int column_x(double x) const { return clamp((x - x0_) * inverse_width_, nx_); }
    int column_y(double y) const { return clamp((y - y0_) * inverse_width_, ny_); }
    int level(double z) const { return clamp((z - z0_) * inverse_height_, nz_); }

    std::int64_t cell(double x, double y, double z) const {
        const std::int64_t column = rank(column_x(x), column_y(y));
        const int k = level(z);
        return column * nz_ + (column % 2 ? nz_ - 1 - k : k);
    }

    /// Gap between [lo, hi] and column ix (or iy) along the axis [m]; 0 where they overlap. Columns at the
    /// rim hold all that lies beyond.
    double gap_x(int ix, double lo, double hi) const { return gap(ix, nx_, x0_, lo, hi); }
    double gap_y(int iy, double lo, double hi) const { return gap(iy, ny_, y0_, lo, hi); }

    /// Cells of column (ix, iy) between levels k0 and k1: [first, last], consecutive numbers.
    void range(int ix, int iy, int k0, int k1, std::int64_t& first, std::int64_t& last) const {
        const std::int64_t column = rank(ix, iy);
        first = column * nz_ + (column % 2 ? nz_ - 1 - k1 : k0);
        last = column * nz_ + (column % 2 ? nz_ - 1 - k0 : k1);
    }

 private:
    static int count(double extent, double inverse) {
        return std::max(1, static_cast<int>(std::floor(extent * inverse)) + 1);
    }
    double gap(int i, int n, double origin, double lo, double hi) const {
        if (i == 0 || i == n - 1) return 0;
        const double begin = origin + i * width_, end = begin + width_;
        return std::max({0.0, begin - hi, lo - end}) - 1e-9 * width_;   // rounding of the binning
    }
    static int clamp(double cell, int n) {
        return static_cast<int>(std::clamp(cell, 0.0, n - 1.0));
    }
    /// Of a column: strips of the floor one after the other, rows of a strip, columns of a row; back
    /// and forth everywhere, so that consecutive columns touch.
    std::int64_t rank(int ix, int iy) const {
        const int along = along_y_ ? iy : ix, across = along_y_ ? ix : iy;
        const int n_along = along_y_ ? ny_ : nx_, n_across = along_y_ ? nx_ : ny_;
        const int strip = along / row, first = strip * row;
        const int width = std::min(row, n_along - first);
        const int line = strip % 2 ? n_across - 1 - across : across;
        const int at = line % 2 ? width - 1 - (along - first) : along - first;
        return std::int64_t(first) * n_across + std::int64_t(line) * width + at;
    }

    static constexpr int row = 48;   // columns: five rows of 30 particles' height are 400 KiB
    bool along_y_ = false;
    double x0_ = 0, y0_ = 0, z0_ = 0, width_ = 1, inverse_width_ = 1, inverse_height_ = 1;
    int nx_ = 1, ny_ = 1, nz_ = 1;
};

/// Counting sort: order[k] is the item that comes k-th, start[c] where cell c begins. Stable, so the
/// result depends on nothing but the input.
inline void counting_sort(const std::vector<std::int64_t>& cell, std::int64_t cells,
                          std::vector<int>& order, std::vector<int>& start) {
    start.assign(cells + 1, 0);
    for (const std::int64_t c : cell) ++start[c + 1];
    for (std::int64_t c = 0; c < cells; ++c) start[c + 1] += start[c];
    order.resize(cell.size());
    // start is used as the running cursor and shifted back afterwards
    for (std::size_t i = 0; i < cell.size(); ++i) order[start[cell[i]]++] = static_cast<int>(i);
    for (std::int64_t c = cells; c > 0; --c) start[c] = start[c - 1];
    start[0] = 0;
}

}  // namespace undertow::sph
