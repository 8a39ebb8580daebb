#include "sph_solver/neighbors/cluster_lists.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sph_solver/simd.hpp"

namespace undertow::sph {

namespace {

struct Cluster {
    int8 x, y, z;                      // lanes; a cluster that is not full repeats its last member
    std::int32_t fixed_lo[3], fixed_hi[3];   // bounds
    double lo[3], hi[3];               // [m] the same
    float8 reach;                      // h + skin of each member [unit], where sizes differ
    float most_reach;                  // [unit]
};

Cluster load(const std::vector<Packed>& records, const FixedPoint& fixed, int first, int last) {
    Cluster c;
    std::int32_t lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
        lo[a] = std::numeric_limits<std::int32_t>::max();
        hi[a] = std::numeric_limits<std::int32_t>::min();
    }
    for (int k = 0; k < lanes; ++k) {
        const Packed& q = records[std::min(first + k, last - 1)];
        c.x[k] = q.x, c.y[k] = q.y, c.z[k] = q.z;
        const std::int32_t at[3] = {q.x, q.y, q.z};
        for (int a = 0; a < 3; ++a) {
            lo[a] = std::min(lo[a], at[a]);
            hi[a] = std::max(hi[a], at[a]);
        }
    }
    std::copy(lo, lo + 3, c.fixed_lo);
    std::copy(hi, hi + 3, c.fixed_hi);
    const double origin[3] = {fixed.x0, fixed.y0, fixed.z0};
    for (int a = 0; a < 3; ++a) {
        c.lo[a] = origin[a] + lo[a] * fixed.unit;
        c.hi[a] = origin[a] + hi[a] * fixed.unit;
    }
    return c;
}

/// Bit k: lane k is below the limit.
unsigned lanes_below(float8 a, float limit) {
#if defined(__AVX512VL__)
    return _mm256_cmp_ps_mask((__m256)a, _mm256_set1_ps(limit), _CMP_LT_OQ);
#elif defined(__AVX__)
    return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, _mm256_set1_ps(limit), _CMP_LT_OQ));
#else
    unsigned mask = 0;
    for (int k = 0; k < lanes; ++k) mask |= unsigned(a[k] < limit) << k;
    return mask;
#endif
}

/// Distances between an interval and points, 0 inside.
float8 outside(int8 x, std::int32_t lo, std::int32_t hi) {
    const int8 below = lo - x, above = x - hi, d = below > above ? below : above;
    return positive_part(to_real(d));
}

float8 squared(float8 a) { return a * a; }

/// Appends the records of [j0, j1) that are near the cluster: first whole eights against its box, then
/// those near the box against its members. sized: a record is near a member i within reach_j + own.reach
/// of i, else within `range`.
template <bool sized>
int append_near(const Cluster& own, const std::int32_t* x, const std::int32_t* y,
                const std::int32_t* z, const float* reach, int j0, int j1, float range, int* out) {
    const float range2 = range * range;
    int found = 0;
    for (int j = j0; j < j1; j += lanes) {
        int8 jx, jy, jz;
        __builtin_memcpy(&jx, x + j, sizeof jx);
        __builtin_memcpy(&jy, y + j, sizeof jy);
        __builtin_memcpy(&jz, z + j, sizeof jz);
        const float8 bx = outside(jx, own.fixed_lo[0], own.fixed_hi[0]),
                     by = outside(jy, own.fixed_lo[1], own.fixed_hi[1]),
                     bz = outside(jz, own.fixed_lo[2], own.fixed_hi[2]);
        unsigned near_box;
        if constexpr (sized) {
            float8 reach_j;
            __builtin_memcpy(&reach_j, reach + j, sizeof reach_j);
            near_box = lanes_below(bx * bx + by * by + bz * bz - squared(reach_j + own.most_reach), 0);
        } else {
            near_box = lanes_below(bx * bx + by * by + bz * bz, range2);
        }
        if (j + lanes > j1) near_box &= (1u << (j1 - j)) - 1;
        for (; near_box; near_box &= near_box - 1) {
            const int k = j + std::countr_zero(near_box);
            const float8 dx = to_real(own.x - x[k]), dy = to_real(own.y - y[k]),
                         dz = to_real(own.z - z[k]);
            out[found] = k;
            const float8 r2 = dx * dx + dy * dy + dz * dz;
            if constexpr (sized)
                found += lanes_below(r2 - squared(own.reach + reach[k]), 0) != 0;
            else
                found += lanes_below(r2, range2) != 0;
        }
    }
    return found;
}

}  // namespace

void ClusterLists::build(const ColumnGrid& grid, const FixedPoint& fixed,
                         const std::vector<Packed>& records, int first, int n,
                         const std::vector<SourceCells>& sources, double range,
                         const std::vector<float>* smoothing, double skin) {
    const int clusters = (n + lanes - 1) / lanes, all = static_cast<int>(records.size());
    part_begin_.clear();
    stretch_.clear();
    dropped_ = 0;
    cut_pairs_ = 0;
    begin_.resize(clusters);
    count_.resize(clusters);
    of_first_kind_.resize(clusters);
    for (auto* a : {&x_, &y_, &z_}) a->resize(all + lanes);   // the last eight may reach beyond
    constexpr int block = 64;   // clusters per buffer: small enough to share out evenly
    const int blocks = (clusters + block - 1) / block;
    if (static_cast<int>(buffer_.size()) < blocks) buffer_.resize(blocks);
    const auto in_units = [&](double length) { return static_cast<float>(length / fixed.unit); };
    const bool sized = smoothing && !smoothing->empty();
    if (sized) reach_.resize(all + lanes);
    const double most_smoothing = 0.5 * (range - skin);

#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (int j = 0; j < all; ++j) {
            x_[j] = records[j].x, y_[j] = records[j].y, z_[j] = records[j].z;
            if (sized) reach_[j] = in_units((*smoothing)[j]);
        }

#pragma omp for schedule(dynamic, 1)
        for (int b = 0; b < blocks; ++b) {
            std::vector<int>& list = buffer_[b];
            std::size_t length = 0;
            const int c0 = b * block, c1 = std::min(clusters, c0 + block);
            for (int c = c0; c < c1; ++c) {
                const std::size_t begin = length;
                Cluster own = load(records, fixed, first + c * lanes, first + n);
                double range_c = range;
                if (sized) {
                    own.most_reach = 0;
                    for (int k = 0; k < lanes; ++k) {
                        const int i = std::min(first + c * lanes + k, first + n - 1);
                        own.reach[k] = in_units((*smoothing)[i] + skin);
                        own.most_reach = std::max(own.most_reach, own.reach[k]);
                    }
                    range_c = most_smoothing + own.most_reach * fixed.unit;
                }
                const int ix0 = grid.column_x(own.lo[0] - range_c),
                          ix1 = grid.column_x(own.hi[0] + range_c),
                          iy0 = grid.column_y(own.lo[1] - range_c),
                          iy1 = grid.column_y(own.hi[1] + range_c);
                for (const SourceCells& source : sources) {
                    for (int iy = iy0; iy <= iy1; ++iy) {
                        const double dy = grid.gap_y(iy, own.lo[1], own.hi[1]);
                        for (int ix = ix0; ix <= ix1; ++ix) {
                            const double dx = grid.gap_x(ix, own.lo[0], own.hi[0]);
                            const double up2 = range_c * range_c - dx * dx - dy * dy;
                            if (up2 < 0) continue;   // the column passes by
                            const double up = std::sqrt(up2);
                            std::int64_t cell0, cell1;
                            grid.range(ix, iy, grid.level(own.lo[2] - up),
                                       grid.level(own.hi[2] + up), cell0, cell1);
                            const int j0 = source.base + (*source.start)[cell0];
                            const int j1 = source.base + (*source.start)[cell1 + 1];
                            if (list.size() < length + (j1 - j0) + ahead)
                                list.resize(2 * list.size() + (j1 - j0) + 1024);
                            const auto append = sized ? append_near<true> : append_near<false>;
                            length += append(own, x_.data(), y_.data(), z_.data(), reach_.data(),
                                             j0, j1, in_units(range), list.data() + length);
                        }
                    }
                    if (&source == &sources.front())
                        of_first_kind_[c] = static_cast<int>(length - begin);
                }
                count_[c] = static_cast<int>(length - begin);
            }
            int* at = list.data();   // only now: resize may have moved it
            for (int c = c0; c < c1; ++c) {
                begin_[c] = at;
                at += count_[c];
            }
        }
    }
}

std::int64_t ClusterLists::entries() const {
    std::int64_t sum = 0;
    for (const int n : count_) sum += n;
    for (const Stretch& s : stretch_) sum += s.count;
    return sum;
}

void ClusterLists::hide(const std::vector<std::vector<std::uint8_t>>& from, std::int64_t pairs) {
    cut_pairs_ = pairs;
    part_begin_.assign(1, 0);
    std::vector<int> list;
    for (int c = 0; c < clusters(); ++c) {
        if (const std::vector<std::uint8_t>& hidden = from[c]; !hidden.empty()) {
            list.assign(begin(c), end(c));
            const int n = count_[c], first_kind = of_first_kind_[c];
            int filled = 0;
            const auto take = [&](std::uint8_t mask) {
                for (int k = 0; k < n; ++k)
                    if (hidden[k] == mask) begin_[c][filled++] = list[k];
            };
            take(0);
            count_[c] = filled;
            of_first_kind_[c] =
                static_cast<int>(std::count(hidden.begin(), hidden.begin() + first_kind, 0));
            std::vector<std::uint8_t> masks = hidden;
            std::sort(masks.begin(), masks.end());
            masks.erase(std::unique(masks.begin(), masks.end()), masks.end());
            for (const std::uint8_t mask : masks) {
                if (mask == 0 || mask == nobody) continue;
                const int first = filled;
                take(mask);
                stretch_.push_back({first, filled - first, mask});
            }
            dropped_ += n - filled;
        }
        part_begin_.push_back(static_cast<int>(stretch_.size()));
    }
    if (!cut()) part_begin_.clear();
}

}  // namespace undertow::sph
