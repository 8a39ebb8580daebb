#include "sph_solver/neighbors/smoothing_lengths.hpp"

#include "sph_solver/neighbors/neighborhood.hpp"
#include "sph_solver/simd.hpp"

namespace undertow::sph {

double SmoothingLengths::largest_of(const Particles& particles) const {
    const int n = static_cast<int>(particles.size());
    double most = n == 0 ? *std::max_element(h0_.begin(), h0_.end()) : 0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int i = 0; i < n; ++i) most = std::max(most, of(particles.fluid[i], particles.drho[i]));
    return most;
}

/// Finds smaller lengths, next_, for those with too many neighbors within h_i + h_j; false if there
/// are none.
bool SmoothingLengths::crowded(const Neighborhood& neighbors) {
    const Packed* records = neighbors.records().data();
    const float* h = neighbors.smoothing().data();
    const ClusterLists& lists = neighbors.fluid_lists();
    const int n = neighbors.fluid_count(), clusters = lists.clusters();
    const auto per_unit = static_cast<float>(1 / neighbors.fixed().unit);
    int any = 0;
#pragma omp parallel for schedule(dynamic, 32) reduction(max : any)
    for (int c = 0; c < clusters; ++c) {
        const int first = c * lanes, members = std::min(lanes, n - first);
        int8 x{}, y{}, z{};
        float8 own{}, count{};
        for (int k = 0; k < members; ++k) {
            const Packed& q = records[first + k];
            x[k] = q.x, y[k] = q.y, z[k] = q.z, own[k] = h[first + k] * per_unit;
        }
        for (int k = 0; k < lists.parts(c); ++k) {
            const ClusterLists::Part part = lists.part(c, k);
            const int8 put = hide(x, part.hidden, neighbors.out_of_reach<float>());
            for (const int* at = part.begin; at != part.end; ++at) {
                const Packed& j = records[*at];
                const float8 dx = to_real(put - j.x), dy = to_real(y - j.y), dz = to_real(z - j.z);
                const float8 reach = own + h[*at] * per_unit;
                count += dx * dx + dy * dy + dz * dz < reach * reach ? float8{} + 1.0f : float8{};
            }
        }
        for (int k = 0; k < members; ++k) {
            const float others = count[k] - 1;
            next_[first + k] = h[first + k];
            if (!(others > most_neighbors)) continue;
            // a hair more, so that the last ones in excess do not take a pass each
            const float share = 0.995f * most_neighbors / others;
            next_[first + k] *= dimension_ == 2 ? std::sqrt(share) : std::cbrt(share);
            capped_[first + k] = 1;
            any = 1;
        }
    }
    return any;
}

void SmoothingLengths::cap(Neighborhood& neighbors) {
    // half of h_ij is the neighbor's, so that n falls more slowly than h_i^d: passes, each shorter
    constexpr int most_passes = 60;
    const int n = neighbors.fluid_count();
    std::vector<float>& h = neighbors.smoothing();
    outgrown_ = 0;
    ceiling_.resize(n);
    next_.resize(n);
    capped_.assign(n, 0);
    for (int pass = 0; pass < most_passes && crowded(neighbors); ++pass) {
        std::copy(next_.begin(), next_.end(), h.begin());
        for (std::size_t e = 0; e < neighbors.extras().size(); ++e)
            if (const Extra& extra = neighbors.extras()[e]; !extra.from_body)
                h[n + e] = h[extra.source];
    }
    count_ = 0;
    float least = 1e30f;
    for (int i = 0; i < n; ++i) {
        count_ += capped_[i];
        least = std::min(least, h[i]);
        ceiling_[i] = h[i] * static_cast<float>(capped_[i] ? 1 : room);
    }
    most_count_ = std::max(most_count_, count_);
    least_ = n > 0 ? least : 0;
}

}  // namespace undertow::sph
