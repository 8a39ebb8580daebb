#include "sph_solver/neighbors/cluster_lists.hpp"

#include <omp.h>

#include <limits>

#include "sph_solver/simd.hpp"

namespace undertow::sph {

namespace {

struct Cluster {
    int8 x, y, z;                      // lanes; a cluster that is not full repeats its last member
    double lo[3], hi[3];               // [m] bounds
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
    const double origin[3] = {fixed.x0, fixed.y0, fixed.z0};
    for (int a = 0; a < 3; ++a) {
        c.lo[a] = origin[a] + lo[a] * fixed.unit;
        c.hi[a] = origin[a] + hi[a] * fixed.unit;
    }
    return c;
}

bool any_lane_below(float8 a, float limit) {
#if defined(__AVX512VL__)
    return _mm256_cmp_ps_mask((__m256)a, _mm256_set1_ps(limit), _CMP_LT_OQ) != 0;
#elif defined(__AVX__)
    return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, _mm256_set1_ps(limit), _CMP_LT_OQ)) != 0;
#else
    for (int k = 0; k < lanes; ++k)
        if (a[k] < limit) return true;
    return false;
#endif
}

}  // namespace

void ClusterLists::build(const ColumnGrid& grid, const FixedPoint& fixed,
                         const std::vector<Packed>& records, int first, int n,
                         const std::vector<SourceCells>& sources, double range) {
    const int clusters = (n + lanes - 1) / lanes;
    begin_.resize(clusters);
    count_.resize(clusters);
    constexpr int block = 64;   // clusters per buffer: small enough to share out evenly
    const int blocks = (clusters + block - 1) / block;
    if (static_cast<int>(buffer_.size()) < blocks) buffer_.resize(blocks);
    const float range2 = static_cast<float>(range / fixed.unit * (range / fixed.unit));

#pragma omp parallel for schedule(dynamic, 1)
    for (int b = 0; b < blocks; ++b) {
        std::vector<int>& list = buffer_[b];
        list.clear();
        const int c0 = b * block, c1 = std::min(clusters, c0 + block);
        for (int c = c0; c < c1; ++c) {
            const std::size_t begin = list.size();
            const Cluster own = load(records, fixed, first + c * lanes, first + n);
            const int ix0 = grid.column_x(own.lo[0] - range), ix1 = grid.column_x(own.hi[0] + range);
            const int iy0 = grid.column_y(own.lo[1] - range), iy1 = grid.column_y(own.hi[1] + range);
            const int k0 = grid.level(own.lo[2] - range), k1 = grid.level(own.hi[2] + range);
            for (const SourceCells& source : sources)
                for (int iy = iy0; iy <= iy1; ++iy)
                    for (int ix = ix0; ix <= ix1; ++ix) {
                        std::int64_t cell0, cell1;
                        grid.range(ix, iy, k0, k1, cell0, cell1);
                        const int j0 = source.base + (*source.start)[cell0];
                        const int j1 = source.base + (*source.start)[cell1 + 1];
                        for (int j = j0; j < j1; ++j) {
                            const Packed& q = records[j];
                            const float8 dx = to_real(own.x - q.x), dy = to_real(own.y - q.y),
                                         dz = to_real(own.z - q.z);
                            if (any_lane_below(dx * dx + dy * dy + dz * dz, range2))
                                list.push_back(j);
                        }
                    }
            count_[c] = static_cast<int>(list.size() - begin);
        }
        const int* at = list.data();   // only now: push_back may have moved it
        for (int c = c0; c < c1; ++c) {
            begin_[c] = at;
            at += count_[c];
        }
    }
}

std::int64_t ClusterLists::entries() const {
    std::int64_t sum = 0;
    for (const int n : count_) sum += n;
    return sum;
}

}  // namespace undertow::sph
